"""Roles made of functions: the contract on an instrument of another library, and its errors as one sentence."""

import math
from types import SimpleNamespace

import pytest

from smarig.config import load_rig
from smarig.core import UsageError
from smarig.device import (
    ContractCase,
    FunctionInput,
    FunctionOutput,
    Garbled,
    PolledPosition,
    PolledSource,
    Silent,
    check_contract,
)

RIG = load_rig("bench_one_wire")
ANALOGUE = RIG.model_copy(update={"encoder": RIG.encoder.model_copy(update={"resolution": 0.01})})


class Library:
    """A supply as another library offers it, with properties and a watchdog of 1 s, on 5 ohm."""

    def __init__(self):
        self.now_s, self.fed_s = 0.0, 0.0
        self.level, self.enabled, self.watched, self.lost = 0.0, False, False, False

    def look(self):
        if self.lost:
            raise OSError("VI_ERROR_CONN_LOST")
        if self.watched and self.now_s - self.fed_s > 1.0:
            self.enabled = False
        self.fed_s = self.now_s

    def set_level(self, level):
        self.look()
        self.level = level

    def get(self, name):
        self.look()
        return getattr(self, name)

    def enable(self, on):
        self.look()
        self.enabled = on

    def current(self):
        return self.get("level") * self.enabled

    def watch(self, seconds):
        self.look()
        self.watched = seconds == 1.0
        return self.watched

    def wait(self, seconds):
        self.now_s += seconds


def output(supply, **changed):
    functions = {
        "identity": "ACME 1",
        "set_current_A": supply.set_level,
        "current_A": supply.current,
        "voltage_V": lambda: 5 * supply.current(),
        "switch_on": lambda: supply.enable(True),
        "switch_off": lambda: supply.enable(False),
        "setting_A": lambda: supply.get("level"),
        "is_on": lambda: supply.get("enabled"),
        "arm_watchdog": supply.watch,
        "lease_s": 1.0,
    }
    return FunctionOutput(**(functions | changed))


def broken(role, make, absent, wait, rig=RIG):
    case = ContractCase(make, absent, rig, wait)
    return {r.name: r.observed for r in check_contract(role, case) if not r.passed}


def raises():
    raise Silent("nobody")


@pytest.mark.parametrize("without", [(), ("setting_A",), ("is_on",), ("setting_A", "is_on", "arm_watchdog")])
def test_it_meets_the_contract_with_whatever_is_read_back(without):
    supply = Library()
    given = dict.fromkeys(without)
    if "setting_A" in without and "is_on" in without:
        given |= {"switch_on": lambda: supply.enable(True)}
    made = lambda: PolledSource(output(supply, **given))  # noqa: E731
    if without == ("is_on",):  # a setting alone does not show that a watchdog has acted
        given["arm_watchdog"] = None
    assert broken("amplifier", made, raises, supply.wait) == {}


def test_an_input_meets_the_contract():
    clock = Library()

    class Clock:
        started = "clock"

        def tick(self):
            return int(clock.now_s / 0.1 + 1e-6)

    made = lambda: PolledPosition(FunctionInput("laser", lambda: 1.234, "mm"), ANALOGUE, Clock())  # noqa: E731
    assert broken("encoder_daq", made, raises, clock.wait, ANALOGUE) == {}


def test_errors_of_the_library_are_one_sentence_with_a_remedy():
    supply = Library()
    source = output(supply)
    source.arm()
    supply.lost = True
    with pytest.raises(
        Silent, match=r"ACME 1: measuring the current failed \(OSError: VI_ERROR_CONN_LOST\)\. Check"
    ):
        source.measure()
    assert (
        "did not confirm that it is off. Its watchdog switches it off within 1 s of silence" in source.off()
    )


def test_an_unconfirmed_output_without_a_watchdog_is_to_be_switched_off_by_hand():
    supply = Library()
    source = output(supply, arm_watchdog=None)
    source.arm()
    supply.lost = True
    assert (
        source.off() == "ACME 1 did not confirm that it is off. It has no lease: switch it off by hand now."
    )


def test_an_output_that_is_not_confirmed_off_is_named_with_its_address():
    supply = Library()
    source = output(supply, arm_watchdog=None, line=SimpleNamespace(where="ASRL3::INSTR"))
    source.arm()
    supply.lost = True
    assert source.off().startswith("ACME 1 at ASRL3::INSTR did not confirm that it is off.")


def test_an_output_that_went_off_may_have_been_switched_off_by_a_hand():
    supply = Library()
    source = output(supply, is_on=lambda: False)
    source.arm()
    source.set_current(0.1)
    source.measure()
    assert "whether somebody pressed its output key" in source.tripped


def test_an_output_that_is_not_off_cannot_be_armed():
    supply = Library()
    with pytest.raises(Silent, match="did not confirm"):
        output(supply, switch_off=lambda: None, is_on=lambda: True).arm()


@pytest.mark.parametrize("answer", [None, [], "", "OFF", 0.5, math.nan, 2])
def test_a_state_that_is_neither_yes_nor_no_confirms_nothing(answer):
    source = output(Library(), is_on=lambda: answer)
    assert "did not confirm" in source.off()


@pytest.mark.parametrize("measured", [0.5, math.nan, 1j, "0"])
def test_a_current_that_still_flows_is_not_off(measured):
    source = output(Library(), current_A=lambda: measured)
    assert ("did not confirm" in source.off()) == (measured != "0")


@pytest.mark.parametrize("raised", [KeyboardInterrupt, SystemExit(7), RecursionError, OSError("gone")])
def test_off_and_close_never_raise(raised):
    def fail():
        raise raised

    source = output(Library(), switch_off=fail, close_all=fail)
    assert "did not confirm" in source.off()
    source.close()


@pytest.mark.parametrize("value", ["x", 1j, [1], {}])
def test_a_reading_that_is_no_number_is_a_fault_of_the_instrument(value):
    with pytest.raises(Silent, match=r"laser: reading failed \((ValueError|TypeError)"):
        FunctionInput("laser", lambda: value, "mm").position()


def test_a_library_that_ends_the_program_is_a_fault():
    def leave():
        raise SystemExit(7)

    with pytest.raises(Silent, match="SystemExit: 7"):
        FunctionInput("laser", leave, "mm").position()


def test_a_setting_that_is_not_taken_switches_off():
    supply = Library()
    source = output(supply, setting_A=lambda: 0.7 * supply.level)
    source.arm()
    with pytest.raises(Garbled, match=r"set 0\.35 A instead of 0\.5 A"):
        source.set_current(0.5)
    assert (supply.level, supply.enabled) == (0.0, False)


def test_no_number_reaches_the_instrument():
    supply = Library()
    source = output(supply)
    source.arm()
    with pytest.raises(UsageError):
        source.set_current(math.nan)
    assert supply.level == 0.0


def test_a_watchdog_that_is_not_read_back_is_no_lease():
    source = output(Library(), lease_s=2.0)
    source.arm()
    assert source.has_lease is False


def test_a_reading_that_is_none_is_nan():
    assert math.isnan(FunctionInput("laser", lambda: None, "mm").position())


def test_it_is_switched_off_also_if_setting_zero_fails():
    supply = Library()
    source = output(supply)
    source.arm()
    source.set_current(0.3)

    def unanswered(_level):
        raise OSError("VI_ERROR_TMO")

    source.set_current_A = unanswered
    assert "did not confirm that it is off" in source.off()
    assert not supply.enabled

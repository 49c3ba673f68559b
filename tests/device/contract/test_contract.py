"""The contract of instruments: good ones meet all of it, and each way to break it breaks its own requirement."""

import pytest

from device.contract import faulty_instruments as faulty
from smarig.config import load_rig
from smarig.core import UsageError
from smarig.device import ContractCase, as_current_source, as_position_sensor, check_contract, contract
from smarig.device.contract.contract_case import results
from smarig.device.contract.source_requirements import current_held

RIG = load_rig("bench_one_wire")  # a lease of 1 s, ticks of 0.1 s, at most 1 A


def case(kind, role):
    time, state = faulty.SimulatedTime(), {}

    def opened(present):
        made = kind(time, state, present)
        if role == "amplifier":
            return as_current_source(made, "a driver", RIG)
        return as_position_sensor(made, "a driver", RIG) if role == "encoder_daq" else made

    return ContractCase(lambda: opened(True), lambda: opened(False), RIG, time.wait)


def broken(kind, role):
    found = list(check_contract(role, case(kind, role)))
    assert [result.name for result in found] == list(contract(role)), "every requirement, in order"
    return {result.name: result.observed for result in found if not result.passed}


@pytest.mark.parametrize(
    ("kind", "role"),
    [
        (faulty.Output, "amplifier"),
        (faulty.TickedOutput, "amplifier"),
        (faulty.Sensor, "encoder_daq"),
        (faulty.Thermometer, "thermometer"),
        (faulty.Thermometer, "room_thermometer"),
        (faulty.Cell, "load_cell"),
    ],
)
def test_a_good_instrument_meets_every_requirement(kind, role):
    assert broken(kind, role) == {}


@pytest.mark.parametrize(
    ("kind", "requirement", "observed"),
    [
        (faulty.OnWhenOpened, "off after opening", "0.2 A flow"),
        (faulty.LeftOn, "off after a killed host", "A flow after it was opened again"),
        (faulty.Weak, "current as ordered", "0.1 A ordered"),
        (
            faulty.Thousandfold,
            "current as ordered",
            "a factor of about 1000: is the unit of the reading right?",
        ),
        (
            faulty.Thousandth,
            "current as ordered",
            "a factor of about 1/1000: is the unit of the reading right?",
        ),
        (faulty.Strong, "current as ordered", "gain 1.40, not 1"),
        (faulty.TooMany, "readings in order", "instead of at most"),
        (faulty.OldReadings, "readings in order", "since tick"),
        (faulty.Backwards, "readings in order", "ticks"),
        (faulty.AcceptsNaN, "no number refused", "accepted nan"),
        (faulty.StaysOn, "off confirmed", "A flow after off"),
        (faulty.OffRaises, "off on a closed line", "off raised OSError"),
        (faulty.Impatient, "first order after a pause", "Its watchdog has switched it off. It had 2.5 s"),
        (faulty.FedByOrders, "current held", "with a query in each tick: measure must renew the lease"),
        (faulty.NoLease, "lease", "flow after the lease is over"),
        (faulty.SilentTrip, "lease", "tripped does not say why"),
        (faulty.StaysTripped, "lease", "arm does not clear the trip"),
        (faulty.CloseRaises, "closing", "close raised OSError"),
        (faulty.Nameless, "identity", "empty"),
        (faulty.OutputByAnyName, "absence", "not there"),
        (faulty.AbsenceAsTraceback, "absence", "KeyError, not a RigFault"),
    ],
)
def test_a_broken_output_is_found(kind, requirement, observed):
    assert observed in broken(kind, "amplifier").get(requirement, "it was not found")


def test_a_source_that_measures_no_current_is_refused_once_and_told_what_to_do():
    passed, refused = check_contract("amplifier", case(faulty.MeasuresNoCurrent, "amplifier"))
    assert (passed.name, passed.passed) == ("identity", True)
    assert (refused.name, refused.passed) == ("off after opening", False)
    assert refused.observed.startswith("the driver measures no current. ")
    assert "put a shunt into the circuit" in refused.observed


@pytest.mark.parametrize(
    ("kind", "role", "requirement", "observed"),
    [
        (faulty.Slow, "encoder_daq", "ticks by time", "5 ticks in 10 periods"),
        (faulty.Prophet, "encoder_daq", "readings in order", "has not come"),
        (faulty.Fractional, "encoder_daq", "readings in order", "no integers"),
        (faulty.NoZero, "encoder_daq", "zero", "250 counts after zero"),
        (faulty.Kelvin, "thermometer", "temperature", "-295.6"),
        (faulty.CellAsText, "load_cell", "force", "is no force"),
    ],
)
def test_a_broken_sensor_is_found(kind, role, requirement, observed):
    assert observed in broken(kind, role).get(requirement, "it was not found")


def test_a_sensor_that_does_not_rest_at_zero_is_told_what_to_check():
    found = broken(faulty.NoZero, "encoder_daq")["zero"]
    assert all(word in found for word in ("unit", "noise", "encoder.resolution"))


def test_a_source_without_a_lease_says_so_and_passes():
    results = {
        r.name: r.observed for r in check_contract("amplifier", case(faulty.TickedOutput, "amplifier"))
    }
    assert results["lease"].startswith("it has none")


def test_a_source_without_a_voltage_says_so_and_passes():
    (found,) = [
        r
        for r in check_contract("amplifier", case(faulty.Blind, "amplifier"))
        if not r.passed or r.limitation
    ]
    assert (found.name, found.passed) == ("current as ordered", True)
    assert "it measures no voltage, so the resistance of the wire is not checked" in found.observed


def test_an_unknown_role_is_one_sentence():
    with pytest.raises(UsageError, match="No role 'oven'. The roles are: amplifier, encoder_daq"):
        contract("oven")


@pytest.mark.parametrize(("stalls", "observed"), [(0, ""), (5, ""), (10**6, "cannot be tested here")])
def test_a_busy_computer_is_not_taken_for_a_driver_that_renews_no_lease(stalls, observed):
    time, state = faulty.SimulatedTime(), {"stalls": stalls}

    def opened():
        return as_current_source(faulty.Delayed(time, state), "a driver", RIG)

    stalling = ContractCase(opened, opened, RIG, time.wait, lambda: time.now_s)
    (found,) = results(stalling, {"current held": current_held})
    assert found.passed == (not observed)
    assert observed in found.observed

"""A rig without a lease: lower limits by the steady state (5.3), said before, during and after a run."""

import math

import numpy as np
import pytest

from control.model_files import model_of
from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core import Elapsed, Hold, UsageError
from smarig.core.catalogue import own_files
from smarig.plant import Actuator
from smarig.record import load_run
from smarig.rig import limits_in_force
from smarig.runner import Session

WIRE = Actuator.named("gorbet_one_wire")
DRIVER = '''"""The simulated amplifier, by a driver that claims no lease."""
from smarig.device import smarig_amplifier

class Unleased:
    has_lease = False
    def __init__(self, source):
        self._source = source
    def __getattr__(self, name):
        return getattr(self._source, name)

def unleased(where, rig):
    return Unleased(smarig_amplifier(where, rig))
'''


@pytest.fixture
def rig(tmp_path):
    (tmp_path / "unleased.py").write_text(DRIVER)
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\nbase = "one_wire_serial"\nlimits.temperature_max_K = 120.0\n'
        '[links.amplifier]\ndriver = "./unleased.py"\n'
    )
    with own_files():
        yield path


def test_the_largest_current_heats_to_80_percent_of_the_limit():
    limits = load_rig("one_wire_twin").limits.model_copy(update={"temperature_max_K": 120.0})
    heating = WIRE.file.heating
    expected_A = heating.reference_current.value * math.sqrt(
        0.8 * 120.0 / heating.reference_temperature.value
    )
    lower = limits_in_force(limits, WIRE, has_lease=False)
    assert lower.current_max_A == pytest.approx(expected_A, rel=1e-12)
    assert lower.current_min_A == 0.0
    assert limits_in_force(limits, WIRE, has_lease=True) is limits


def test_a_limit_that_is_low_enough_stays():
    limits = load_rig("one_wire_twin").limits.model_copy(update={"current_max_A": 0.2})
    assert limits_in_force(limits, WIRE, has_lease=False).current_max_A == 0.2


def test_both_wires_of_two_are_limited():
    wires = Actuator.named("gorbet_two_wire")
    lower = limits_in_force(load_rig("two_wire_twin").limits, wires, has_lease=False)
    assert 0 < lower.current_max_A == -lower.current_min_A


@pytest.mark.long("takes a second")
def test_a_run_takes_the_lower_limits_and_says_so(rig, tmp_path):
    out = tmp_path / "low.run.sqlite"
    with Session(str(rig)) as session:
        session.run("step_currents", {"temperatures_K": (20.0,)}, out)
        assert session.guard.limits.current_max_A < 0.8
        assert session.setup.upper_K == pytest.approx(96.0), "what a protocol may ask for"
        with pytest.raises(UsageError, match="110 K is outside the rig's range 0…96 K"):
            session.run("step_currents", {"temperatures_K": (110.0,)}, tmp_path / "high.run.sqlite")
    assert not (tmp_path / "high.run.sqlite").exists()
    run = load_run(out)
    assert run.meta["has_lease"] is False
    (event,) = [e for e in run.events if e.kind == "no_lease"]
    assert event.level == "warning"
    assert "only the cut-out stops the current" in event.text
    assert "limit 120 K" in event.text


LIMIT_A = 0.7426  # (5.3): 96 K of 120 K


def test_a_refused_start_says_why_the_limit_is_not_that_of_the_file(rig, tmp_path):
    def held(_setup):
        yield Hold(0.9, Elapsed(1))

    with Session(str(rig)) as session:
        for asked in ({"settings": {"currents_A": (0.9,)}}, {"settings": {}, "protocol_factory": held}):
            with pytest.raises(UsageError, match="outside the .*limits 0…0.742") as refused:
                session.run("step_currents", out=tmp_path / "high.run.sqlite", **asked)
            assert str(refused.value).endswith(f". {session.no_lease}")
            assert "The current source has no lease" in str(refused.value)


@pytest.mark.parametrize(
    "words",
    [
        "run step_currents --set currents_A=0.9",
        pytest.param("run first_order_descending --set settle.timeout_s=60", marks=pytest.mark.long),
        "regulate one_e.model.json --setpoint 11.5 --hold-s 20",
        "track one_e.model.json --reference steps --controller pi --set seconds=20",
    ],
)
def test_no_command_drives_more_than_the_lower_limit(rig, tmp_path, monkeypatch, words, capsys):
    """Whatever is asked for: the command is refused, or stays below."""
    monkeypatch.chdir(tmp_path)
    model_of("one_e").save(tmp_path / "one_e.model.json")
    out = tmp_path / "out.run.sqlite"
    status = cli([*words.split(), "--rig", str(rig), "-o", str(out), "--quiet"])
    if not out.exists():
        assert status == 2
        assert capsys.readouterr().err.count("\n") <= 2
        return
    flowed = np.nanmax(np.abs(load_run(out)["current_A"]))
    assert 0.2 < flowed <= LIMIT_A + 0.002


def test_a_source_with_a_lease_keeps_its_limits(tmp_path):
    with Session("one_wire_serial") as session:
        session.run("step_currents", {"temperatures_K": (20.0,)}, tmp_path / "a.run.sqlite")
        assert session.guard.limits.current_max_A == 1.0
    run = load_run(tmp_path / "a.run.sqlite")
    assert run.meta["has_lease"] is True
    assert not [e for e in run.events if e.kind == "no_lease"]

"""A preview tells how far it has come, and limits that the wire does not suit are refused in a sentence."""

from importlib import import_module

import pytest

from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core import ConfigError
from smarig.plant import Actuator
from smarig.protocols import Setup
from smarig.runner import preview


def test_a_long_preview_reports_its_time(monkeypatch):
    monkeypatch.setattr(import_module("smarig.runner.preview"), "REPORT_EVERY_S", 0.0)
    reached_s = []
    cost = preview("step_currents", load_rig("one_wire_twin"), {"points": 40}, report=reached_s.append)
    assert len(reached_s) > 2
    assert reached_s == sorted(reached_s)
    assert reached_s[0] == pytest.approx(500.0)  # 5000 ticks
    assert reached_s[-1] <= cost.duration_s


@pytest.mark.parametrize(("quiet", "shown"), [((), True), (("--quiet",), False)])
def test_a_dry_run_shows_it_unless_quiet(monkeypatch, capsys, quiet, shown):
    monkeypatch.setattr(import_module("smarig.runner.preview"), "REPORT_EVERY_S", 0.0)
    words = ("run", "step_currents", "--rig", "one_wire_twin", "--set", "points=20", "--dry-run", *quiet)
    assert cli(words) == 0
    assert ("Preview on the twin: 0.1 h of the run so far." in capsys.readouterr().err) == shown


def test_one_wire_takes_no_negative_current():
    rig = load_rig("one_wire_twin")
    limits = rig.limits.model_copy(update={"current_min_A": -1.0})
    with pytest.raises(ConfigError, match="is one wire, which no negative current drives"):
        Setup(Actuator.named(rig.actuator), limits, rig.period_s)

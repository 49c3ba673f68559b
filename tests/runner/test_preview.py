"""A preview tells how far it has come, and limits that the wire does not suit are refused in a sentence."""

from importlib import import_module

import pytest

from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.core import ConfigError, Interrupted, UsageError
from smarig.plant import Actuator
from smarig.protocols import Setup
from smarig.runner import RunControl, preview

PREVIEW = import_module("smarig.runner.preview")


def test_a_long_preview_reports_its_time(monkeypatch):
    monkeypatch.setattr(PREVIEW, "REPORT_EVERY_S", 0.0)
    monkeypatch.setattr(PREVIEW, "_computed", {})
    reached_s = []
    cost = preview("step_currents", load_rig("one_wire_twin"), {"points": 40}, report=reached_s.append)
    assert len(reached_s) > 2
    assert reached_s == sorted(reached_s)
    assert reached_s[0] == pytest.approx(500.0)  # 5000 ticks
    assert reached_s[-1] <= cost.duration_s


@pytest.mark.parametrize(("quiet", "shown"), [((), True), (("--quiet",), False)])
def test_a_dry_run_shows_it_unless_quiet(monkeypatch, capsys, quiet, shown):
    monkeypatch.setattr(PREVIEW, "REPORT_EVERY_S", 0.0)
    monkeypatch.setattr(PREVIEW, "_computed", {})
    words = ("run", "step_currents", "--rig", "one_wire_twin", "--set", "points=20", "--dry-run", *quiet)
    assert cli(words) == 0
    assert ("Preview on the twin: 0.1 h of the run so far." in capsys.readouterr().err) == shown


def test_one_wire_takes_no_negative_current():
    rig = load_rig("one_wire_twin")
    limits = rig.limits.model_copy(update={"current_min_A": -1.0})
    with pytest.raises(ConfigError, match="is one wire, which no negative current drives"):
        Setup(Actuator.named(rig.actuator), limits, rig.period_s)


def test_the_same_is_computed_once_and_anything_else_anew(monkeypatch):
    """Protocol, settings, rig and actuator count; what reads a file is computed each time."""
    monkeypatch.setattr(PREVIEW, "_computed", {})
    runs = []
    runner = PREVIEW.Runner
    monkeypatch.setattr(PREVIEW, "Runner", lambda *given: runs.append(1) or runner(*given))
    rig = load_rig("one_wire_twin")
    shorter = rig.model_copy(update={"period_s": 0.2})
    first = preview("validation", rig, {"points": "3"})
    assert preview("validation", load_rig("one_wire_twin"), {"points": "3"}) is first
    assert len(runs) == 1
    others = [
        ("validation", rig, {"points": "4"}),
        ("wiping_out", rig, {}),
        ("validation", shorter, {"points": "3"}),
    ]
    for number, other in enumerate(others, start=2):
        assert preview(*other) != first
        assert len(runs) == number


def test_a_profile_that_was_edited_is_read_again(tmp_path):
    profile = tmp_path / "profile.csv"
    steps = []
    for rows in ("0.2", "0.2\n0.3\n0.1"):
        profile.write_text(f"current_A\n{rows}\n", encoding="utf-8")
        steps.append(preview("step_currents", load_rig("one_wire_twin"), {"file": str(profile)}).steps)
    assert steps[1] == steps[0] + 2


def test_a_stop_that_was_requested_ends_a_known_preview_too():
    control, rig = RunControl(), load_rig("one_wire_twin")
    preview("validation", rig, {"points": "3"})
    control.stop("enough")
    with pytest.raises(Interrupted):
        preview("validation", rig, {"points": "3"}, control)


@pytest.mark.parametrize(("peak_K", "lower_A"), [(170.0, 0.922), (100.0, None)])
def test_the_lower_limit_of_a_bench_without_a_lease_is_told(peak_K, lower_A):
    settings = {"temperatures_K": (peak_K,)}
    found = preview("step_currents", load_rig("one_wire_serial"), settings)
    assert found.without_lease_A == (lower_A and pytest.approx(lower_A, abs=1e-3))
    assert ("(at most 0.922 A if its source turns out to have no lease)" in found.sentence()) == bool(lower_A)
    assert preview("step_currents", load_rig("one_wire_twin"), settings).without_lease_A is None


def test_a_preview_that_is_refused_names_the_limit_and_no_current():
    """Nothing was driven that could be at zero."""
    rig = load_rig("one_wire_twin")
    small = rig.model_copy(update={"limits": rig.limits.model_copy(update={"current_max_A": 0.4})})
    with pytest.raises(UsageError, match=r"it is above limits\.current_max_A") as error:
        preview("minor_loops", small, {"low_A": 0.0, "high_A": 0.5})
    assert "It is set to high_A = 0.5." in str(error.value)
    assert "at zero" not in str(error.value)

"""Steps that settled with readings of a channel that fails are marked when the failure shows."""

import pytest

from benchmarks.plausibility import guarded, levels_A, one_hold, slipping
from smarig.core import LimitExceeded
from smarig.record import Recorder, load_run
from smarig.report.components.run_description import quality_counts
from smarig.rig import TwinSettings
from smarig.runner import Runner

BEGINS_S = 230.0


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """An encoder that begins to slip after some steps; the run goes on until the guard trips."""
    path = tmp_path_factory.mktemp("slip") / "a.run.sqlite"
    guard, rig = guarded("one_wire_twin", TwinSettings(seed=1))
    rig.begin, rig.channel, rig.change = round(BEGINS_S / guard.period_s), "counts", slipping(0.7)
    recorder = Recorder(path, {"protocol": "test", "rig": "one_wire_twin"})
    runner = Runner(guard, 1.0, [recorder])
    levels = levels_A(rig.twin.actuator, rig.twin.file)
    protocol = (hold for current_A in [*levels, *levels] for hold in one_hold(current_A, 150.0))
    with pytest.raises(LimitExceeded):
        runner.run(protocol)
    recorder.close("tripped", t_s=runner.t_s)
    return load_run(path)


@pytest.mark.long("takes a second")
def test_no_step_of_the_failing_encoder_counts_as_settled(run):
    late = [step for step in run.steps if step.end_s > BEGINS_S]
    assert len(late) > 3
    assert {step.verdict for step in late} <= {"suspect", "timed_out"}


def test_an_event_says_since_when_the_readings_contradict(run):
    (event,) = [event for event in run.events if event.kind == "suspect"]
    assert "steps that settled since are suspect" in event.text
    since_s = event.data["since_s"]
    assert since_s < BEGINS_S
    assert {step.verdict for step in run.steps if step.end_s >= since_s} <= {"suspect", "timed_out"}


def test_the_page_counts_them(run):
    counts = quality_counts(run)
    assert counts.suspect_steps == sum(step.verdict == "suspect" for step in run.steps) > 3
    assert not counts.clean

"""Samples of a first attempt, and readings that contradict each other, are in the record and in no fit."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.core import Quality, Severity
from smarig.identification import identify, verify
from smarig.record import Event, Step, counted
from smarig.report.runs.run_assessment import run_assessment

T = triangles((90.0, 70.0, 90.0), rows=50)
STRAIN = RelayWire(1).strain(T)
REPEATED = 60  # samples of a first attempt
COLUMNS = {"input": 1.3 * T[:REPEATED], "position": np.zeros(REPEATED), "quality": np.zeros(REPEATED)}


def whole():
    """A run of motions in one step, without anything amiss."""
    run = as_run("whole", T, STRAIN, dt=1.0)
    columns = {**run.columns, "step": np.zeros(len(run))}
    return replace(run, columns=columns, steps=(step(0, 0.0, len(run), void=False),))


def step(index, begin_s, end_s, *, void):
    return Step(index, 0, void, "loops", None, begin_s, end_s, "elapsed", None, 10)


def resumed():
    """The same after a first attempt that a fault ended: it was hotter, and its sensor stood still."""
    good = whole()
    first = {name: COLUMNS.get(name, x[:REPEATED]) for name, x in good.columns.items()}
    moved = {"tick": REPEATED, "t_s": REPEATED, "step": 1}
    columns = {name: np.append(first[name], x + moved.get(name, 0)) for name, x in good.columns.items()}
    steps = (step(0, 0.0, REPEATED, void=True), step(1, REPEATED, REPEATED + len(good), void=False))
    events = (
        Event(REPEATED - 1.0, "warning", "end", "Run ended: the sensor.", {"severity": "invalid"}),
        Event(float(REPEATED), "info", "resumed", "Restarted.", {"start_over": True}),
    )
    return replace(good, columns=columns, steps=steps, events=events)


def stuck(since=0.8, **data):
    """The run whose sensor stands still from a share of its samples on, as an event at its end says."""
    run = whole()
    k = int(since * len(run))
    position = run["position"].copy()
    position[k:] = position[k]
    text = "The readings contradict each other."
    event = Event(
        float(run["t_s"][-1]), "warning", "suspect", text, {"since_s": float(run["t_s"][k]), **data}
    )
    return replace(run, columns={**run.columns, "position": position}, events=(event,)), k


def test_a_first_attempt_is_in_no_model():
    found, clean = identify(resumed(), "positive"), identify(whole(), "positive")
    assert found.model.hysteresis.everett(80.0, 40.0) == clean.model.hysteresis.everett(80.0, 40.0)
    (rows,) = found.rows
    assert rows.left_out == {"of void steps": REPEATED}
    assert rows.used == len(T)


def test_a_first_attempt_is_in_no_verification():
    model = identify(whole(), "positive").model
    errors = [verify(model, run).runs[0].settled for run in (resumed(), whole())]
    assert errors[0] == errors[1]


def test_readings_of_a_sensor_that_stood_still_are_left_out():
    run, k = stuck()
    (rows,) = identify(run, "positive").rows
    assert rows.left_out == {"suspect": len(run) - k}
    assert rows.used == k


def test_a_sample_that_is_marked_suspect_is_left_out():
    run = whole()
    quality = run["quality"].copy()
    quality[[7, 9]] = Quality.SUSPECT
    (rows,) = identify(replace(run, columns={**run.columns, "quality": quality}), "positive").rows
    assert rows.left_out == {"suspect": 2}


@pytest.mark.parametrize("since_s", ["soon", None, [], 10**400, float("nan")])
def test_what_a_file_may_hold_in_place_of_a_time_leaves_nothing_out(since_s):
    run, _ = stuck(since_s=since_s)
    assert counted(run) is run


def test_a_resumed_run_is_not_condemned_by_what_it_has_repeated():
    run = resumed()
    assert (run.severity, run.remaining_severity) == (Severity.INVALID, Severity.NONE)
    later = Event(90.0, "error", "jump", "The position jumped.", {})
    assert replace(run, events=(*run.events, later)).remaining_severity == Severity.MAJOR
    ended = run.with_meta(end={"cause": "done"})
    found = run_assessment(ended)
    assert found.level == "good"
    assert "1 step was repeated" in found.quality


def test_a_run_that_went_on_keeps_the_events_before():
    """Only the end of its first attempt is over: its steps before it still count."""
    run = resumed()
    end, restart = run.events
    jump = Event(3.0, "error", "jump", "The position jumped.", {})
    went_on = replace(restart, data={"start_over": False})
    assert replace(run, events=(jump, end, went_on)).remaining_severity == Severity.MAJOR
    assert replace(run, events=(end, went_on)).remaining_severity == Severity.NONE

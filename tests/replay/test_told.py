"""Runs as one timeline: commands become segments, and readings become observations."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import EXCURSIONS, LISTED, LONG, session_runs
from smarig.core.errors import DataError
from smarig.replay import build_timeline

TAU_S = 5.3


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return session_runs(tmp_path_factory.mktemp("told"), LONG, LISTED)


@pytest.fixture(scope="module")
def timeline(runs):
    return build_timeline(runs, TAU_S)


def without(run, *columns):
    """The run with channels that were never measured."""
    return replace(run, columns=run.columns | {name: np.full(len(run), np.nan) for name in columns})


@pytest.mark.long("takes a second")
def test_drive_profile_carries_the_charge_that_was_commanded_at_every_sample(runs, timeline):
    t = np.concatenate([run["t_s"] for run in runs]) - runs[0]["t_s"][0] + 0.1
    commanded = np.cumsum(np.concatenate([run["current_command_A"] for run in runs])) * 0.1
    drive = timeline.drive
    ends = np.concatenate([[0.0], drive.end_s])
    charge = np.concatenate([[0.0], np.cumsum(drive.value * np.diff(ends))])
    np.testing.assert_allclose(np.interp(t, ends, charge), commanded, atol=1e-6)
    assert drive.end_s.size < 0.01 * t.size


@pytest.mark.long("takes two seconds")
def test_time_between_runs_is_recorded_or_counted_as_a_gap(runs, timeline):
    assert timeline.unrecorded_gap_s == pytest.approx(0.0, abs=1e-6)
    first, last = runs
    late = replace(last, columns=last.columns | {"t_s": last["t_s"] + 90.0})
    assert build_timeline([first, late], TAU_S).unrecorded_gap_s == pytest.approx(90.0, abs=1e-6)


@pytest.mark.parametrize("at_s", [[], [0.05, 31.7, 402.0, 402.0001]])
def test_ticks_carry_the_same_charge_and_stop_at_every_time_that_is_wanted(timeline, at_s):
    drive, at_s = timeline.drive, np.array(at_s, dtype=float)
    t, current = drive.ticks(at_s)
    assert np.all(np.diff(t) > 0)
    assert np.isin(at_s, t).all()
    ends = np.concatenate([[0.0], drive.end_s])
    charge = np.concatenate([[0.0], np.cumsum(drive.value * np.diff(ends))])
    np.testing.assert_allclose(
        np.cumsum(current * np.diff(t, prepend=0.0)), np.interp(t, ends, charge), atol=1e-5
    )


def test_ticks_are_short_after_a_change_and_never_longer_than_eight_seconds(timeline):
    t, _ = timeline.drive.ticks(np.empty(0))
    lengths = np.diff(t, prepend=0.0)
    since = t - np.concatenate([[0.0], timeline.drive.end_s])[np.searchsorted(timeline.drive.end_s, t - 1e-6)]
    assert 5.0 < lengths.max() < 8.1
    assert lengths[since < 1.0].max() < 0.4
    assert lengths[since < 4 * TAU_S].max() < 0.16 * TAU_S
    assert lengths[since < 9 * TAU_S].max() < 0.41 * TAU_S


def test_without_a_command_the_measured_current_is_the_drive(runs):
    bare = without(runs[0], "current_command_A")
    drive = build_timeline([bare], TAU_S).drive
    assert drive.end_s[-1] == pytest.approx(len(bare) * 0.1)
    length = np.diff(drive.end_s, prepend=0.0)
    assert drive.value @ length == pytest.approx(np.sum(bare["current_A"]) * 0.1)


def test_settled_readings_are_the_settled_steps(runs, timeline):
    steps = [step for run in runs for step in run.settled]
    assert timeline.settled.value.tolist() == [s.position for s in steps]
    assert timeline.target_K.tolist() == [s.target for s in steps]
    assert timeline.hold_s.tolist() == pytest.approx([s.t_end_s - s.t_start_s for s in steps])
    assert timeline.settled.step.tolist() == list(range(len(steps)))
    assert timeline.run.tolist() == [k for k, run in enumerate(runs) for _ in run.settled]
    assert timeline.unit == "mm"


def test_a_settled_position_is_read_in_the_middle_of_its_window(runs, timeline):
    """The window of a settled mean is its last n samples."""
    steps = [(run, step) for run in runs for step in run.settled]
    for t, (run, step) in zip(timeline.settled.t_s, steps, strict=True):
        rows = np.flatnonzero(run["t_s"] <= step.t_end_s + 1e-6)[-step.n :]
        middle = run["t_s"][rows].mean() - runs[0]["t_s"][0] + 0.1
        assert run["position"][rows].mean() == pytest.approx(step.position, abs=1e-6)
        assert t == pytest.approx(middle, abs=0.1)


def test_other_channels_are_read_over_the_same_window(runs, timeline):
    other_readings = {r.kind: r for r in timeline.other_readings}
    assert set(other_readings) == {"moving", "resistance", "current", "room"}
    steps = [(run, step) for run in runs for step in run.settled]
    for r in (other_readings["resistance"], other_readings["current"], other_readings["room"]):
        for value, k in zip(r.value, r.step, strict=True):
            run, step = steps[k]
            rows = np.flatnonzero(run["t_s"] <= step.t_end_s + 1e-6)[-step.n :]
            by_hand = {
                "resistance": run["voltage_V"][rows] / run["current_A"][rows],
                "current": run["current_A"][rows] - run["current_command_A"][rows],
                "room": run["ambient_degC"][rows],
            }[r.kind]
            assert value == pytest.approx(by_hand.mean(), abs=1e-9)
    cold = [k for k, (_, step) in enumerate(steps) if step.target == 0]
    assert not set(cold) & set(
        other_readings["resistance"].step.tolist()
    )  # without current there is no resistance


def test_moving_positions_are_samples_within_three_time_constants_of_a_step(runs, timeline):
    moving = next(r for r in timeline.other_readings if r.kind == "moving")
    t = np.concatenate([run["t_s"] for run in runs]) - runs[0]["t_s"][0] + 0.1
    y = np.concatenate([run["position"] for run in runs])
    rows = np.searchsorted(t, moving.t_s - 1e-6)
    np.testing.assert_allclose(t[rows], moving.t_s, atol=1e-6)
    assert moving.value.tolist() == y[rows].tolist()
    starts = np.array([s.t_start_s for run in runs for s in run.settled]) - runs[0]["t_s"][0] + 0.1
    waited = moving.t_s - starts[moving.step]
    assert waited.min() > 0
    assert waited.max() < 3 * TAU_S + 0.3


def test_a_channel_that_was_not_measured_is_not_read(runs):
    bare = [without(run, "voltage_V", "ambient_degC") for run in runs]
    assert {r.kind for r in build_timeline(bare, TAU_S).other_readings} == {"moving", "current"}


def test_runs_in_any_order_give_the_same_timeline(runs, timeline):
    again = build_timeline(runs[::-1], TAU_S)
    assert [run.path for run in again.runs] == [run.path for run in runs]
    for name in ("target_K", "hold_s", "run", "block"):
        assert getattr(again, name).tolist() == getattr(timeline, name).tolist()
    assert again.drive.end_s.tolist() == timeline.drive.end_s.tolist()
    assert again.drive.value.tolist() == timeline.drive.value.tolist()
    for a, b in zip(again.all_readings, timeline.all_readings, strict=True):
        assert (a.kind, a.value.tolist(), a.t_s.tolist()) == (b.kind, b.value.tolist(), b.t_s.tolist())


def test_blocks_are_excursions_out_and_back(runs):
    block = build_timeline(runs[1:], TAU_S).block
    assert runs[1].settled[0].target == EXCURSIONS[0]
    assert block.tolist() == [0, 0, 0, 0, 0, 1, 1, 2]


def test_no_block_spans_two_runs_and_none_turns_upwards(timeline):
    for b in np.unique(timeline.block):
        inside = timeline.block == b
        assert np.unique(timeline.run[inside]).size == 1
        moves = np.sign(np.diff(timeline.target_K[inside]))
        moves = moves[moves != 0]
        assert np.all(np.diff(moves) <= 0)
    assert np.all(np.diff(timeline.block) >= 0)
    assert np.unique(timeline.block).size == timeline.block.max() + 1


def test_a_run_without_settled_steps_is_refused_unless_another_has_some(runs):
    bare = replace(runs[1], steps=())
    with pytest.raises(DataError, match=r"contain no settled steps.*\.$") as refused:
        build_timeline([bare], TAU_S)
    assert f": {bare.path.name} ({bare.info.protocol}). A diagnosis needs some." in str(refused.value)
    assert "such as validation or first_order_descending" in str(refused.value)
    both = build_timeline([runs[0], bare], TAU_S)
    assert len(both.settled) == len(runs[0].settled)
    assert both.drive.end_s[-1] == pytest.approx(sum(map(len, runs)) * 0.1)


@pytest.mark.parametrize("missing", [("t_s",), ("current_command_A", "current_A")])
def test_a_run_without_clock_or_current_is_refused_by_name(runs, missing):
    bare = without(runs[0], *missing)
    with pytest.raises(DataError, match=rf"{runs[0].path.name} has no clock or no current.*\.$"):
        build_timeline([bare, runs[1]], TAU_S)


def test_two_wires_are_driven_both_ways(tmp_path):
    run = session_runs(tmp_path, ("validation", {"points": 4}), rig="two_wire_twin")[0]
    drive = build_timeline([run], TAU_S).drive
    assert drive.value.min() == run["current_command_A"].min() < -0.5
    assert drive.value.max() == run["current_command_A"].max() > 0.5

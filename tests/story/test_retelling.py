"""A story retold on coarse ticks: what the plant would have shown, with the plant's own effects in it."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.preisach.operator import Preisach
from smarig.story.retelling import numerics, positions, retold
from smarig.story.told import told
from story.sittings import LISTED, LONG, believed, sitting

WITHIN = 0.05  # counts
EFFECTS = {
    "nothing": (),
    "settling": ("settling=5",),
    "ambient_drift": ("ambient_drift=2", "ambient_drift.period_h=0.3"),
    "walking": ("walking=0.5",),
    "amplifier_gain": ("amplifier_gain=4",),
    "stress_coupling": ("stress_coupling",),
    "backlash": ("backlash=2",),
}
LATE = {"sensor_lag": ("sensor_lag=5",)}  # shows only while the wire moves


@pytest.fixture(scope="module")
def told_by(tmp_path_factory):
    """The story of a noise-free sitting, with the subject that is the twin itself; made once for each effect."""
    kept = {}

    def make(name):
        if name not in kept:
            runs = sitting(
                tmp_path_factory.mktemp(name),
                LONG,
                LISTED,
                effects=(EFFECTS | LATE)[name],
                noise=False,
                fine=True,
            )
            kept[name] = runs, told(runs, believed()[0].actuator.tau_s), *believed((EFFECTS | LATE)[name])
        return kept[name]

    return make


@pytest.mark.parametrize("name", EFFECTS)
def test_settled_positions_are_the_twins(told_by, name):
    _, story, subject, per_count = told_by(name)
    found = retold(story, subject).values["settled"]
    assert np.abs(found - story.settled.value).max() < WITHIN * per_count


@pytest.mark.parametrize("name", [name for name in EFFECTS if name != "nothing"])
def test_an_effect_shows_in_the_twins_readings(told_by, name):
    """Else the agreement above would say nothing of it."""
    _, story, subject, per_count = told_by(name)
    plain = retold(story, replace(subject, effects=())).values["settled"]
    assert np.abs(plain - story.settled.value).max() > 10 * WITHIN * per_count


def test_effects_given_beside_the_subject_act_as_its_own_do(told_by):
    _, story, subject, _ = told_by("settling")
    own = retold(story, subject).stacked(story)
    beside = retold(story, replace(subject, effects=()), subject.effects).stacked(story)
    assert own.tolist() == beside.tolist()


@pytest.mark.parametrize(
    ("name", "kind", "within"),
    [
        ("nothing", "moving", 0.002),
        ("settling", "moving", 0.05),
        ("sensor_lag", "moving", 0.05),
        ("nothing", "resistance", 1e-5),
        ("amplifier_gain", "current", 1.5e-6),
        ("ambient_drift", "room", 0.01),
    ],
)
def test_readings_of_every_kind_are_the_twins(told_by, name, kind, within):
    """Within mm, ohm, A (whole µA) and K; a thermometer shows more than how far the room is from where it began."""
    _, story, subject, _ = told_by(name)
    readings = next(r for r in story.others if r.kind == kind)
    apart = retold(story, subject).values[kind] - readings.value
    apart -= apart.mean() if kind == "room" else 0.0
    assert np.abs(apart).max() < within
    assert np.ptp(readings.value) > 5 * within


def test_readings_are_stacked_in_the_storys_order(told_by):
    _, story, subject, _ = told_by("nothing")
    found = retold(story, subject)
    whole, at = found.stacked(story), 0
    for r in story.kinds:
        assert whole[at : at + len(r)].tolist() == found.values[r.kind].tolist()
        at += len(r)
    assert whole.size == at


@pytest.mark.parametrize("every", [1, 37])
@pytest.mark.parametrize("name", ["nothing", "settling", "walking"])
def test_positions_along_the_drive_are_the_recorded_samples(told_by, name, every):
    runs, story, subject, per_count = told_by(name)
    t = np.concatenate([run["t_s"] for run in runs])[::every]
    y = np.concatenate([run["position"] for run in runs])[::every]
    found = positions(story.drive, subject, t - runs[0]["t_s"][0] + 0.1)
    apart = np.abs(found - y) / per_count
    assert np.sqrt(np.mean(apart**2)) < WITHIN
    assert np.ptp(y) > 200 * per_count


def test_predictions_never_use_what_was_measured(told_by):
    runs, story, subject, _ = told_by("settling")
    rng = np.random.default_rng(3)
    seen = ("position", "counts", "voltage_V", "temperature_degC", "ambient_degC", "input")
    false = [
        replace(
            run,
            columns=run.columns
            | {name: rng.normal(50.0, 5.0, len(run)) for name in seen}
            | {"current_A": 1.03 * run["current_A"]},  # who has no current has no resistance to be read
            steps=tuple(replace(s, position=float(rng.normal())) for s in run.steps),
        )
        for run in runs
    ]
    other = told(false, subject.actuator.tau_s)
    assert other.settled.value.tolist() != story.settled.value.tolist()
    before, after = retold(story, subject), retold(other, subject)
    for kind in before.values:
        np.testing.assert_allclose(after.values[kind], before.values[kind], rtol=0, atol=1e-9)


def test_outputs_and_memories_are_those_of_the_path_that_was_felt(told_by):
    _, story, subject, _ = told_by("settling")
    found = retold(story, subject)
    path = Preisach(subject.hysteresis, subject.initial).simulate(found.felt_K)
    np.testing.assert_allclose(found.output, path[found.marks], atol=1e-9)
    for state, y, mark in zip(found.states, found.output, found.marks, strict=True):
        assert state.y == y
        assert state.u == found.felt_K[mark]
        assert Preisach(subject.hysteresis, state).y == y
    coupled = [r for r in story.kinds if r.kind in ("settled", "moving", "resistance")]
    np.testing.assert_allclose(found.t_s[found.marks], np.concatenate([r.t_s for r in coupled]), atol=1e-6)


@pytest.mark.parametrize("rig", ["one_wire_twin", "two_wire_twin"])
def test_a_resistance_follows_the_output_by_its_slope(tmp_path, rig):
    """Each of two wires carries its own current and has its own austenite: one falls where the other rises."""
    runs = sitting(tmp_path, ("validation", {"points": 14}), rig=rig, noise=False)
    subject, _ = believed(wire=f"gorbet_{rig.removesuffix('_twin')}")
    story = told(runs, subject.actuator.tau_s)
    found = retold(story, subject)
    kinds = np.concatenate([[r.kind] * len(r) for r in story.kinds if r.kind in found.values])[
        : found.output.size
    ]
    assert np.all(found.follows[kinds != "resistance"] == 1.0)
    measured = next(r for r in story.others if r.kind == "resistance")
    slope, y = found.follows[kinds == "resistance"], found.output[kinds == "resistance"]
    for sign in np.unique(np.sign(slope)):
        same = np.sign(slope) == sign
        np.testing.assert_allclose(
            np.diff(measured.value[same]), slope[same][1:] * np.diff(y[same]), atol=2e-5
        )
    assert np.unique(np.sign(slope)).size == (2 if rig == "two_wire_twin" else 1)


def test_ticks_cost_nothing_without_effects_and_little_with_them(told_by):
    _, story, subject, per_count = told_by("settling")
    assert numerics(story, replace(subject, effects=())) < 1e-9
    assert 0 < numerics(story, subject) < WITHIN * per_count

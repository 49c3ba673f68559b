"""Prediction of a timeline on coarse ticks: what the plant would have shown, including its effects."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.preisach.operator import Preisach
from smarig.replay import build_timeline, numerics, predict
from smarig.replay.prediction import predict_positions

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
TRANSIENT_EFFECTS = {"sensor_lag": ("sensor_lag=5",)}  # shows only while the wire moves
LONGER = pytest.mark.long("takes ten seconds")


def selected(names):
    """All of them; two of other channels where there is time (``SMARIG_LONG``, as in ``.ci/long``)."""
    slow = ("amplifier_gain", "ambient_drift")
    return [pytest.param(name, marks=LONGER) if name in slow else name for name in names]


@pytest.fixture(scope="module")
def case_with_effect(tmp_path_factory):
    """The timeline of a noise-free session with the plant model of the twin; made once for each effect."""
    kept = {}

    def make(name):
        if name not in kept:
            runs = session_runs(
                tmp_path_factory.mktemp(name),
                LONG,
                LISTED,
                effects=(EFFECTS | TRANSIENT_EFFECTS)[name],
                noise=False,
                fine=True,
            )
            kept[name] = (
                runs,
                build_timeline(runs, twin_plant_model()[0].actuator.tau_s),
                *twin_plant_model((EFFECTS | TRANSIENT_EFFECTS)[name]),
            )
        return kept[name]

    return make


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "backlash",
        "nothing",
        "settling",
        "stress_coupling",
        "walking",
    ),
)
@pytest.mark.parametrize("name", selected(EFFECTS))
def test_settled_positions_are_the_twins(case_with_effect, name):
    _, timeline, plant_model, per_count = case_with_effect(name)
    found = predict(timeline, plant_model).values["settled"]
    assert np.abs(found - timeline.settled.value).max() < WITHIN * per_count


@pytest.mark.long("takes ten seconds", cases=("settling", "stress_coupling", "walking"))
@pytest.mark.parametrize("name", selected(name for name in EFFECTS if name != "nothing"))
def test_an_effect_shows_in_the_twins_readings(case_with_effect, name):
    """Else the agreement above would say nothing of it."""
    _, timeline, plant_model, per_count = case_with_effect(name)
    plain = predict(timeline, replace(plant_model, effects=())).values["settled"]
    assert np.abs(plain - timeline.settled.value).max() > 10 * WITHIN * per_count


@pytest.mark.long("takes five seconds")
def test_extra_effects_act_like_the_plant_models_own(case_with_effect):
    _, timeline, plant_model, _ = case_with_effect("settling")
    own = predict(timeline, plant_model).stacked(timeline)
    beside = predict(timeline, replace(plant_model, effects=()), plant_model.effects).stacked(timeline)
    assert own.tolist() == beside.tolist()


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "nothing-moving-0.002",
        "sensor_lag-moving-0.05",
        "settling-moving-0.05",
    ),
)
@pytest.mark.parametrize(
    ("name", "kind", "within"),
    [
        ("nothing", "moving", 0.002),
        ("settling", "moving", 0.05),
        ("sensor_lag", "moving", 0.05),
        ("nothing", "resistance", 1e-5),
        pytest.param("amplifier_gain", "current", 1.5e-6, marks=LONGER),
        pytest.param("ambient_drift", "room", 0.01, marks=LONGER),
    ],
)
def test_readings_of_every_kind_are_the_twins(case_with_effect, name, kind, within):
    """Within mm, ohm, A (whole µA) and K; a thermometer shows more than how far the room is from where it began."""
    _, timeline, plant_model, _ = case_with_effect(name)
    readings = next(r for r in timeline.other_readings if r.kind == kind)
    apart = predict(timeline, plant_model).values[kind] - readings.value
    apart -= apart.mean() if kind == "room" else 0.0
    assert np.abs(apart).max() < within
    assert np.ptp(readings.value) > 5 * within


def test_readings_are_stacked_in_the_timelines_order(case_with_effect):
    _, timeline, plant_model, _ = case_with_effect("nothing")
    found = predict(timeline, plant_model)
    whole, at = found.stacked(timeline), 0
    for r in timeline.all_readings:
        assert whole[at : at + len(r)].tolist() == found.values[r.kind].tolist()
        at += len(r)
    assert whole.size == at


@pytest.mark.parametrize("every", [1, 37])
@pytest.mark.parametrize("name", ["nothing", "settling", "walking"])
def test_positions_along_the_drive_are_the_recorded_samples(case_with_effect, name, every):
    runs, timeline, plant_model, per_count = case_with_effect(name)
    t = np.concatenate([run["t_s"] for run in runs])[::every]
    y = np.concatenate([run["position"] for run in runs])[::every]
    found = predict_positions(timeline.drive, plant_model, t - runs[0]["t_s"][0] + 0.1)
    apart = np.abs(found - y) / per_count
    assert np.sqrt(np.mean(apart**2)) < WITHIN
    assert np.ptp(y) > 200 * per_count


def test_predictions_never_use_what_was_measured(case_with_effect):
    runs, timeline, plant_model, _ = case_with_effect("settling")
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
    other = build_timeline(false, plant_model.actuator.tau_s)
    assert other.settled.value.tolist() != timeline.settled.value.tolist()
    before, after = predict(timeline, plant_model), predict(other, plant_model)
    for kind in before.values:
        np.testing.assert_allclose(after.values[kind], before.values[kind], rtol=0, atol=1e-9)


def test_outputs_and_memories_are_those_of_the_hysteresis_input(case_with_effect):
    _, timeline, plant_model, _ = case_with_effect("settling")
    found = predict(timeline, plant_model)
    path = Preisach(plant_model.hysteresis, plant_model.initial).simulate(found.hysteresis_input_K)
    np.testing.assert_allclose(found.output, path[found.tick_index], atol=1e-9)
    for state, y, mark in zip(found.states, found.output, found.tick_index, strict=True):
        assert state.y == y
        assert state.u == found.hysteresis_input_K[mark]
        assert Preisach(plant_model.hysteresis, state).y == y
    coupled = [r for r in timeline.all_readings if r.kind in ("settled", "moving", "resistance")]
    np.testing.assert_allclose(
        found.t_s[found.tick_index], np.concatenate([r.t_s for r in coupled]), atol=1e-6
    )


def resistances(tmp_path, rig):
    runs = session_runs(tmp_path, ("validation", {"points": 14}), rig=rig, noise=False)
    plant_model, _ = twin_plant_model(wire=f"gorbet_{rig.removesuffix('_twin')}")
    timeline = build_timeline(runs, plant_model.actuator.tau_s)
    found = predict(timeline, plant_model)
    kinds = [[r.kind] * len(r) for r in timeline.all_readings if r.kind in found.values]
    kinds = np.concatenate(kinds)[: found.output.size]
    measured = next(r for r in timeline.other_readings if r.kind == "resistance")
    return found, kinds == "resistance", measured.value


@pytest.mark.long("takes two seconds")
def test_the_resistance_of_one_wire_follows_the_output_by_its_slope(tmp_path):
    found, ohms, measured = resistances(tmp_path, "one_wire_twin")
    assert np.all(found.output_slope[~ohms] == 1.0)
    slope, y = found.output_slope[ohms], found.output[ohms]
    np.testing.assert_allclose(np.diff(measured), slope[1:] * np.diff(y), atol=2e-5)


@pytest.mark.long("takes three seconds")
def test_the_resistances_of_two_wires_follow_their_own_phases_and_not_the_output(tmp_path):
    found, ohms, measured = resistances(tmp_path, "two_wire_twin")
    assert np.all(found.output_slope[~ohms] == 1.0)
    assert np.all(found.output_slope[ohms] == 0.0)
    np.testing.assert_allclose(found.values["resistance"], measured, atol=3e-5)


def test_ticks_cost_nothing_without_effects_and_little_with_them(case_with_effect):
    _, timeline, plant_model, per_count = case_with_effect("settling")
    assert numerics(timeline, replace(plant_model, effects=())) < 1e-9
    assert 0 < numerics(timeline, plant_model) < WITHIN * per_count

"""Two ways to simulate a timeline: along a known path, and tick by tick with the complete plant."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.plant.effect_catalogue import effect_types, effects_from_pairs
from smarig.replay import ReadingSeries, build_timeline
from smarig.replay import trajectory as life
from smarig.replay.input_trajectory import hysteresis_input
from smarig.replay.timeline import CurrentProfile

OUTPUT_DEPENDENT = {
    "accommodation",
    "fatigue",
    "latent_heat",
    "resistance_phase",
    "stress_coupling",
}  # for the output


WIRES = {"one_wire": effect_types("one_wire"), "two_wire": effect_types("two_wire")}
CASES = [pytest.param(wire, kind, id=f"{wire}-{kind.name}") for wire in WIRES for kind in WIRES[wire]]


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    """(timeline, plant model) of each wire."""
    found = {}
    for wire in WIRES:
        runs = session_runs(tmp_path_factory.mktemp(wire), LONG, LISTED, rig=f"{wire}_twin")
        plant_model, _ = twin_plant_model(wire=f"gorbet_{wire}")
        found[wire] = build_timeline(runs, plant_model.actuator.tau_s), plant_model
    return found


def by_parts_and_by_ticks(timeline, plant_model, effects):
    """The same life by parts of ticks and tick by tick."""
    inputs = hysteresis_input(timeline, plant_model, effects)
    assert inputs is not None
    return life._by_parts(timeline, plant_model, effects, inputs), life._by_ticks(
        timeline, plant_model, effects
    )


def assert_the_same(a, b):
    assert np.array_equal(a.columns, b.columns)
    assert a.states == b.states
    assert np.array_equal(a.hysteresis_input_K, b.hysteresis_input_K)


@pytest.mark.long("takes three seconds", cases=("one_wire-accommodation",))
@pytest.mark.parametrize(("wire", "kind"), CASES)
def test_both_methods_give_the_same_to_the_last_bit(cases, wire, kind):
    timeline, plant_model = cases[wire]
    effects = (kind(),)
    assert (hysteresis_input(timeline, plant_model, effects) is None) == (kind.name in OUTPUT_DEPENDENT)
    if kind.name not in OUTPUT_DEPENDENT:
        assert_the_same(*by_parts_and_by_ticks(timeline, plant_model, effects))


@pytest.mark.parametrize("wire", WIRES)
def test_an_ambient_temperature_and_shifts_of_the_input_act_on_one_heating(cases, wire):
    """Effects that heat no wire, in each other's company: their hooks meet the state of a complete plant."""
    timeline, plant_model = cases[wire]
    effects = effects_from_pairs(["ambient_drift=4", "temperature_memory=3", "settling=0.2"])
    assert_the_same(*by_parts_and_by_ticks(timeline, plant_model, effects))


@pytest.mark.parametrize("shift_K", [-20.0, 3.0, 25.0])
@pytest.mark.parametrize("others", [[], ["ambient_drift=2", "noncongruency=10"]])
@pytest.mark.parametrize("wire", WIRES)
def test_a_feedback_is_solved_where_the_input_turns_or_is_read(cases, wire, others, shift_K, monkeypatch):
    """The same as tick by tick, to the tolerance of the solver, without simulating the ticks between."""
    timeline, plant_model = cases[wire]
    effects = tuple(effects_from_pairs([f"stress_coupling={shift_K}", *others]))
    b = life._by_ticks(timeline, plant_model, effects)
    monkeypatch.setattr(life, "_by_ticks", None)
    a = life.simulate_timeline(timeline, plant_model, effects)
    plain = life.simulate_timeline(timeline, plant_model, effects[1:])
    np.testing.assert_allclose(a.columns, b.columns, atol=1e-3)  # counts
    np.testing.assert_allclose(a["output"], b["output"], atol=1e-5)
    assert np.abs(a["output"] - plain["output"]).max() > 0.1  # ten thousand times the difference above
    read = timeline.ticks[2]
    np.testing.assert_allclose(a.hysteresis_input_K[read], b.hysteresis_input_K[read], atol=1e-4)
    assert [len(s.extrema) for s in a.states] == [len(s.extrema) for s in b.states]


@pytest.mark.parametrize(
    "pairs",
    [
        ["accommodation"],
        ["fatigue"],
        ["coulomb_friction=2", "fatigue", "walking", "sensor_lag"],
        ["convection", "accommodation", "backlash"],
    ],
)
@pytest.mark.parametrize("wire", WIRES)
def test_a_shift_by_past_outputs_needs_no_ticks(cases, wire, pairs, monkeypatch):
    timeline, plant_model = cases[wire]
    effects = tuple(effects_from_pairs(pairs))
    b = life._by_ticks(timeline, plant_model, effects)
    monkeypatch.setattr(life, "_by_ticks", None)
    assert_the_same(life.simulate_timeline(timeline, plant_model, effects), b)


def test_a_feedback_beside_a_memory_of_the_output_is_simulated_tick_by_tick(cases):
    timeline, plant_model = cases["one_wire"]
    effects = tuple(effects_from_pairs(["stress_coupling", "backlash"]))
    assert_the_same(
        life.simulate_timeline(timeline, plant_model, effects),
        life._by_ticks(timeline, plant_model, effects),
    )


@pytest.mark.parametrize("heat", ["wire_lag", "convection"])
@pytest.mark.parametrize("wire", WIRES)
def test_a_late_sensor_is_late_by_whole_ticks_however_these_are_cut(cases, wire, heat):
    timeline, plant_model = cases[wire]
    cut = effects_from_pairs([heat])
    inputs = hysteresis_input(timeline, plant_model, cut)
    assert inputs is not None
    assert inputs["t_s"].size > 1.5 * timeline.ticks[0].size
    late, true = (
        by_parts_and_by_ticks(timeline, plant_model, e)
        for e in ((*cut, *effects_from_pairs(["sensor_lag"])), cut)
    )
    assert_the_same(*late)
    assert np.abs(late[0]["counts"] - true[0]["counts"]).max() > 10


def test_backlash_starts_from_its_rest_position(cases):
    """A current from the first instant: in the first tick already the wire moves by more than the play."""
    timeline, plant_model = cases["two_wire"]
    at = np.array([0.1, 1.0, 5.0, 19.0])
    settled = ReadingSeries("settled", np.zeros(4), at, np.arange(4), timeline.unit)
    at_once = replace(
        timeline, drive=CurrentProfile(at[-1:], np.array([1.5])), settled=settled, other_readings=()
    )
    a, b = by_parts_and_by_ticks(at_once, plant_model, effects_from_pairs(["backlash"]))
    assert_the_same(a, b)
    half = 0.0075 * plant_model.stroke
    assert a["output"][0] > 5 * half
    np.testing.assert_allclose(a["counts"] * plant_model.per_count, a["output"] - half, rtol=1e-12)

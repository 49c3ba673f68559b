"""The contract of every effect: identity at zero strength, a change otherwise, bounds, texts."""

import math

import numpy as np
import pytest

from plant.effects.driven import CATALOGUE, WIRES, driven, kind, settled, wire_of
from smarig.core.errors import UsageError
from smarig.plant.effect import EffectContext, PlantState, Stage
from smarig.plant.plant import Plant

OF_THE_CONTRACT = [
    "settling",
    "ambient_drift",
    "resistance_phase",
    "stress_coupling",
    "accommodation",
    "temperature_memory",
    "noncongruency",
    "fatigue",
    "walking",
    "training",
    "creep",
    "backlash",
    "slip",
    "eccentricity",
    "slack",
    "saturation",
    "cross_talk",
    "wire_lag",
    "latent_heat",
    "convection",
    "end_conduction",
    "r_phase",
    "amplifier_gain",
    "dead_zone",
    "sensor_lag",
    "coulomb_friction",
    "thermal_expansion",
]
FALLS_AND_RISES = [0.95, 0.5, 0.8, 0.3, 0.9, 0.62, 0.75, 0.55, 0.98, 0.1]
WHEN = {"slip": {"at_h": 0.02}, "ambient_drift": {"period_h": 0.5}}  # within the short drive


def effect_of(name, strength=None):
    return kind(name)(strength, **WHEN.get(name, {}))


def test_the_catalogue_holds_the_effects_of_the_contract():
    assert set(OF_THE_CONTRACT) <= set(CATALOGUE)


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("wire", list(WIRES))
def test_at_zero_strength_it_is_the_identity_bit_for_bit(name, wire):
    short = {"wire": wire, "hold_s": 6.0}
    nothing = driven(FALLS_AND_RISES, **short)
    assert np.array_equal(driven(FALLS_AND_RISES, effect_of(name, 0.0), **short), nothing)
    beside = [kind("walking")(0.4), kind("settling")(1.0)]
    assert np.array_equal(
        driven(FALLS_AND_RISES, effect_of(name, 0.0), *beside, **short),
        driven(FALLS_AND_RISES, *beside, **short),
    )


@pytest.mark.parametrize("name", CATALOGUE)
def test_an_injected_effect_changes_the_record(name):
    wire = wire_of(name)
    change = driven(FALLS_AND_RISES, effect_of(name), wire=wire) - driven(FALLS_AND_RISES, wire=wire)
    stroke = EffectContext(*WIRES[wire]).stroke
    assert np.abs(change).max() > 1e-3 * stroke
    assert np.all(np.isfinite(change))


@pytest.mark.parametrize("name", CATALOGUE)
def test_half_as_strong_it_changes_less_and_a_trace_of_it_next_to_nothing(name):
    wire, typical = wire_of(name), kind(name).primary.typical
    base = driven(FALLS_AND_RISES, wire=wire)
    size = [
        np.sqrt(np.mean((driven(FALLS_AND_RISES, effect_of(name, typical * s), wire=wire) - base) ** 2))
        for s in (1.0, 0.5, 1e-4)
    ]
    assert 0.05 * size[0] < size[1] < 0.95 * size[0]
    assert size[2] < 1e-2 * size[0]


@pytest.mark.parametrize("name", CATALOGUE)
def test_it_is_physics_and_not_the_length_of_a_tick(name):
    wire = wire_of(name)

    def change(dt_s):
        every = round(0.1 / dt_s)
        with_it = driven(FALLS_AND_RISES, effect_of(name), wire=wire, dt_s=dt_s)
        return (with_it - driven(FALLS_AND_RISES, wire=wire, dt_s=dt_s))[:, every - 1 :: every]

    fine, coarse = change(0.025), change(0.1)
    assert np.sqrt(np.mean((fine - coarse) ** 2)) < 0.03 * np.sqrt(np.mean(fine**2))


@pytest.mark.parametrize("name", CATALOGUE)
def test_one_effect_in_two_plants_has_a_separate_state_in_each(name):
    effect, wire = effect_of(name), wire_of(name)
    once = driven(FALLS_AND_RISES, effect, wire=wire, hold_s=5.0)
    assert np.array_equal(driven(FALLS_AND_RISES, effect, wire=wire, hold_s=5.0), once)


def test_composition_does_not_depend_on_the_order_given():
    effects = [effect_of(name) for name in CATALOGUE]
    short = {"wire": "two_wire", "hold_s": 3.0}
    assert np.array_equal(
        driven(FALLS_AND_RISES, *effects, **short), driven(FALLS_AND_RISES, *reversed(effects), **short)
    )


@pytest.mark.parametrize("name", CATALOGUE)
def test_time_passes_in_steps_of_any_length(name):
    """``advance`` is ``step`` for other durations: the same ticks, one by one."""
    actuator, hysteresis, initial = WIRES[wire_of(name)]
    one, other = (Plant(actuator, hysteresis, initial, 0.01, [effect_of(name)]) for _ in range(2))
    for i in FALLS_AND_RISES:
        for _ in range(150):
            a, b = one.sensed(one.step(i)), other.sensed(other.advance(i, 0.01))
            assert a == pytest.approx(b, abs=1e-9)


@pytest.mark.parametrize("name", ["resistance_phase", "latent_heat", "convection"])
def test_where_heat_depends_on_the_output_a_long_tick_is_no_coarse_one(name):
    """``advance`` by a second comes to where a hundred steps do."""
    actuator, hysteresis, initial = WIRES[wire_of(name)]
    one, other = (Plant(actuator, hysteresis, initial, 0.01, [effect_of(name)]) for _ in range(2))
    apart = []
    for i in FALLS_AND_RISES:
        for _ in range(12):
            fine = [one.sensed(one.step(i)) for _ in range(100)][-1]
            apart.append(abs(fine - other.sensed(other.advance(i, 1.0))))
    assert max(apart) < 2e-3 * EffectContext(actuator, hysteresis, initial).stroke


def test_the_delay_of_a_sensor_does_not_depend_on_the_heat():
    """Ticks are divided where heat depends on the output, but the sensor is read once per tick."""
    actuator, hysteresis, initial = WIRES["one_wire"]

    def seen(tick_s):
        effects = [kind("sensor_lag")(5.0), kind("wire_lag")(40.0)]
        plant = Plant(actuator, hysteresis, initial, 0.1, effects)
        return [plant.sensed(plant.advance(0.8, tick_s)) for _ in range(round(10.0 / tick_s))][-1]

    stroke = EffectContext(actuator, hysteresis, initial).stroke
    assert seen(0.02) > 0.3 * stroke
    assert seen(0.5) == pytest.approx(seen(0.02), abs=2e-3 * stroke)


@pytest.mark.parametrize("name", CATALOGUE)
def test_its_values_have_bounds_units_and_sources(name):
    k = kind(name)
    assert k.name == name
    for p in k.parameters:
        assert p.lower <= p.typical <= p.upper
        assert p.unit
        assert len(p.source) > 10 or p.source == "when"
        for wrong in (p.lower - 1, p.upper + 1, math.nan, math.inf, "much", None):
            with pytest.raises(UsageError, match=rf"{name}\.{p.name} = .* must lie between"):
                k(**{p.name: wrong})
    assert k.primary.lower <= 0 <= k.primary.upper
    with pytest.raises(UsageError, match=f"{name} has no parameter 'strenght'"):
        k(strenght=1.0)


@pytest.mark.parametrize("name", CATALOGUE)
def test_its_words_are_there_and_name_effects_that_exist(name):
    k = kind(name)
    module = __import__(f"smarig.plant.effects.{name}", fromlist=["_"])
    assert module.__doc__.startswith(k.summary)
    assert "    " in module.__doc__, "no equation"
    assert min(map(len, (k.summary, k.enters, k.looks_like, k.separated_by, k.remedy))) > 5
    assert set(k.confused_with) <= set(CATALOGUE) - {name}
    assert repr(k()).startswith(f"{name}({k.primary.name}=")
    assert k().to_json() == {"name": name, "parameters": k().values}


@pytest.mark.parametrize("name", [n for n in CATALOGUE if kind(n).change])
def test_what_it_does_is_said_in_the_unit_of_the_output(name):
    strength = kind(name).primary
    assert "percent" in strength.name
    assert strength.unit.startswith("%")
    assert "6 mm" in kind(name)(strength.upper).change_text(600 / strength.upper, "mm")
    if strength.lower < 0:
        assert "up" in (up := kind(name)(strength.upper).change_text(1.0, "mm")) or "rises" in up
        assert "down" in (down := kind(name)(strength.lower).change_text(1.0, "mm")) or "falls" in down


@pytest.mark.parametrize("name", [n for n in CATALOGUE if kind(n).change and kind(n).primary.lower < 0])
def test_its_direction_is_that_of_the_output(name):
    """A positive strength raises the position, after one cycle and late."""
    context = EffectContext(*WIRES[wire_of(name)])
    late = PlantState(t_s=1e9, travel=2.0)
    added = kind(name)(kind(name).primary.upper).hooks(context)[Stage.ADDITIVE](0.0, late)
    assert added == pytest.approx(kind(name).primary.upper / 100 * context.stroke)


@pytest.mark.parametrize("name", CATALOGUE)
def test_it_acts_at_the_stages_it_names_only(name):
    context = EffectContext(*WIRES[wire_of(name)])
    assert set(effect_of(name).hooks(context)) <= set(Stage)
    assert effect_of(name).hooks(context)
    assert not effect_of(name, 0.0).hooks(context)


def test_a_memoryless_effect_does_not_depend_on_earlier_calls():
    """Asked for many moments and for the last alone it answers the same, to the bit; the others do not."""
    late = (Stage.FEEDBACK, Stage.OUTPUT, Stage.ADDITIVE, Stage.SENSOR)
    rng = np.random.default_rng(5)
    forgetful = set()
    for name in CATALOGUE:
        actuator, hysteresis, initial = WIRES[wire_of(name)]
        context = EffectContext(actuator, hysteresis, initial)
        moments = [(PlantState(*rng.uniform(0.1, 90.0, 9)), float(rng.uniform(0, 12))) for _ in range(40)]
        for moment, y in moments:
            moment.output, moment.share, moment.travel = y, float(rng.uniform()), float(rng.uniform(0, 9))
        answers = []
        for asked in (moments, moments[-1:]):
            hooks = {stage: hook for stage, hook in effect_of(name).hooks(context).items() if stage in late}
            answers.append([[hook(y, moment) for moment, y in asked][-1] for hook in hooks.values()])
        if answers[0] and answers[0] == answers[1]:
            forgetful.add(name)
    assert forgetful == {name for name in CATALOGUE if kind(name).memoryless}


def test_two_wires_share_their_room():
    drift = effect_of("ambient_drift")
    assert np.array_equal(
        settled(FALLS_AND_RISES, drift, wire="two_wire"), settled(FALLS_AND_RISES, wire="two_wire")
    )

"""A learned effect: its law, its memory of commands, and how a model file keeps it."""

import numpy as np
import pytest

from replay.sittings import LISTED, session_runs, twin_plant_model
from smarig.core import DataError, UsageError
from smarig.plant import LearnedShape, learned_effect_type
from smarig.plant.effect_catalogue import effects_from_json
from smarig.replay import build_timeline, predict

TIME = LearnedShape("time", "output", (0.0, 600.0, 1200.0), "mm")


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    runs = session_runs(tmp_path_factory.mktemp("learned"), LISTED, noise=False, fine=True)
    plant_model, _ = twin_plant_model()
    return build_timeline(runs, plant_model.actuator.tau_s)


def change(timeline, shape, *values):
    """What a law adds to the settled positions."""
    plant_model, _ = twin_plant_model()
    kind = learned_effect_type(shape, 100.0)
    effect = kind(**dict(zip((p.name for p in kind.parameters), values, strict=True)))
    with_law = predict(timeline, plant_model, [effect]).values["settled"]
    return with_law - predict(timeline, plant_model).values["settled"]


def test_a_law_of_time_at_the_output_is_added_between_its_knots_and_stays_beyond_them(timeline):
    added = change(timeline, TIME, 0.4, -0.2)
    t_s = timeline.settled.t_s
    expected = np.interp(t_s, [0.0, 600.0, 1200.0], [0.0, 0.4, -0.2])
    np.testing.assert_allclose(added - added[0], expected - expected[0], atol=0.02)


def test_a_law_at_the_input_acts_through_the_hysteresis(timeline):
    """Where the wire is saturated, a temperature changes nothing."""
    warmer = LearnedShape("history", "input", (0.0, 1.0), "K")  # by 2 K after any hold but the coldest
    added = change(timeline, warmer, 2.0)
    saturated = timeline.target_K < 1.0
    np.testing.assert_allclose(added[saturated], 0.0, atol=1e-9)
    assert np.abs(added[~saturated]).max() > 0.02


def test_a_law_at_the_heat_loss_makes_the_wire_hotter_and_slower(timeline):
    """1/(1 + f) of the heat loss: (1 + f) times the steady temperatures, and the time constant."""
    plant_model, _ = twin_plant_model()
    kind = learned_effect_type(LearnedShape("time", "heat_loss", (-1.0, 0.0), "1"), 1.0)
    plain, dusty = predict(timeline, plant_model), predict(timeline, plant_model, [kind(0.1)])
    ratio = dusty.hysteresis_input_K / np.maximum(plain.hysteresis_input_K, 1e-9)
    settled = plain.tick_index[plain.of("settled")][timeline.target_K > 1.0]
    np.testing.assert_allclose(ratio[settled], 1.1, atol=1e-3)
    rising = (plain.hysteresis_input_K > 1.0) & (plain.hysteresis_input_K < 30.0)
    assert ratio[rising].min() < 1.05


@pytest.mark.parametrize(
    ("variable", "values"),
    [
        ("step", np.diff((0.0, 0.0, 60.0, 90.0, 50.0, 10.0, 80.0, 40.0, 100.0))),
        ("history", (0.0, 0.0, 60.0, 90.0, 50.0, 10.0, 80.0, 40.0)),
        ("reversals", (0, 0, 0, 1, 1, 2, 3, 4)),
    ],
)
def test_variables_of_the_commands_are_those_of_the_protocol(timeline, variable, values):
    """A law that is the identity shows its own variable, in mm."""
    low, high = float(min(values)) - 1.0, float(max(values)) + 1.0
    added = change(timeline, LearnedShape(variable, "output", (low, high), "mm"), 0.01 * (high - low))
    assert timeline.settled.value.size == len(values)
    np.testing.assert_allclose(np.diff(added), 0.01 * np.diff(values), atol=2e-3)


def test_variables_of_time_and_output_are_those_of_the_record(timeline):
    """Laws that are the identity: the logarithm of the time since the step, its fading, and the output."""
    elapsed = timeline.settled.t_s - np.concatenate([[0.0], timeline.drive.end_s[:-1]])
    hold = change(timeline, LearnedShape("hold", "output", (0.0, 3.0), "mm"), 3.0)
    np.testing.assert_allclose(hold, np.log10(elapsed), atol=0.01)
    brief = LearnedShape("rate", "output", (-1.0, 1.0), "mm")
    rate = (change(timeline, brief, 2.0) - 1.0)[1:]
    rising = np.sign(np.diff(timeline.target_K))
    np.testing.assert_allclose(rate, rising * np.exp(-elapsed[1:] / 10.0), rtol=0.1)
    level = change(timeline, LearnedShape("level", "output", (-1.0, 20.0), "mm"), 21.0) - 1.0
    np.testing.assert_allclose(level, predict(timeline, twin_plant_model()[0]).values["settled"], atol=1e-6)


@pytest.mark.parametrize(("name", "tau_s"), [("power_over_2_min", 120.0), ("power_over_15_min", 900.0)])
def test_a_mean_power_is_the_step_response_of_a_first_order_lag(timeline, name, tau_s):
    """A law that is the identity, against the closed form: z ← T_ss + (z − T_ss) e^(−Δt/τ) in each hold."""
    mean = 10 * change(timeline, LearnedShape(name, "output", (0.0, 200.0), "mm"), 20.0)
    z, expected, ends_s = 0.0, [], timeline.drive.end_s
    for target, begin, read, end in zip(timeline.target_K, [0.0, *ends_s], timeline.settled.t_s, ends_s):
        expected.append(target + (z - target) * np.exp(-(read - begin) / tau_s))
        z = target + (z - target) * np.exp(-(end - begin) / tau_s)
    np.testing.assert_allclose(mean, expected, rtol=2e-3, atol=0.02)


def test_a_mean_level_follows_the_output_late(timeline):
    """Its error obeys the same equation: z' = (y − z)/τ, integrated from the output at every tick."""
    plant_model, _ = twin_plant_model()
    base = predict(timeline, plant_model)
    y = base.outputs_along(plant_model.hysteresis, plant_model.initial, base.hysteresis_input_K)
    mean = change(timeline, LearnedShape("level_over_2_min", "output", (-5.0, 45.0), "mm"), 50.0) - 5.0
    z, at = y[0], []
    for late, dt_s in zip(y, np.diff(base.t_s, prepend=base.t_s[0])):
        z += (late - z) * (1 - np.exp(-dt_s / 120.0))
        at.append(z)
    np.testing.assert_allclose(mean, np.array(at)[base.tick_index[:8]], atol=0.02)


def test_variables_have_words():
    def words(variable):
        return LearnedShape(variable, "output", (0.0, 1.0), "mm").variable_text

    assert words("power_over_2_min") == "the mean power of the last 2 min"
    assert words("level_over_15_min") == "the mean output of the last 15 min"
    assert words("history") == "history"


def test_a_model_file_keeps_the_law():
    effect = learned_effect_type(TIME, 10.0)(value_1=0.4, value_2=-0.2)
    (again,) = effects_from_json([effect.to_json()])
    assert again.values == effect.values
    assert again.kind.shape == TIME
    assert again.to_json() == effect.to_json()


@pytest.mark.parametrize(
    ("change_of_shape", "message"),
    [
        ({"variable": "moon"}, "cannot depend on 'moon'"),
        ({"enters": "side"}, "at the 'side'"),
        ({"knots": [0.0, 0.0, 1.0]}, "must increase"),
        ({"knots": [0.0]}, "2 to 100 knots"),
        ({"knots": [0.0, 1.0, float("inf")]}, "plausible size"),
        ({"knots": [0.0, "1", 2.0]}, "plausible size"),
        ({"knots": "012"}, "2 to 100 knots"),
        ({"knots": [float(k) for k in range(1000)]}, "2 to 100 knots"),
        ({"variable": "level", "enters": "input"}, "cannot depend on 'level'"),
        ({"variable": ["time"]}, "cannot depend on"),
        ({"unit": "\x1b[31m"}, "short text"),
    ],
)
def test_a_damaged_law_is_refused_in_a_sentence(change_of_shape, message):
    stored = learned_effect_type(TIME, 10.0)(value_1=0.4, value_2=-0.2).to_json()
    stored["shape"] |= change_of_shape
    with pytest.raises((DataError, UsageError), match=message):
        effects_from_json([stored])


@pytest.mark.parametrize(
    "change_of_effect",
    [
        {"parameters": {"value_1": 0.4}},
        {"parameters": {"value_1": 0.4, "value_2": 0.1, "value_3": 0.1}},
        {"parameters": {"value_1": float("nan"), "value_2": 0.1}},
        {"parameters": {"value_1": 1e300, "value_2": 0.1}},
        {"parameters": {"value_1": "0.4", "value_2": 0.1}},
        {"parameters": None},
        {"parameters": [1, 2]},
        {"name": "creep"},
        {"shape": None},
    ],
)
def test_damaged_values_of_a_law_are_refused(change_of_effect):
    stored = learned_effect_type(TIME, 10.0)(value_1=0.4, value_2=-0.2).to_json()
    with pytest.raises((DataError, UsageError)):
        effects_from_json([stored | change_of_effect])


def test_a_law_that_is_zero_at_its_first_value_still_acts_beyond_it(timeline):
    added = change(timeline, LearnedShape("time", "output", (0.0, 100.0, 500.0), "mm"), 0.0, 0.5)
    assert np.ptp(added) > 0.1

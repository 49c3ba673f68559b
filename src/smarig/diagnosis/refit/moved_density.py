"""A density moved to where effects move the input, so that a fit with these effects starts where it belongs.

    F(f(α), f(β)) = F₀(α, β),    f: the input with effects as a rising function of the input without

A density was identified along the input without effects. An amplifier with a gain of 1 + g scales the temperatures by
(1 + g)², and so every relay's switching input. With the density left in place, the effects would have to pay for it.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import isotonic_regression

from smarig.core import Array
from smarig.preisach import Everett, FodTable
from smarig.replay import PlantModel, Prediction, Timeline, predict

LEAST_DISTANCE = 1e-6  # of nodes, in input ranges: between closer ones a slope is rounding
NODES = 200  # of the moved density if its own has no nodes


def with_moved_density(timeline: Timeline, plant_model: PlantModel, density: Everett) -> PlantModel:
    """The plant model with ``density``, identified without effects, moved to where its effects move the input."""
    unmoved = replace(plant_model, hysteresis=density)
    if not plant_model.effects:
        return unmoved
    before = predict(timeline, replace(unmoved, effects=()))
    after = predict(timeline, plant_model)
    return replace(plant_model, hysteresis=_between_inputs(density, before, after))


def moved_with(
    timeline: Timeline, base: PlantModel, prediction: Prediction, plant_model: PlantModel
) -> Everett:
    """The density of a base model, moved from its input to that of a plant model; ``prediction`` is of the base."""
    if plant_model.effects == base.effects:
        return base.hysteresis
    after = predict(timeline, replace(plant_model, hysteresis=base.hysteresis))
    return _between_inputs(base.hysteresis, prediction, after)


def without_effects(timeline: Timeline, plant_model: PlantModel, prediction: Prediction) -> PlantModel:
    """The plant model without its effects, its density moved to the input without them; ``prediction`` is with them."""
    plain = replace(plant_model, effects=())
    unmoved = predict(timeline, plain)
    return replace(plain, hysteresis=_between_inputs(plant_model.hysteresis, prediction, unmoved))


def _between_inputs(density: Everett, before: Prediction, after: Prediction) -> Everett:
    """A density of the input of one prediction, moved to that of another."""
    first, second = _settled_inputs(before), _settled_inputs(after)
    if not np.any((first > density.lower) & (first < density.upper)):
        return density
    at, moved = rising_map(first, second, density.lower, density.upper)
    if np.allclose(at, moved, rtol=1e-12, atol=0.0):
        return density
    return _moved(density, at, moved)


def _settled_inputs(prediction: Prediction) -> Array:
    """The input of the hysteresis at settled points, K: on the way, one input is no function of the other."""
    return prediction.hysteresis_input_K[prediction.tick_index[prediction.of("settled")]]


def rising_map(before: Array, after: Array, lower: float, upper: float) -> tuple[Array, Array]:
    """(inputs without, with effects): the rising function nearest to the values at settled points, from end to end.

    Beyond saturation the input is not known, only that it is beyond.
    """
    inside = (before > lower) & (before < upper)
    at, where, count = np.unique(before[inside], return_inverse=True, return_counts=True)
    moved = isotonic_regression(np.bincount(where, after[inside]) / count, weights=count).x
    below, above = after[before <= lower], after[before >= upper]
    first = min(below.max() if below.size else moved[0] - (at[0] - lower), moved[0])
    last = max(above.min() if above.size else moved[-1] + (upper - at[-1]), moved[-1])
    return np.concatenate([[lower], at, [upper]]), np.concatenate([[first], moved, [last]])


def _moved(density: Everett, at: Array, moved: Array) -> FodTable:
    """The table of a density with its inputs ``at`` moved; what lies beyond the range switches at its end."""
    lower, upper = density.lower, density.upper
    own = np.asarray(getattr(density, "kinks", ()))  # a formula has none
    inner = np.interp(own if own.size else np.linspace(lower, upper, NODES + 1), at, moved)
    apart = LEAST_DISTANCE * (upper - lower)
    inner = inner[np.diff(inner, prepend=lower) > apart]
    nodes = np.concatenate([[lower], inner[(inner > lower + apart) & (inner < upper - apart)], [upper]])
    last = np.append(np.diff(moved) > 0, True)  # of inputs that move to the same: what is below has switched
    sources = np.interp(nodes, moved[last], at[last])
    sources[0], sources[-1] = lower, upper
    a, b = np.meshgrid(sources, sources, indexing="ij")
    since_lower = np.asarray(density.swept(sources, np.full(sources.size, lower)))
    values = density.y_lower + since_lower[:, None] - np.asarray(density.swept(a, np.minimum(a, b)))
    table = np.where(np.tri(nodes.size, dtype=bool), values, np.nan)
    return FodTable(nodes, table, getattr(density, "unit", ""))

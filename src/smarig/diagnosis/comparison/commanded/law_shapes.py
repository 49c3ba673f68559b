"""Where a learned law of one variable has its knots, and the law that a fit starts from."""

import numpy as np

from smarig.core import Array
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.plant import Effect, LearnedShape, can_be_learned, learned_effect_type
from smarig.replay import PlantModel, Prediction, Timeline

KNOTS = 5
LEAST_DISTANCE = 0.05  # of knots, in ranges of the variable


def law_shape(
    timeline: Timeline,
    base: PlantModel,
    prediction: Prediction,
    variable: str,
    place: str,
) -> LearnedShape | None:
    """Knots at equal shares of a variable's values; None if it hardly varies, or if a density has the law anyway."""
    if not can_be_learned(variable, place):
        return None
    z = _values(timeline, base, prediction, variable)
    knots = _apart(np.quantile(z, np.linspace(0, 1, KNOTS)))
    unit = {"output": timeline.unit, "input": "K", "heat_loss": "1"}[place]
    return LearnedShape(variable, place, tuple(knots.tolist()), unit) if knots.size > 1 else None


def _apart(z: Array) -> Array:
    """The values that lie apart from those before them by a share of the whole range, to nine decimals."""
    first, *later = z.tolist()
    kept = [first]
    for value in later:
        if value - kept[-1] > LEAST_DISTANCE * (z[-1] - z[0]):
            kept.append(value)
    return np.array([round(value, 9) for value in kept])


def _values(timeline: Timeline, base: PlantModel, prediction: Prediction, variable: str) -> Array:
    """The variable (n,) at positions, as the simulated plant has it."""
    count = sum(len(r) for r in timeline.positions_only.all_readings)
    if variable == "level":
        return prediction.output[:count]
    if variable == "cycle":
        path = prediction.outputs_along(base.hysteresis, base.initial, prediction.hysteresis_input_K)
        travel = np.cumsum(np.abs(np.diff(path, prepend=path[0])))
        return travel[prediction.tick_index[:count]] / (2 * abs(base.stroke))
    z = DriveStatistics(timeline).variables(prediction)[variable]
    return z / np.log(10.0) if variable == "hold" else z


def law_start(base: PlantModel, shape: LearnedShape) -> Effect:
    """The law that is zero everywhere, where a fit starts."""
    h = base.hysteresis
    extent = {"output": abs(base.stroke), "input": h.upper - h.lower, "heat_loss": 1.0}[shape.enters]
    kind = learned_effect_type(shape, extent)
    return kind(**{p.name: 0.0 for p in kind.parameters})

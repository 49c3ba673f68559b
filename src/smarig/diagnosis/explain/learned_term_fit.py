"""The missing term of a model of commanded runs: a law of one variable, learned together with the density.

The variables are tried in the order in which flexible discrepancies explain the readings. A law must be likelier than
no law by more than its values are free to gain, and must predict blocks left out of the fit better.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.explain.discrepancy import ranked_places
from smarig.diagnosis.explain.explanation import Explanation, fit_explanation
from smarig.diagnosis.explain.left_out_blocks import LeftOutBlocks, left_out_blocks
from smarig.diagnosis.explain.means_of_minutes import means_of_minutes
from smarig.diagnosis.looks_like import PLANT_EFFECTS
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import LEARNED_FROM, Effect, LearnedShape, can_be_learned, learned_effect_type
from smarig.preisach import Everett
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
TRIED = 4  # laws fitted
KNOTS = 5
LEAST_DISTANCE = 0.05  # of knots, in ranges of the variable
ROUNDS = 3  # of values, then density
MIN_GAIN_NATS = 10.0  # of the law, beyond what its free values gain by chance
MIN_LEFT_OUT_NATS = 5.0  # on blocks left out
DRAWS, CHANCE = 2000, 0.05  # resamples of the blocks, and the share of them in which the law may lose
DIFFERENCE_SHARE = 0.1  # of a value's typical size, for derivatives


@dataclass(frozen=True, eq=False)
class LearnedTermFit:
    """A law with its density, its gain (nats) over none and on blocks left out, and the share of the error on left-out
    blocks that it removes.
    """

    explanation: Explanation
    gain: float
    left_out: float
    gain_blocks: float

    @property
    def shape(self) -> LearnedShape:
        """Variable, place and knots."""
        return self.explanation.effects[0].kind.shape

    def to_json(self) -> dict[str, Any]:
        """The object ``learned`` of the command line, as for measured inputs."""
        shape = self.shape
        term = {"variables": [shape.variable], "enters": shape.enters, "formula": None, "points": self.points}
        whole = {"gain_blocks": self.gain_blocks, "looks_like": list(self.looks_like)}
        units = {"unit": shape.unit, "variable_unit": shape.variable_unit}
        return term | whole | {"terms": [term | {"form": shape.enters} | units]}

    @property
    def points(self) -> list[list[float]]:
        """[variable, value] at each knot, in their units."""
        values = (0.0, *self.explanation.effects[0].values.values())
        return [[z, value] for z, value in zip(self.shape.knots_in_unit, values)]

    @property
    def looks_like(self) -> tuple[str, ...]:
        """The effects that leave an error which depends on the same variable."""
        return PLANT_EFFECTS.get(self.shape.variable, ())


def learned_term(
    timeline: Timeline,
    base: PlantModel,
    plain: Refit,
    original: Everett,
) -> LearnedTermFit | None:
    """The law that gains most on blocks left out, or None if no law passes.

    ``base`` and ``plain`` are the model without effects and its refit.
    """
    prediction = predict(timeline, base)
    means = means_of_minutes(timeline, base, prediction)
    places = ranked_places(timeline, base, plain, means)
    shapes = [law_shape(timeline, base, prediction, means, *p) for p in places if p[0] in LEARNED_FROM]
    tried = [shape for shape in shapes if shape is not None][:TRIED]
    before = left_out_blocks(timeline, plain)
    found = [_fitted(timeline, base, plain, original, shape, before) for shape in tried]
    return max((f for f in found if f is not None), key=lambda f: f.left_out, default=None)


def law_of(
    timeline: Timeline, base: PlantModel, plain: Refit, original: Everett, variable: str
) -> LearnedTermFit | None:
    """The law of one variable, at the likelier place; None if it does not predict blocks left out better."""
    places = (p for p in ranked_places(timeline, base, plain, {}) if p[0] == variable)
    place = next(places, None)
    if place is None or variable not in LEARNED_FROM:
        return None
    shape = law_shape(timeline, base, predict(timeline, base), {}, *place)
    return shape and _fitted(timeline, base, plain, original, shape, left_out_blocks(timeline, plain))


def law_shape(
    timeline: Timeline,
    base: PlantModel,
    prediction: Prediction,
    means: dict[str, Array],
    variable: str,
    place: str,
) -> LearnedShape | None:
    """Knots at equal shares of a variable's values; None if it hardly varies, or if a density has the law anyway."""
    if not can_be_learned(variable, place):
        return None
    z = means[variable] if variable in means else _values(timeline, base, prediction, variable)
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


def _fitted(
    timeline: Timeline,
    base: PlantModel,
    plain: Refit,
    original: Everett,
    shape: LearnedShape,
    before: LeftOutBlocks,
) -> LearnedTermFit | None:
    """A law with its values fitted, or None if it does not pass."""
    start = law_start(base, shape)
    kind = start.kind
    extended = replace(base, effects=(*base.effects, start))
    found = fit_explanation(timeline, extended, original, plain, ROUNDS)
    free = len(kind.parameters)
    gain = float(found.evidence - plain.log_evidence - 0.5 * free * np.log(plain.coupled))
    after = left_out_blocks(timeline, found.refitted, _traces(timeline, found))
    difference = after.log_density - before.log_density
    left_out = float(difference.sum())
    if gain < MIN_GAIN_NATS or left_out < MIN_LEFT_OUT_NATS or _share_lost(difference) > CHANCE:
        return None
    n = len(timeline.settled)
    errors = [np.linalg.norm((blocks.error / before.sd)[:n]) for blocks in (before, after)]
    removed = 1 - float(errors[1] / errors[0])
    return LearnedTermFit(found, gain, left_out, removed)


def _traces(timeline: Timeline, found: Explanation) -> Array:
    """The change (N, k) of all readings by each value of the law."""
    plant_model, effect = found.plant_model, found.effects[0]
    zero, columns = predict(timeline, plant_model).stacked(timeline), []
    for p in effect.kind.parameters:
        step = DIFFERENCE_SHARE * p.typical
        changed = effect.kind(
            **effect.values | {p.name: np.clip(effect.values[p.name] + step, p.lower, p.upper)}
        )
        effects = (*(e for e in plant_model.effects if e is not effect), changed)
        columns.append(predict(timeline, replace(plant_model, effects=effects)).stacked(timeline) - zero)
    traces = np.column_stack(columns)
    return traces[:, np.any(traces != 0.0, axis=0)]


def _share_lost(difference: Array) -> float:
    """The share of resampled sets of blocks on which the law does not gain."""
    rng = np.random.default_rng(0xB10C)
    drawn = rng.integers(0, difference.size, (DRAWS, difference.size))
    return float(np.mean(difference[drawn].sum(axis=1) <= 0))

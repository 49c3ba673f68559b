"""How well a model of a wire predicts each block of a timeline from all others: positions, resistances, channels.

log p(y_b | y_−b) = Σ over the coupled readings and each independent channel,    in the readings' own units
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.diagnosis.comparison.block_predictions import inverse, left_out
from smarig.diagnosis.comparison.commanded.channel_model import ChannelModel
from smarig.diagnosis.comparison.compared_hypothesis import Trial
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Prediction, Timeline

Rows = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Problem:
    """Scaled readings ``y`` (n,) with ``precision`` (n, n), of the ``kinds`` that they hold; ``scale`` (n,)."""

    kinds: tuple[str, ...]
    y: Array
    scale: Array
    precision: Array
    block: Rows
    span: float

    @cached_property
    def root(self) -> Array:
        """R (n, n) with RᵀR the precision."""
        values, vectors = np.linalg.eigh(self.precision)
        return np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T

    def trace(self, readings: Mapping[str, Array]) -> Array:
        """Scaled changes (n,) or (n, m) of these readings."""
        whole = np.concatenate([readings[k] for k in self.kinds])
        return (whole.T / self.scale).T

    def scores(self, y: Array, count: int) -> tuple[Array, Array]:
        """(left-out errors (n,) in the readings' units, log scores (count,) of the blocks)."""
        present = np.unique(self.block)
        rows = [np.flatnonzero(self.block == b) for b in present.tolist()]
        error, found = left_out(self.precision, self.precision @ y, rows)
        whole = np.zeros(count)
        whole[present] = found - [float(np.log(self.scale[r]).sum()) for r in rows]
        return error * self.scale, whole


def coupled_problem(timeline: Timeline, y: Array, scale: Array, covariance: Array, span: float) -> Problem:
    """The positions and resistances with their covariance (n, n); all scaled."""
    coupled = [r for r in timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]
    block = np.concatenate([timeline.block[r.step] for r in coupled])
    return Problem(tuple(r.kind for r in coupled), y, scale, inverse(covariance)[0], block, span)


def channel_problems(
    timeline: Timeline, prediction: Prediction, models: Sequence[ChannelModel]
) -> tuple[Problem, ...]:
    """The independent channels with the residuals of a prediction."""
    readings = {r.kind: r for r in timeline.other_readings}
    found = []
    for m in models:
        y = readings[m.kind].value - prediction.values[m.kind]
        found.append(Problem((m.kind,), y, np.ones(y.size), m.precision(y), m.block, m.span))
    return tuple(found)


def trial_of(
    timeline: Timeline,
    problems: Sequence[Problem],
    parameters: Mapping[str, float],
    shifts: Sequence[Array] = (),
) -> Trial:
    """The scores of all blocks; ``shifts`` are taken from the readings of each problem.

    The state of the trial is, by kind, the mean square of left-out errors in shares of the span.
    """
    count = int(timeline.block.max()) + 1
    total, squares = np.zeros(count), {}
    settled = np.empty(0)
    for k, p in enumerate(problems):
        error, scores = p.scores(p.y - shifts[k] if len(shifts) else p.y, count)
        total += scores
        at = 0
        for kind in p.kinds:
            size = next(len(r) for r in timeline.all_readings if r.kind == kind)
            own = error[at : at + size]
            span = p.span if kind != "resistance" else _span_of(timeline, kind)
            squares[kind] = float(np.mean((own / span) ** 2))
            if kind == "settled":
                settled = own
            at += size
    per_block = np.bincount(timeline.block, settled**2, count).astype(float)
    return Trial(parameters, total, per_block, squares)


def _span_of(timeline: Timeline, kind: str) -> float:
    return float(np.ptp(next(r.value for r in timeline.all_readings if r.kind == kind)))

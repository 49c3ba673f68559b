"""Whether and where a model misses records: against the noise of a reading, and by parts of its square error."""

import numpy as np
from numpy.typing import NDArray

from smarig.identification import MeasuredHypothesis, local_slope
from smarig.measurement import input_noise_sd

Array = NDArray[np.float64]
PARTS = ("between_runs", "slow", "branch", "level", "fast")
SLOW_WAVES, LEVEL_WAVES = 6, 4
ADEQUATE, ADEQUATE_SHARE = 3.0, 0.015


def reading_noise(base: MeasuredHypothesis) -> float:
    """Standard deviation of one reading: that of the output, and that of the input times the local slope."""
    plan, slope = base.fit.problem.plan, local_slope(base.fit)
    of_input = plan.of([np.full(len(r), input_noise_sd(r.u)) for r in plan.records])
    of_output = plan.of([np.full(len(r), input_noise_sd(r.y)) for r in plan.records])
    weight = base.fit.problem.weight
    return float(np.sqrt(np.mean(weight**2 * ((slope * of_input) ** 2 + of_output**2))))


def adequate_error(base: MeasuredHypothesis) -> float:
    """The error on held-out blocks up to which a model is adequate: ``ADEQUATE`` times the noise of a reading, or
    ``ADEQUATE_SHARE`` of the output's range.
    """
    known = np.isfinite(base.errors)
    output_range = float(np.ptp(base.fit.problem.plan.y[known]))
    return max(ADEQUATE * reading_noise(base), ADEQUATE_SHARE * output_range)


def error_parts(found: MeasuredHypothesis) -> dict[str, float]:
    """Shares of the weighted square error on held-out blocks, by part; they add up to 1.

    Each part explains what the parts before it left: means of runs, slow waves over the readings, means of blocks,
    waves over the measured output. The rest is fast.
    """
    known = np.isfinite(found.errors)
    plan, left = found.fit.problem.plan, found.weighted[known]
    total, shares = float(left @ left), []
    for columns in (
        _means(plan.record[known]),
        _waves(np.arange(left.size, dtype=float), SLOW_WAVES),
        _means(plan.block[known]),
        _waves(plan.y[known], LEVEL_WAVES),
    ):
        after = left - columns @ np.linalg.lstsq(columns, left, rcond=None)[0]
        shares.append(float(left @ left - after @ after))
        left = after
    values = [*shares, float(left @ left)]
    return {name: value / total if total else 0.0 for name, value in zip(PARTS, values)}


def _means(group: NDArray[np.int64]) -> Array:
    """One column for each group of readings (m,)."""
    return (group[:, None] == np.unique(group)[None, :]).astype(float)


def _waves(z: Array, count: int) -> Array:
    """Cosines (m, count) over the ranks of z."""
    rank = (np.argsort(np.argsort(z, kind="stable"), kind="stable") + 0.5) / z.size
    return np.cos(np.pi * rank[:, None] * np.arange(1, count + 1))

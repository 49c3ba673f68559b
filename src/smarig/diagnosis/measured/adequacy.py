"""Whether and where a model misses records: against the noise of a reading, and by parts of its square error."""

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.error_parts import error_parts
from smarig.identification import MeasuredHypothesis, local_slope
from smarig.measurement import input_noise_sd

Array = NDArray[np.float64]
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


def held_out_parts(base: MeasuredHypothesis) -> dict[str, float]:
    """The parts of the weighted errors on held-out blocks (``error_parts``)."""
    plan, known = base.fit.problem.plan, np.isfinite(base.errors)
    return error_parts(base.weighted[known], plan.record[known], plan.block[known], plan.y[known])

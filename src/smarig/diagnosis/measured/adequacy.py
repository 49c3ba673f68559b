"""Whether and where a model misses records: against the noise of a reading, and by parts of its square error."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

from smarig.diagnosis.error_parts import error_parts
from smarig.identification import MeasuredHypothesis, local_slope

Array = NDArray[np.float64]
ADEQUATE, ADEQUATE_SHARE = 3.0, 0.015
LARGEST_SHARE = 0.05  # of the output's range: a model that misses by more is adequate at no noise
ORDERS = (2, 3, 4)  # of differences that cancel the smooth part of a record


def reading_noise(base: MeasuredHypothesis) -> float:
    """Standard deviation of one reading: that of the output, and that of the input times the local slope.

    At most the error of the fit to the same readings: a coarse record's curvature looks like noise.
    """
    plan, slope = base.fit.problem.plan, local_slope(base.fit)
    of_input = plan.of([np.full(len(r), noise_by_differences(r.u)) for r in plan.records])
    of_output = plan.of([np.full(len(r), noise_by_differences(r.y)) for r in plan.records])
    weight = base.fit.problem.weight
    noise = float(np.sqrt(np.mean(weight**2 * ((slope * of_input) ** 2 + of_output**2))))
    return min(noise, base.fitted_rms)


def noise_by_differences(x: Array) -> float:
    """Standard deviation of white noise on a smooth record, the least by differences of several orders.

    Rows of one branch are close to a polynomial; jumps between branches are few. The noisiest tenth counts, because
    noise is intermittent.

    >>> bool(noise_by_differences(np.sin(np.linspace(0, 60, 300))) < 0.002)
    True
    """
    found = [1e-9 * float(np.ptp(x))]
    for order in ORDERS:
        difference = np.abs(np.diff(x, order))
        if difference.size:
            gain = float(np.sqrt(comb(2 * order, order, exact=True)))
            found.append(float(np.quantile(difference, 0.9)) / 1.645 / gain)
    return max(found[0], min(found[1:], default=0.0))


def is_adequate(base: MeasuredHypothesis) -> bool:
    """Whether the plain model's error on left-out blocks is adequate.

    Where the blocks are segments of branches, it contains interpolation, so its geometric mean with the error of the
    fit counts.
    """
    error = base.misfit if base.fit.problem.plan.segmented else base.rms
    return error <= adequate_error(base)


def adequate_error(base: MeasuredHypothesis) -> float:
    """The error on held-out blocks up to which a model is adequate: ``ADEQUATE`` times the noise of a reading, or
    ``ADEQUATE_SHARE`` of the output's range; never more than ``LARGEST_SHARE`` of that range.
    """
    known = np.isfinite(base.errors)
    output_range = float(np.ptp(base.fit.problem.plan.y[known]))
    most = LARGEST_SHARE * output_range
    return min(max(ADEQUATE * reading_noise(base), ADEQUATE_SHARE * output_range), most)


def held_out_parts(base: MeasuredHypothesis) -> dict[str, float]:
    """The parts of the weighted errors on held-out blocks (``error_parts``)."""
    plan, known = base.fit.problem.plan, np.isfinite(base.errors)
    return error_parts(base.weighted[known], plan.record[known], plan.block[known], plan.y[known])

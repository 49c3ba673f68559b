"""Weights of readings under a measured input: the noise of the input counts where the output is steep."""

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.identification.measured.measured_fit import MeasuredFit
from smarig.measurement import input_noise_sd, monotone_branches, reversals

MIN_SD_SHARE = 0.006  # of the output's range: no reading counts as more certain


def reading_weights(fit: MeasuredFit) -> Array:
    """Roots of weights (m,), root mean square 1: 1/σ with σ² = (slope · scatter of the input)² + σ_y² + (0.6 % of the
    output's range)².

    The scatter is that of the recorded input about its monotone branches, so readings on a steep branch count less.
    """
    plan, slope = fit.problem.plan, local_slope(fit)
    if any(r.readings is not None for r in plan.records):  # settled: all are alike
        return np.ones(len(plan))
    inputs = [(r.u, monotone_branches(r.u, reversals(r.u))) for r in plan.records]
    scatter = plan.of([np.full(u.size, root_mean_square(u - m)) for u, m in inputs])
    of_output = plan.of([np.full(len(r), input_noise_sd(r.y)) for r in plan.records])
    sigma = np.sqrt((slope * scatter) ** 2 + of_output**2 + (MIN_SD_SHARE * fit.problem.scale) ** 2)
    return (1 / sigma) / float(np.sqrt(np.mean(1 / sigma**2)))


def local_slope(fit: MeasuredFit) -> Array:
    """∂y/∂u at each reading (m,), in output per input unit, from its neighbours in the same record."""
    plan = fit.problem.plan
    u = plan.of([r.u for r in plan.records])
    slope = np.zeros(u.size)
    for k in range(len(plan.records)):
        own = np.flatnonzero(plan.record == k)
        if own.size > 2:
            du, dy = np.gradient(u[own]), np.gradient(fit.predicted[own])
            least = 1e-3 * float(np.ptp(u[own]) or 1.0)
            slope[own] = dy * du / (du**2 + least**2)
    return slope

"""Errors of a fit to measured inputs at blocks that were left out of it in turn, and the smoothing that they choose."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.measured.measured_fit import SMOOTHINGS, MeasuredProblem, predicted_outputs

Mask = NDArray[np.bool_]
EQUAL_ERROR = 1.001  # times the least error: less smoothing that gains less is not worth it


def chosen_smoothing(
    problem: MeasuredProblem, mask: Mask | None = None, *, gains: Array | None = None
) -> float:
    """The largest λ of ``SMOOTHINGS`` with about the least error on held-out blocks."""
    errors = {s: held_out_rms(problem, s, mask, gains=gains) for s in SMOOTHINGS}
    return max(s for s, error in errors.items() if error <= EQUAL_ERROR * min(errors.values()))


def held_out_rms(
    problem: MeasuredProblem, smoothing: float, mask: Mask | None = None, *, gains: Array | None = None
) -> float:
    """Weighted rms error (output units) at readings of blocks that were left out of the fit in turn."""
    error = problem.weight * held_out_errors(problem, smoothing, mask, gains=gains)
    return float(np.sqrt(np.nanmean(error**2)))


def held_out_errors(
    problem: MeasuredProblem, smoothing: float, mask: Mask | None = None, *, gains: Array | None = None
) -> Array:
    """Errors (m,) at readings of blocks that were left out of the fit in turn; NaN outside the mask.

    A zero shared by no fitted reading is not known, so errors of such a reading are about their mean.
    """
    within = np.ones(len(problem.plan), dtype=bool) if mask is None else mask
    error = np.full(len(problem.plan), np.nan)
    programme = problem.programme(np.ones(len(problem.plan.records)) if gains is None else gains)
    for fold in problem.plan.folds(within):
        fitted = within & ~fold
        if not fitted.any():
            continue
        x = programme.solved_without(smoothing, within, fold)
        e = problem.plan.y - predicted_outputs(problem, programme, x)
        for zero in np.unique(problem.observations.zero[fold]):
            own = fold & (problem.observations.zero == zero)
            if not np.any(fitted & (problem.observations.zero == zero)):
                e[own] -= e[own].mean()
        error[fold] = e[fold]
    return error

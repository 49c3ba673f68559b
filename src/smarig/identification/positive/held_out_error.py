"""Held-out curves of a fit: its error, the cost of non-negativity, and the width of its intervals.

The posterior of a Gaussian model includes noise and gaps between curves, but not the error of the model. So its
spread is scaled until 90 % of the held-out points lie in their 90 % intervals.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from smarig.identification.positive.quadratic_programme import MeasureProblem, quadratic_forms
from smarig.identification.positive.smoothing_choice import COMPARISON_ACCURACY

LEVEL = 0.9
_MOST = 400  # points per fold whose spread is computed


@dataclass(frozen=True)
class HeldOut:
    """Rms error of held-out points with masses ≥ 0 and with masses of any sign; ``spread_factor`` scales the
    spread.
    """

    rms: float
    signed_rms: float
    spread_factor: float
    curves: int


def held_out_test(
    problem: MeasureProblem,
    masks: list[NDArray[np.bool_]],
    curve: NDArray[np.int64],
    smoothing: float,
    sigma: float,
) -> HeldOut:
    """Refit without each fold and predict it, in scaled outputs; NaN and a factor of 1 without folds."""
    squares, solve_unconstrained, ratios = [], [], []
    for mask in masks:
        train, rows, y = ~mask, problem.rows[mask], problem.y[mask]
        solution = problem.solved(smoothing, train, accuracy=COMPARISON_ACCURACY)
        error = rows @ solution.x - y
        squares.append(error**2)
        solve_unconstrained.append((rows @ problem.solve_unconstrained(smoothing, train) - y) ** 2)
        some = slice(None, None, -(-y.size // _MOST))
        spread = quadratic_forms(solution.inverse, rows[some], solution.x.size) / np.sum(train)
        ratios.append(np.abs(error[some]) / (sigma * np.sqrt(1 + spread)))
    if not masks:
        return HeldOut(float("nan"), float("nan"), 1.0, 0)
    spread_factor = float(np.quantile(np.concatenate(ratios), LEVEL) / ndtri(0.5 + LEVEL / 2))
    rms, signed_rms = (
        float(np.sqrt(np.mean(np.concatenate(parts)))) for parts in (squares, solve_unconstrained)
    )
    return HeldOut(rms, signed_rms, spread_factor, np.unique(curve[np.any(masks, axis=0)]).size)

"""What held-out curves say of a fit: its error, what non-negativity costs, how wide its intervals must be.

The posterior of a Gaussian model knows noise and gaps between curves, not that a model is wrong. So its
spread is stretched until 90 % of the held-out points lie in their 90 % intervals. Knows no runs.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from smarig.identification.positive.problem import Problem, quadratic
from smarig.identification.positive.smoothing import ROUGH

LEVEL = 0.9
_MOST = 400  # points of a fold whose spread is worked out


@dataclass(frozen=True)
class HeldOut:
    """rms error of held-out points with masses ≥ 0 and with masses of any sign; ``stretch`` of the spread."""

    rms: float
    signed_rms: float
    stretch: float
    curves: int


def judged(
    problem: Problem,
    masks: list[NDArray[np.bool_]],
    curve: NDArray[np.int64],
    smoothing: float,
    sigma: float,
) -> HeldOut:
    """Refit without each fold and look at it, scaled outputs; NaN and a stretch of 1 without folds."""
    squares, signed, ratios = [], [], []
    for mask in masks:
        train, rows, y = ~mask, problem.rows[mask], problem.y[mask]
        solution = problem.solved(smoothing, train, accuracy=ROUGH)
        error = rows @ solution.x - y
        squares.append(error**2)
        signed.append((rows @ problem.signed(smoothing, train) - y) ** 2)
        some = slice(None, None, -(-y.size // _MOST))
        spread = quadratic(solution.inverse, rows[some], solution.x.size) / np.sum(train)
        ratios.append(np.abs(error[some]) / (sigma * np.sqrt(1 + spread)))
    if not masks:
        return HeldOut(float("nan"), float("nan"), 1.0, 0)
    stretch = float(np.quantile(np.concatenate(ratios), LEVEL) / ndtri(0.5 + LEVEL / 2))
    rms, signed_rms = (float(np.sqrt(np.mean(np.concatenate(parts)))) for parts in (squares, signed))
    return HeldOut(rms, signed_rms, stretch, int(np.unique(curve[np.any(masks, axis=0)]).size))

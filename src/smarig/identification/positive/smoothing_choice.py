"""The choice of the smoothing: the λ with the best prediction of whole held-out curves.

Curves are distributed to folds in order. The first and the last stay in every training set, and one that goes farther
than all others, because nothing could interpolate to them. Each curve counts by the logarithm of its mean square error,
so that one difficult curve does not dominate. The search for λ descends in decades and ends at the vertex of a
parabola. It uses a coarser triangle than the fit; the roughness is an integral, so λ means the same on both.

One or two loops leave no whole curve to hold out. Then segments of them are held out. These lie close to the
training points, so they favour too little smoothing for the gap between loops. Therefore the smoothest λ within one
standard error of the least error is taken (Breiman et al. 1984, §3.4.3).

Held-out curves of a fit: its error, the cost of non-negativity, and the width of its intervals.

The posterior of a Gaussian model includes noise and gaps between curves, but not the error of the model. So its
spread is scaled until 90 % of the held-out points lie in their 90 % intervals.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from smarig.core import Array
from smarig.identification.positive.quadratic_programme import MeasureProblem, quadratic_forms

Mask = NDArray[np.bool_]
FOLDS = 5
FIRST_LOG10, LEAST_LOG10, MOST_LOG10 = -12.0, -17.0, -5.0  # log₁₀ λ
LOG10_RESOLUTION = 0.1  # resolution of log₁₀ λ at the limit of one standard error
COMPARISON_ACCURACY = 1e-4  # sufficient accuracy of a comparison


def curve_folds(curve: NDArray[np.int64], farthest: int | None = None, fold_count: int = FOLDS) -> list[Mask]:
    """Masks of held-out points: whole curves, distributed in turn; none if there are fewer than three curves.

    ``farthest``: a curve that is never held out, as no other goes so far.
    """
    inner = np.setdiff1d(np.unique(curve)[1:-1], [] if farthest is None else [farthest])
    return [np.isin(curve, inner[k::fold_count]) for k in range(min(fold_count, inner.size))]


def smoothing_by_held_out(
    problem: MeasureProblem, masks: list[Mask], curve: NDArray[np.int64]
) -> tuple[float, dict[float, float]]:
    """(λ, typical held-out error of a curve by λ, scaled); typical is the geometric mean over the curves."""
    errors_by_exponent: dict[float, float] = {}

    def error(exponent: float) -> float:
        if exponent not in errors_by_exponent:
            errors_by_exponent[exponent] = _held_out_error(problem, masks, curve, 10.0**exponent)
        return errors_by_exponent[exponent]

    best = FIRST_LOG10
    while True:
        step = min((e for e in (best - 1, best + 1) if LEAST_LOG10 <= e <= MOST_LOG10), key=error)
        if error(step) >= error(best):
            break
        best = step
    vertex = _vertex(best, errors_by_exponent)
    best = vertex if error(vertex) < error(best) else best
    return 10.0**best, {10.0**e: value for e, value in sorted(errors_by_exponent.items())}


def segment_folds(curve: NDArray[np.int64], fold_count: int = FOLDS) -> list[Mask]:
    """Masks of held-out points: every curve cut into 2 · ``fold_count`` segments, distributed in turn.

    A loop given by its rising and its falling branch, each from its own tip, loses a segment together with its
    mirror image, from which the segment could otherwise be predicted.
    """
    dealt = np.empty(curve.size, dtype=np.int64)
    for number in np.unique(curve):
        at = np.flatnonzero(curve == number)
        dealt[at] = np.arange(at.size) * 2 * fold_count // at.size % fold_count
    return [dealt == k for k in np.unique(dealt)]


def largest_smoothing_within_one_error(
    problem: MeasureProblem, masks: list[Mask], curve: NDArray[np.int64]
) -> tuple[float, dict[float, float]]:
    """``smoothing_by_held_out``, but with the largest λ whose error is within one standard error of the least."""
    best, errors_by_exponent = smoothing_by_held_out(problem, masks, curve)
    logs = [float(np.mean(np.log(part))) / 2 for part in _squares(problem, masks, curve, best)]
    limit = np.mean(logs) + np.std(logs, ddof=1) / np.sqrt(len(logs))
    low, high = np.log10(best), MOST_LOG10
    while high - low > LOG10_RESOLUTION:
        middle = (low + high) / 2 if high < MOST_LOG10 else low + 1
        if middle >= MOST_LOG10:
            break
        errors_by_exponent[10.0**middle] = _held_out_error(problem, masks, curve, 10.0**middle)
        low, high = (middle, high) if np.log(errors_by_exponent[10.0**middle]) <= limit else (low, middle)
    return float(10.0**low), dict(sorted(errors_by_exponent.items()))


def _held_out_error(
    problem: MeasureProblem, masks: list[Mask], curve: NDArray[np.int64], smoothing: float
) -> float:
    squares = np.concatenate(_squares(problem, masks, curve, smoothing))
    return float(np.exp(0.5 * np.mean(np.log(squares))))


def _squares(
    problem: MeasureProblem, masks: list[Mask], curve: NDArray[np.int64], smoothing: float
) -> list[Array]:
    """Mean square error of each held-out curve, for each fold."""
    squares = []
    for mask in masks:
        x = problem.solved(smoothing, ~mask, accuracy=COMPARISON_ACCURACY).x
        error = problem.rows[mask] @ x - problem.y[mask]
        place = np.unique(curve[mask], return_inverse=True)[1]
        squares.append(np.maximum(np.bincount(place, error**2) / np.bincount(place), 1e-32))
    return squares


def _vertex(best: float, errors_by_exponent: dict[float, float]) -> float:
    """The minimum of a parabola through the log error at ``best`` and its neighbours."""
    if best - 1 not in errors_by_exponent or best + 1 not in errors_by_exponent:
        return best
    low, middle, high = (np.log(errors_by_exponent[e]) for e in (best - 1, best, best + 1))
    bend = low - 2 * middle + high
    return best if bend <= 0 else best + float(np.clip(0.5 * (low - high) / bend, -0.5, 0.5))


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

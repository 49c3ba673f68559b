"""Where along held-out data a model fails, and how much of them it cannot predict.

A pooled error counts readings: a branch that was passed quickly hardly counts, however wrong it is. So each wide branch
is judged by itself, in intervals of equal width of the input.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.identification import RunVerification
from smarig.study.input_turns import wide_turns

_INTERVALS = 12  # of a branch
_FEWEST = 8  # counted readings of a branch
_BELONGS = 0.5  # of the largest error: neighbouring intervals with more belong to the same place


@dataclass(frozen=True)
class BranchError:
    """The error of a model on one branch, over ``rows`` of the points of ``run``.

    ``rms`` is the mean over intervals of the input; ``direction`` is +1 for a rising input. The error is largest from
    the input ``start`` to ``end``: ``worst`` rms, over ``worst_rows``.
    """

    run: str
    direction: int
    rms: float
    rows: slice
    start: float
    end: float
    worst: float
    worst_rows: slice


def branch_errors(runs: Sequence[RunVerification]) -> list[BranchError]:
    """The errors of all wide branches on which a model can be judged, the largest first."""
    return sorted((b for run in runs for b in _of_run(run)), key=lambda b: -b.rms)


def worst_place(branches: Sequence[BranchError]) -> BranchError | None:
    """The branch with the place of the largest error, None without a branch."""
    return max(branches, key=lambda b: b.worst, default=None)


def unpredicted_share(runs: Sequence[RunVerification]) -> float:
    """The share of the points of runs for which the model has no prediction, as the memory is not known there."""
    points = sum(r.predicted.size for r in runs)
    return sum(int(np.sum(~np.isfinite(r.predicted))) for r in runs) / points if points else 0.0


def _of_run(run: RunVerification) -> Iterator[BranchError]:
    u, error = run.input, np.where(run.counted, run.predicted - run.measured, np.nan)
    if u.size < _FEWEST or not np.isfinite(u).all():
        return
    for a, b in pairwise(wide_turns(u).tolist()):
        found = _of_branch(run.run, u[a : b + 1], error[a : b + 1], a)
        if found is not None:
            yield found


def _of_branch(run: str, u: Array, error: Array, first: int) -> BranchError | None:
    known = np.isfinite(error)
    if known.sum() < _FEWEST or np.ptp(u[known]) == 0:
        return None
    low, high = float(u[known].min()), float(u[known].max())
    place = np.clip(((u - low) / (high - low) * _INTERVALS).astype(int), 0, _INTERVALS - 1)
    counts = np.bincount(place[known], minlength=_INTERVALS)
    squares = np.bincount(place[known], error[known] ** 2, minlength=_INTERVALS) / np.maximum(counts, 1)
    filled = counts > 0
    least, most = _around_worst(np.where(filled, squares, np.nan))
    rows = np.flatnonzero(known & (place >= least) & (place <= most))
    rising = 1 if u[-1] > u[0] else -1
    ends = low + (high - low) * np.array([least, most + 1]) / _INTERVALS
    return BranchError(
        run=run,
        direction=rising,
        rms=float(np.sqrt(squares[filled].mean())),
        rows=slice(first, first + u.size),
        start=float(ends[0] if rising > 0 else ends[1]),
        end=float(ends[1] if rising > 0 else ends[0]),
        worst=root_mean_square(error[rows]),
        worst_rows=slice(first + int(rows[0]), first + int(rows[-1]) + 1),
    )


def _around_worst(squares: Array) -> tuple[int, int]:
    """The first and last interval of the place of the largest error; intervals without readings (NaN) are passed."""
    rms = np.sqrt(squares)
    worst = int(np.nanargmax(rms))
    belongs = np.isnan(rms) | (rms >= _BELONGS * rms[worst])
    low = high = worst
    while low > 0 and belongs[low - 1]:
        low -= 1
    while high + 1 < rms.size and belongs[high + 1]:
        high += 1
    while np.isnan(rms[low]):
        low += 1
    while np.isnan(rms[high]):
        high -= 1
    return low, high

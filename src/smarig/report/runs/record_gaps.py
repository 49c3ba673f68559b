"""Gaps in the record of a run, where samples are missing: no line is drawn across them."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.record import Run

_WITHOUT_GAP = 1.5  # ticks between two samples: one, however it is rounded


def uninterrupted_parts(run: Run) -> NDArray[np.intp]:
    """The number (n,) of the uninterrupted part that each sample belongs to. A run without a tick has one part."""
    part = np.zeros(len(run), dtype=int)
    if run.info.period_s and len(run):
        part[1:] = np.cumsum(np.diff(run["t_s"]) > _WITHOUT_GAP * run.info.period_s)
    return part


def ends_of_parts(part: NDArray[np.intp]) -> NDArray[np.intp]:
    """The rows at both sides of every gap.

    >>> ends_of_parts(np.array([0, 0, 0, 1, 1])).tolist()
    [2, 3]
    """
    last = np.flatnonzero(np.diff(part))
    return np.union1d(last, last + 1)


def broken_at_gaps(rows: NDArray[np.intp], part: NDArray[np.intp]) -> NDArray[np.intp]:
    """Increasing rows with −1 where a gap lies between two of them.

    >>> broken_at_gaps(np.array([0, 2, 3, 4]), np.array([0, 0, 0, 1, 1])).tolist()
    [0, 2, -1, 3, 4]
    """
    return np.insert(rows, np.flatnonzero(np.diff(part[rows])) + 1, -1)


def drawn(values: Array, rows: NDArray[np.intp]) -> Array:
    """The values at these rows, NaN where the row is −1."""
    return np.where(rows >= 0, values[rows], np.nan)

"""Rows in which an output repeats one value while its input moves on: a sensor or its logger stood still.

A wire rests too, so a value counts only where readings elsewhere at the same inputs differ from row to row, and for
rows that are far more than repeat any other value in turn. Which value the sensor kept says nothing: they are masked.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.record import ImportFinding

_FEWEST = 5  # rows
_TIMES = 5  # as many rows as any other value in turn
_MOVED = 0.05  # of the input's range


def without_frozen(
    unit: str, u: Array, y: Array, line: NDArray[np.int64]
) -> tuple[Array, list[ImportFinding]]:
    """The output (n,) with NaN where it stood still while the input ``u`` moved, and a finding on each such place."""
    found = []
    for first, last in frozen(u, y):
        rows = slice(first, last + 1)
        count = int(np.isfinite(y[rows]).sum())
        text = (
            f"The output stands still at {y[first]:g}{spaced(unit)} in {count} rows (from line {line[first]} to "
            f"{line[last]}) while the input moves, as it does nowhere else: the sensor was stuck. They are masked."
        )
        found.append(ImportFinding(text, "frozen readings"))
        y = y.copy()
        y[rows] = np.nan
    return y, found


def frozen(u: Array, y: Array) -> list[tuple[int, int]]:
    """The first and last row of each place at which the output ``y`` (n,) was frozen."""
    known = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
    if known.size < 2 * _FEWEST:
        return []
    x, drive = y[known], u[known]
    edges = np.r_[0, np.flatnonzero(np.diff(x)) + 1, x.size]
    length = np.diff(edges)
    long = np.flatnonzero(length >= _FEWEST).tolist()
    able = [k for k in long if _is_frozen(drive, x, int(edges[k]), int(edges[k + 1]))]
    others = max((int(n) for k, n in enumerate(length) if k not in able), default=1)
    return [
        (int(known[edges[k]]), int(known[edges[k + 1] - 1])) for k in able if length[k] >= _TIMES * others
    ]


def _is_frozen(u: Array, y: Array, first: int, stop: int) -> bool:
    """Whether equal readings are no rest at an end of travel, the input moves in them, and most readings elsewhere at
    these inputs differ from the one before.
    """
    part = u[first:stop]
    if y[first] in (y.min(), y.max()) or np.ptp(part) < _MOVED * np.ptp(u):
        return False
    there = (u[1:] >= part.min()) & (u[1:] <= part.max())
    there[max(first - 1, 0) : stop] = False
    differ = np.diff(y)[there] != 0
    return differ.size >= _FEWEST and bool(2 * differ.sum() > differ.size)

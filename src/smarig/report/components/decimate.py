"""Thins traces for the screen without losing an extreme: each bucket keeps its minimum and maximum."""

import numpy as np
from numpy.typing import NDArray

POINTS = 1600  # a trace stays under 3000 points


def envelope(values: NDArray[np.float64], points: int = POINTS) -> NDArray[np.intp]:
    """Indices (≤ points, increasing) of the minimum and maximum of every bucket, and of both ends.

    NaN is kept only if a bucket contains nothing else, so that gaps remain gaps.

    >>> envelope(np.arange(10.0), 4).tolist()
    [0, 4, 5, 9]
    """
    n = values.size
    if n <= points:
        return np.arange(n)
    edges = np.linspace(0, n, points // 2 + 1).astype(int)
    known = np.isfinite(values)
    lowest = _first_minima(np.where(known, values, np.inf), edges)
    highest = _first_minima(np.where(known, -values, np.inf), edges)
    return np.union1d(lowest, highest)


def _first_minima(values: NDArray[np.float64], edges: NDArray[np.intp]) -> NDArray[np.intp]:
    """The index of the first minimum of every bucket between two edges."""
    least = np.minimum.reduceat(values, edges[:-1])
    equal = np.flatnonzero(values == np.repeat(least, np.diff(edges)))
    return equal[np.searchsorted(equal, edges[:-1])]


def path(u: NDArray[np.float64], y: NDArray[np.float64], points: int = POINTS) -> NDArray[np.intp]:
    """Indices that thin a curve (u, y): the envelopes of both coordinates, in order."""
    if u.size <= points:
        return np.arange(u.size)
    return np.union1d(envelope(u, points // 2), envelope(y, points // 2))

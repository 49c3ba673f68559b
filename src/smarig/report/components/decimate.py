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
    low = np.where(np.isfinite(values), values, np.inf)
    high = np.where(np.isfinite(values), values, -np.inf)
    kept_indices = [
        (a + int(np.argmin(low[a:b])), a + int(np.argmax(high[a:b]))) for a, b in zip(edges[:-1], edges[1:])
    ]
    return np.unique(np.array(kept_indices).ravel())


def path(u: NDArray[np.float64], y: NDArray[np.float64], points: int = POINTS) -> NDArray[np.intp]:
    """Indices that thin a curve (u, y): the envelopes of both coordinates, in order."""
    if u.size <= points:
        return np.arange(u.size)
    return np.union1d(envelope(u, points // 2), envelope(y, points // 2))

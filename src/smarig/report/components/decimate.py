"""Thins traces for the screen: by the extremes of buckets, or to a path with nearly the same shape."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

POINTS = 1600  # a trace stays under 3000 points
_CONSIDERED = 8  # times the points of a path: of more, only extremes are considered
_UNSEEN = 5e-4  # of the ranges: a third of a pixel


def envelope(values: Array, points: int = POINTS) -> NDArray[np.intp]:
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


def _first_minima(values: Array, edges: NDArray[np.intp]) -> NDArray[np.intp]:
    """The index of the first minimum of every bucket between two edges."""
    least = np.minimum.reduceat(values, edges[:-1])
    equal = np.flatnonzero(values == np.repeat(least, np.diff(edges)))
    return equal[np.searchsorted(equal, edges[:-1])]


def path(u: Array, y: Array, points: int = POINTS) -> NDArray[np.intp]:
    """Indices (≤ points, increasing) that thin a curve (u, y) to one that a drawing hardly tells from it.

    Very long curves are first thinned to the envelopes of both coordinates. Gaps (NaN) remain gaps.
    """
    if u.size <= points:
        return np.arange(u.size)
    most = _CONSIDERED * points
    kept = np.arange(u.size) if u.size <= most else np.union1d(envelope(u, most // 2), envelope(y, most // 2))
    return kept[simplified(u[kept], y[kept], _UNSEEN, points)]


def simplified(u: Array, y: Array, tolerance: float, most: int) -> NDArray[np.intp]:
    """Indices (≤ most, increasing) of a path through the points that stays within ``tolerance`` of all others.

    The tolerance is a share of the ranges; it is raised until at most ``most`` points remain (Douglas & Peucker 1973).
    Of a gap (NaN), one point remains.

    >>> simplified(np.array([0.0, 1.0, 2.0, 2.0]), np.array([0.0, 1.0, 2.0, 0.0]), 0.01, 9).tolist()
    [0, 2, 3]
    """
    known = np.isfinite(u) & np.isfinite(y)
    if not known.any():
        return np.arange(min(u.size, 1))
    points = np.column_stack([u / (np.ptp(u[known]) or 1.0), y / (np.ptp(y[known]) or 1.0)])
    edges = [0, *(np.flatnonzero(np.diff(known)) + 1).tolist(), u.size]
    parts = list(pairwise(edges))
    while True:
        kept = [a + (_within(points[a:b], tolerance) if known[a] else np.array([0])) for a, b in parts]
        if sum(k.size for k in kept) <= max(most, 2 * len(parts)):
            return np.concatenate(kept)
        tolerance *= 1.5


def _within(points: Array, tolerance: float) -> NDArray[np.intp]:
    """Indices of the path; all segments of one depth are divided at once, each at its farthest point."""
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    starts, ends = np.array([0]), np.array([len(points) - 1])
    while True:
        starts, ends = (side[ends - starts > 1] for side in (starts, ends))
        if not starts.size:
            return np.flatnonzero(kept)
        size = ends - starts - 1
        first = np.concatenate([[0], np.cumsum(size)[:-1]])
        inner = np.arange(int(size.sum())) - np.repeat(first - starts - 1, size)
        distance = _distances(
            points[inner], *(np.repeat(points[side], size, axis=0) for side in (starts, ends))
        )
        largest = np.maximum.reduceat(distance, first)
        at = np.flatnonzero(distance == np.repeat(largest, size))
        farthest = inner[at[np.searchsorted(at, first)]]
        far = largest > tolerance
        kept[farthest[far]] = True
        starts, ends = (
            np.concatenate([starts[far], farthest[far]]),
            np.concatenate([farthest[far], ends[far]]),
        )
        order = np.argsort(starts)
        starts, ends = starts[order], ends[order]


def _distances(points: Array, a: Array, b: Array) -> Array:
    """Distances (n,) of points (n, 2) from the segments between a and b (n, 2)."""
    along = b - a
    square = np.sum(along**2, axis=1)
    share = np.sum((points - a) * along, axis=1) / np.where(square > 0, square, 1.0)
    share = np.where(square > 0, np.clip(share, 0.0, 1.0), 0.0)
    return np.hypot(*(points - a - share[:, None] * along).T)

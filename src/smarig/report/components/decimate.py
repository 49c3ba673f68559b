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


def simplified(
    u: NDArray[np.float64], y: NDArray[np.float64], tolerance: float, most: int
) -> NDArray[np.intp]:
    """Indices (≤ most, increasing) of a path through the points that stays within ``tolerance`` of all others.

    The tolerance is a share of the ranges; it is raised until at most ``most`` points remain (Douglas & Peucker 1973).

    >>> simplified(np.array([0.0, 1.0, 2.0, 2.0]), np.array([0.0, 1.0, 2.0, 0.0]), 0.01, 9).tolist()
    [0, 2, 3]
    """
    points = np.column_stack([u / (np.ptp(u) or 1.0), y / (np.ptp(y) or 1.0)]) if u.size else np.empty((0, 2))
    kept = _within(points, tolerance)
    while kept.size > most:
        tolerance *= 1.5
        kept = _within(points, tolerance)
    return kept


def _within(points: NDArray[np.float64], tolerance: float) -> NDArray[np.intp]:
    if len(points) <= 2:
        return np.arange(len(points))
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    open_ = [(0, len(points) - 1)]
    while open_:
        first, last = open_.pop()
        if last - first < 2:
            continue
        distance = _distances(points[first + 1 : last], points[first], points[last])
        k = int(np.argmax(distance))
        if distance[k] > tolerance:
            kept[first + 1 + k] = True
            open_ += [(first, first + 1 + k), (first + 1 + k, last)]
    return np.flatnonzero(kept)


def _distances(
    points: NDArray[np.float64], a: NDArray[np.float64], b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances (n,) of points (n, 2) from the segment between a and b."""
    along = b - a
    length = float(along @ along)
    share = np.clip((points - a) @ along / length, 0.0, 1.0) if length else np.zeros(len(points))
    return np.linalg.norm(points - a - share[:, None] * along, axis=1)

"""The direction in which loops of an input and an output run: the output of a hysteresis never leads its input."""

from collections.abc import Sequence

import numpy as np

from smarig.core import Array

WIDE = 0.5  # of the input's range: the smallest branches that are compared
LEADS = -0.3  # of −1…1: agreement of the loops' width with their slope, below which the output leads
LEAST_STEPS = 3  # of a branch: one of fewer steps has no shape, and the chord of a curve leads it
LEAST_WIDTH = 0.01  # of the output's range


def width_of_leading_loops(u: Array, y: Array, turns: Sequence[int]) -> float | None:
    """Mean width, over the output's range, of the loops of a record (n,) in which the output leads; None if it lags.

    ``turns`` are the rows of reversals. A lagging output is falling(u) ≈ rising(u + δ), so the difference of the
    branches has the sign of the slope; it leads if most of the difference has the other sign.

    >>> u = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0])
    >>> width_of_leading_loops(u, np.array([0.0, 0.0, 1.0, 3.0, 3.0, 2.0, 0.0]), [0, 3, 6]) is None
    True
    >>> round(width_of_leading_loops(u, np.array([0.0, 2.0, 3.0, 3.0, 1.0, 0.0, 0.0]), [0, 3, 6]), 2)
    0.44
    >>> width_of_leading_loops(u[[0, 3, 4, 5, 6]], np.array([0.0, 3.0, 1.5, 0.2, 0.0]), [0, 1, 4]) is None
    True
    """
    wide = [
        (a, b, c)
        for a, b, c in zip(turns[:-2], turns[1:-1], turns[2:])
        if min(abs(u[b] - u[a]), abs(u[c] - u[b])) > WIDE * np.ptp(u) and min(b - a, c - b) >= LEAST_STEPS
    ]
    if not wide:
        return None
    agreement, width = np.mean([_of_loop(u, y, *turn) for turn in wide], axis=0).tolist()
    return width if agreement <= LEADS and width >= LEAST_WIDTH else None


def _of_loop(u: Array, y: Array, a: int, b: int, c: int) -> tuple[float, float]:
    """Agreement in −1…1 of (falling − rising output) with the local slope, and its mean size over the range."""
    first, second = slice(a, b + 1), slice(b, c + 1)
    rising, falling = (first, second) if u[b] > u[a] else (second, first)
    low, high = max(u[rising].min(), u[falling].min()), min(u[rising].max(), u[falling].max())
    grid = np.linspace(low, high, 101)
    up, down = (branch_outputs(u[part], y[part], grid) for part in (rising, falling))
    apart, slope = down - up, np.gradient(up + down)
    size = float(np.sum(np.abs(apart) * np.abs(slope)))
    agreement = float(np.sum(apart * slope)) / size if size else 0.0
    return agreement, float(np.mean(np.abs(apart)) / np.ptp(y))


def branch_outputs(u: Array, y: Array, grid: Array) -> Array:
    """Outputs of one branch (n,) at the inputs of a grid (k,)."""
    order = np.argsort(u, kind="stable")
    return np.interp(grid, u[order], y[order])

"""A second implementation of the tangent method, from textbook parts: a sliding derivative and scipy's linear fits.

It shares no code and no constant with smarig. The steep tangent is the steepest of all regressions over a third of the
output. A plateau is what lies beyond a foot of the curve, where the derivative has fallen to a twentieth of its peak.
"""

from collections import namedtuple

import numpy as np
from scipy.ndimage import uniform_filter1d

Line = namedtuple("Line", "slope intercept")
CHORD = 0.3  # of the output: length of the regressions
FOOT = 0.05  # of the peak of the derivative
GRID = 1201
WIDTH = 25  # points of the grid over which the derivative is averaged


def corners(temperature, output, middle=None):
    """(lower, upper) temperature at which the tangents meet, for one branch in measured order.

    ``middle``: shares of the output between which the steep tangent is a regression of the temperature on the output.
    """
    t, y = np.asarray(temperature, float), np.asarray(output, float)
    order = np.argsort(t, kind="stable")
    t, first = np.unique(t[order], return_index=True)
    y = y[order][first]
    steep, at = _between(t, y, middle) if middle else steepest(t, y)
    grid = np.linspace(t[0], t[-1], GRID)
    curve = np.interp(grid, t, y)
    slope = uniform_filter1d(np.gradient(curve, grid), WIDTH)
    calm = np.abs(slope) < FOOT * abs(steep.slope)
    return tuple(_meet(t, y, steep, _foot(grid, calm, at, side), side) for side in (-1, 1))


def steepest(t, y):
    """The steepest regression over a third of the output, and its middle."""
    from scipy.stats import linregress

    size, best, at = CHORD * np.ptp(y), None, 0.0
    for a in range(t.size - 1):
        far = np.flatnonzero(np.abs(y[a:] - y[a]) >= size)
        if not far.size:
            continue
        rows = slice(a, a + far[0] + 1)
        if t[rows].size >= 3:
            line = linregress(t[rows], y[rows])
            if best is None or abs(line.slope) > abs(best.slope):
                best, at = line, t[rows].mean()
    return best, at


def _between(t, y, middle):
    """The regression of the temperature on the output between two shares of the output, as a line y(t)."""
    from scipy.stats import linregress

    share = (y - y[0]) / (y[-1] - y[0])
    rows = (share >= middle[0]) & (share <= middle[1])
    line = linregress(y[rows], t[rows])
    return Line(1 / line.slope, -line.intercept / line.slope), float(t[rows].mean())


def _foot(grid, calm, at, side):
    """Where the derivative has become small for good, going outward from the steep part."""
    k = int(np.searchsorted(grid, at))
    while 0 < k < GRID - 1 and not calm[k]:
        k += side
    return grid[k]


def _meet(t, y, steep, foot, side):
    from scipy.stats import linregress

    rows = t <= foot if side < 0 else t >= foot
    if rows.sum() < 3:
        return np.nan
    plateau = linregress(t[rows], y[rows])
    return (plateau.intercept - steep.intercept) / (steep.slope - plateau.slope)


def mean_branch(branches, levels=400):
    """The mean (temperature, output) of noisy branches: the mean temperature at each share of the output.

    A regression on a noisy temperature is biased; a mean of temperatures is not.
    """
    share, found, ends = np.linspace(0, 1, levels), [], []
    for t, y in branches:
        cold_first = t[0] < t[-1]
        t, y = (t, y) if cold_first else (t[::-1], y[::-1])
        low, high = y[:4].mean(), y[-4:].mean()
        done = np.maximum.accumulate((y - low) / (high - low))
        done, first = np.unique(done, return_index=True)
        found.append(np.interp(share, done, t[first]))
        ends.append((low, high))
    low, high = np.mean(ends, axis=0)
    return np.mean(found, axis=0), low + share * (high - low)

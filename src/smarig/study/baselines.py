"""Simple curves that a model of hysteresis must beat: a line, a curve without hysteresis, and two branches."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.measurement import reversals

BRANCHES = "rising and falling branch"
_NODES = 40  # of a curve of means


@dataclass(frozen=True, eq=False)
class RunPoints:
    """RunPoints of one run, in order: input, output, the rising (+1) or falling (−1) direction, and which count."""

    u: Array
    y: Array
    direction: Array
    counted: NDArray[np.bool_]


@dataclass(frozen=True)
class Baseline:
    """A simple curve: its name, and its output (n,) at inputs (n,) and directions (n,)."""

    name: str
    predict: Callable[[Array, Array], Array]


def points_of(u: Array, y: Array, counted: NDArray[np.bool_]) -> RunPoints:
    """The points with the direction of the input, whose noise does not turn it.

    >>> points_of(np.array([0.0, 1, 2, 1, 0]), np.zeros(5), np.ones(5, bool)).direction.tolist()
    [1.0, 1.0, 1.0, -1.0, -1.0]
    """
    direction = np.ones(u.size)
    turns = reversals(u)
    for a, b in zip(turns[:-1], turns[1:]):
        direction[a + (a > 0) : b + 1] = 1.0 if u[b] > u[a] else -1.0
    return RunPoints(u, y, direction, counted)


def baselines(train: Sequence[RunPoints]) -> list[Baseline]:
    """The simple curves fitted to training points.

    A straight line; the mean output at each input (no hysteresis); and the mean of the rising and of the falling
    branches (the last major loop, if there is one), between which nothing is interpolated.
    """
    u, y, d = (np.concatenate([getattr(p, k)[p.counted] for p in train]) for k in ("u", "y", "direction"))
    slope, level = np.polyfit(u, y, 1) if np.ptp(u) > 0 else (0.0, float(np.mean(y)))
    found = [Baseline("straight line", lambda x, _: slope * x + level)]
    mean = _mean_curve(u, y)
    found.append(Baseline("mean curve, no hysteresis", lambda x, _: mean(x)))
    if min((d > 0).sum(), (d < 0).sum()) >= _NODES // 4:
        up, down = _mean_curve(u[d > 0], y[d > 0]), _mean_curve(u[d < 0], y[d < 0])
        found.append(Baseline(BRANCHES, lambda x, way: np.where(way > 0, up(x), down(x))))
    return found


def _mean_curve(u: Array, y: Array) -> Callable[[Array], Array]:
    """The mean output in intervals of the input with equal numbers of points, joined by lines."""
    nodes, means = curve_of_means(u, y, min(_NODES, max(u.size // 4, 1)))
    return lambda x: np.interp(x, nodes, means)


def curve_of_means(u: Array, y: Array, count: int) -> tuple[Array, Array]:
    """The means (k,) of inputs and outputs (n,) in k = ``count`` intervals of the input with equal numbers of points.

    >>> curve_of_means(np.array([0.0, 1, 2, 3]), np.array([0.0, 2, 5, 7]), 2)
    (array([0.5, 2.5]), array([1., 6.]))
    """
    order = np.argsort(u, kind="stable")
    parts = [part for part in np.array_split(order, count) if part.size]
    return np.array([u[part].mean() for part in parts]), np.array([y[part].mean() for part in parts])


def baseline_rms(baseline: Baseline, held_out: Sequence[RunPoints], free_zero: Sequence[bool]) -> float:
    """The rms error on points that count; about its mean for runs whose zero is free, as it is for the model."""
    errors = []
    for points, free in zip(held_out, free_zero):
        error = (baseline.predict(points.u, points.direction) - points.y)[points.counted]
        errors.append(error - error.mean() if free else error)
    return root_mean_square(np.concatenate(errors))

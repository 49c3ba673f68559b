"""Windows of a local regression: the weight of a measured point by its distance from the place of the fit, in grid
steps.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from smarig.core import Array

WindowWeights = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True)
class RegressionWindow:
    """A family of weights w(Δα, Δβ; s), with the smoothing factor s in grid steps.

    ``weights(targets, points, s)`` takes places in grid steps, (t, 2) and (u, 2), and factors (t,), and returns (t,
    u). It is zero if the distance of a coordinate in ``frame`` (2, 2) exceeds s. ``one_step`` windows mix the axes
    and need the same step for both.
    """

    weights: WindowWeights
    frame: Array
    one_step: bool


def _tricube(targets: Array, points: Array, s: Array) -> Array:
    """(1 − d³)³ within the ellipse d² = (Δα² + Δβ²)/s² ≤ 1 (Cleveland 1979; Harrison & Feinberg 2008)."""
    scaled = targets / s[:, None]
    # d² = |t|²/s² + |p|²/s² − 2 t·p/s²: one matrix product instead of differences of every pair.
    left = np.column_stack([np.sum(scaled**2, axis=1), 1 / s**2, -2 * scaled / s[:, None]])
    right = np.stack([np.ones(len(points)), np.sum(points**2, axis=1), points[:, 0], points[:, 1]])
    square = left @ right
    np.clip(square, 0.0, 1.0, out=square)
    cube = np.sqrt(square)
    cube *= square
    rest = np.subtract(1.0, cube, out=cube)
    np.multiply(rest, rest, out=square)
    square *= rest
    return square


_EGLI = np.array([[0.5, 0.5], [-0.5, 0.5]])  # (α, β) @ _EGLI = (α − β)/2, (α + β)/2


def _rounded_box(targets: Array, points: Array, s: Array) -> Array:
    """Product of one-dimensional weights in (Δα − Δβ)/2 and (Δα + Δβ)/2 (Egli 2013, eq. 6)."""
    doubled = 2 * _EGLI
    t, p = targets @ doubled, points @ doubled
    weights = _twice_edge(t[:, 0], p[:, 0], s)
    weights *= _twice_edge(t[:, 1], p[:, 1], s)
    weights *= 0.25
    return weights


def _twice_edge(targets: Array, points: Array, s: Array) -> Array:
    """Twice the weight at distances |x|, given doubled: 1 up to s − 1, 0 beyond s, two parabolas between.

    With e = 2s − 1 − 2|x| within ±1, both parabolas are (1 + e(2 − |e|))/2.
    """
    e = np.subtract(targets[:, None], points)
    np.abs(e, out=e)
    np.subtract((2 * s - 1)[:, None], e, out=e)
    np.clip(e, -1.0, 1.0, out=e)
    rest = np.abs(e)
    np.subtract(2.0, rest, out=rest)
    e *= rest
    e += 1.0
    return e


WINDOWS = {
    "loess": RegressionWindow(_tricube, np.eye(2), one_step=False),
    "variforc": RegressionWindow(_rounded_box, _EGLI, one_step=True),
}

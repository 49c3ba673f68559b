"""The least value of a function over the triangle P_r, found and bounded by branch and bound.

Boxes whose enclosure cannot improve on the best value found are dropped; the others are quartered. The result is an
attained value, its place, and a proved bound.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.preisach import Interval

Place = tuple[float, float]
_START = 32
_MAX_BOXES = 400_000


@dataclass(frozen=True)
class Extreme:
    """A least (or largest) ``value``, attained at (α, β) = ``at``, and the ``bound`` that no value exceeds.

    ``bound`` equals ``value`` if the value is exact, and is NaN if nothing is proved.
    """

    value: float
    at: Place
    bound: float

    def mirrored_place(self) -> "Extreme":
        """The same value in the mirror image of the plane."""
        return Extreme(self.value, (-self.at[1], -self.at[0]), self.bound)

    def negated(self) -> "Extreme":
        """A largest value from the least value of the negated function, or the reverse."""
        return Extreme(-self.value, self.at, -self.bound)


def least_of(values: Array, alpha: Array, beta: Array) -> Extreme:
    """Least of a finite number of values, exact. NaN entries are ignored."""
    if not np.isfinite(values).any():
        return Extreme(float("nan"), (float("nan"), float("nan")), float("nan"))
    k = int(np.nanargmin(values))
    value = float(values.flat[k])
    return Extreme(value, (float(alpha.flat[k]), float(beta.flat[k])), value)


def least(
    value: Callable[[Array, Array], Array],
    enclose: Callable[[Interval, Interval], Interval],
    lower: float,
    upper: float,
    tolerance: float = 1e-6,
) -> Extreme:
    """Least ``value(α, β)`` over u₋ ≤ β ≤ α ≤ u₊. The bound is within ``tolerance``, relative to the largest value.

    If that takes more than about 10⁵ boxes, the search ends early, and the bound is what was proved until then.
    """
    edges = np.linspace(lower, upper, _START + 1)
    i, j = (k.ravel() for k in np.meshgrid(np.arange(_START), np.arange(_START), indexing="ij"))
    corners = np.stack([edges[i], edges[j]])[:, j <= i]
    size, best, at, floor, scale = edges[1] - edges[0], np.inf, (lower, lower), np.inf, 0.0
    while corners.size:
        alpha = Interval(corners[0], np.minimum(corners[0] + size, upper))
        beta = Interval(corners[1], np.minimum(corners[1] + size, upper))
        a = (alpha.low + alpha.high) / 2
        b = np.minimum((beta.low + beta.high) / 2, a)
        corners_of = ((alpha.high, beta.low), (alpha.high, beta.high), (alpha.low, beta.low))
        for points in ((a, b), *((x, np.minimum(y, x)) for x, y in corners_of)):
            found = np.asarray(value(*points))
            k = int(found.argmin())
            scale = max(scale, float(np.abs(found).max()))
            if found[k] < best:
                best, at = float(found[k]), (float(points[0][k]), float(points[1][k]))
        low = enclose(alpha, beta).low
        open_ = low < best - tolerance * scale
        floor = min(floor, float(low[~open_].min(initial=np.inf)))
        if 4 * int(open_.sum()) > _MAX_BOXES:
            floor = min(floor, float(low.min()))
            break
        corners, size = _quartered(corners[:, open_], size / 2)
    return Extreme(best, at, min(best, floor))


def _quartered(corners: Array, half: float) -> tuple[Array, float]:
    """The four quarters of each box that reach below the diagonal."""
    steps = half * np.array([[0, 0, 1, 1], [0, 1, 0, 1]])
    quarters = (corners[:, :, None] + steps[:, None, :]).reshape(2, -1)
    return quarters[:, quarters[1] <= quarters[0] + half / 2], half

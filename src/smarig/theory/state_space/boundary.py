"""A boundary B: the curve in the Preisach plane between relays that are up and relays that are down (§6.2.3).

A state is a continuous graph in (β, α) from (−û, û) to the line α = β, which it meets at (u, u), u the
present input. Definition 6.2 asks of every point

    (BP1)  −û ≤ β ≤ B(β) ≤ û        (BP2)  B(−û) = û        (BP3)  B does not increase

and lets B be multivalued (vertical edges) and of any negative slope: those curves complete the space
(Thm 6.7) though no input draws them. Held as a polyline, so staircases and straight slopes are exact and
other curves as close as their points. Knows no measure μ, no time and no output.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError

Point = tuple[float, float]  # (β, α), abscissa first, as in (6.10) and the figures
ROUNDING = 1e-12  # of û: differences below are rounding of coordinates, not geometry


@dataclass(frozen=True)
class Boundary:
    """An element of ℬ: ``points`` (β, α) from (−û, û) to (u, u), in units of the input; û is ``bound``.

    Two boundaries are equal when they are the same curve: repeated points and points inside a horizontal,
    vertical or slope −1 run are dropped. Raises UsageError naming the property of Def. 6.2 that fails.

    >>> Boundary(((-10, 10), (-10, 4), (1, 4), (1, 1)), bound=10)
    Boundary(u=1, 2 corners, bound=10)
    >>> Boundary(((-10, 10), (-3, 4), (0, 6), (6, 6)), bound=10)
    Traceback (most recent call last):
    smarig.core.errors.UsageError: Boundary point 2 at (β, α) = (0, 6) breaks (BP3): α rises from 4; ...
    """

    points: tuple[Point, ...]
    bound: float

    def __post_init__(self) -> None:
        points = tuple((float(beta), float(alpha)) for beta, alpha in self.points)
        _check(points, self.bound)
        object.__setattr__(self, "points", _corners(points))

    @property
    def u(self) -> float:
        """The input at which B meets α = β."""
        return self.points[-1][0]

    @property
    def beta(self) -> NDArray[np.float64]:
        """Abscissae of the points, shape (n,)."""
        return np.array([beta for beta, _ in self.points])

    @property
    def alpha(self) -> NDArray[np.float64]:
        """Ordinates of the points, shape (n,)."""
        return np.array([alpha for _, alpha in self.points])

    def __repr__(self) -> str:
        return f"Boundary(u={self.u:g}, {max(len(self.points) - 2, 0)} corners, bound={self.bound:g})"


def anhysteretic(bound: float) -> Boundary:
    """B* = {α = −β}, the zero element of ℬ and the state before all inputs (Def. 3.1, §6.2.3)."""
    return diagonal(bound, 0.0)


def diagonal(bound: float, centre: float) -> Boundary:
    """B_ℓ = {α = 2ℓ − β} (§8.3), ℓ = ``centre``, completed along the edge of P_r where ℓ ≠ 0.

    The line alone meets the edge of P_r away from (−û, û) and so breaks (BP2); the edge carries no area
    and no relay, so completing it changes neither distance nor output (theory.md, erratum 10).
    """
    if not abs(centre) <= bound:
        raise UsageError(f"The diagonal state B_ℓ needs |ℓ| ≤ û = {bound:g}, got ℓ = {centre:g}.")
    return Boundary(((-bound, bound), *diagonal_ends(bound, centre)), bound)


def diagonal_ends(bound: float, centre: float) -> tuple[Point, Point]:
    """Where the line α = 2ℓ − β enters P_r (on α = û for ℓ ≥ 0, else on β = −û), and where it meets α = β."""
    enters = (2 * centre - bound, bound) if centre >= 0 else (-bound, 2 * centre + bound)
    return enters, (centre, centre)


def staircase_points(extrema: Sequence[float]) -> tuple[Point, ...]:
    """Corners of alternating extrema, (β, α) = (smaller, larger) of neighbours, and the end (u, u)."""
    corners = ((min(pair), max(pair)) for pair in pairwise(extrema))
    return *corners, (extrema[-1], extrema[-1])


def has_slope_minus_one(start: Point, end: Point, bound: float) -> bool:
    """Whether a segment has slope −1 (to rounding) and is not the trace of an input (neither edge is level)."""
    (b0, a0), (b1, a1) = start, end
    return b0 != b1 and a0 != a1 and abs((a1 + b1) - (a0 + b0)) <= ROUNDING * bound


def _check(points: tuple[Point, ...], bound: float) -> None:
    if not (math.isfinite(bound) and bound > 0):
        raise UsageError(f"The input bound û of a boundary must be positive and finite, got {bound:g}.")
    for i, (beta, alpha) in enumerate(points):
        if not -bound <= beta <= alpha <= bound:
            raise UsageError(
                f"Boundary point {i} at (β, α) = ({beta:g}, {alpha:g}) breaks (BP1): "
                f"−û ≤ β ≤ α ≤ û with û = {bound:g}; give points inside the Preisach triangle."
            )
    if not points or points[0] != (-bound, bound):
        raise UsageError(
            f"A boundary must begin at (−û, û) = ({-bound:g}, {bound:g}) (BP2); "
            "complete it along the edge of the Preisach triangle."
        )
    for i, ((b0, a0), (b1, a1)) in enumerate(pairwise(points), start=1):
        if a1 > a0 or b1 < b0:
            what = f"α rises from {a0:g}" if a1 > a0 else f"β goes back from {b0:g}"
            raise UsageError(
                f"Boundary point {i} at (β, α) = ({b1:g}, {a1:g}) breaks (BP3): {what}; "
                "give points with β rising and α falling."
            )
    if points[-1][0] != points[-1][1]:
        beta, alpha = points[-1]
        raise UsageError(
            f"A boundary must end on α = β, at the present input; this one ends at ({beta:g}, {alpha:g})."
        )


def _corners(points: tuple[Point, ...]) -> tuple[Point, ...]:
    """The same curve without repeated points and without points inside a straight run of an input or of B_ℓ."""
    kept: list[Point] = []
    for point in points:
        if kept and point == kept[-1]:
            continue
        if len(kept) > 1 and _in_line(kept[-2], kept[-1], point):
            kept.pop()
        kept.append(point)
    return tuple(kept)


def _in_line(p: Point, q: Point, r: Point) -> bool:
    level, upright = p[1] == q[1] == r[1], p[0] == q[0] == r[0]
    return level or upright or sum(p) == sum(q) == sum(r)

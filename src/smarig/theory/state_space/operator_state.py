"""Converts the operator's memory into its boundary (State → B), and back for boundaries that an input generates.

The operator is defined on [u₋, u₊], with negative saturation or a diagonal state B_ℓ as its base. Boundaries are
defined on [−û, û], û = max(|u₋|, |u₊|). There are no relays beyond [u₋, u₊], so the base u₋ is placed at −û.
"""

import numpy as np

from smarig.core import UsageError
from smarig.preisach import Everett, Preisach, State
from smarig.theory.state_space.boundary import (
    Boundary,
    Point,
    RotatedBoundary,
    diagonal,
    diagonal_ends,
    has_slope_minus_one,
    rotated,
    staircase_points,
)
from smarig.theory.state_space.maps import extrema_along
from smarig.theory.state_space.read_out import check_covers


def boundary_of(state: State, hysteresis: Everett) -> Boundary:
    """The boundary of an operator's state, on û = max(|u₋|, |u₊|).

    >>> from smarig.preisach import thesis_surface
    >>> wire = Preisach(thesis_surface("two_c"), "anhysteretic")
    >>> _ = wire.step(60.0), wire.step(-20.0)
    >>> boundary_of(wire.state, wire.hysteresis).points
    ((-185.0, 185.0), (-60.0, 60.0), (-20.0, 60.0), (-20.0, -20.0))
    """
    bound = max(abs(hysteresis.lower), abs(hysteresis.upper))
    base, *rest = state.extrema
    moves = [*rest, state.u]
    if not state.diagonal:
        return Boundary(((-bound, bound), *staircase_points([-bound, *moves])), bound)
    if moves == [base]:
        return diagonal(bound, base)
    # the boundary leaves the line α = 2ℓ − β at (opposite, s₁) or (s₁, opposite)
    opposite = 2 * base - moves[0]
    stairs = staircase_points([min(max(opposite, -bound), bound), *moves])
    line = diagonal_ends(bound, base)[:1] if abs(opposite) < bound else ()
    return Boundary(((-bound, bound), *line, *stairs), bound)


def state_of(boundary: Boundary, hysteresis: Everett) -> State:
    """The operator's state for a boundary that an input generates from saturation, from B* or from a B_ℓ.

    UsageError for other slopes and for a boundary that does not cover the range of the hysteresis.

    >>> from smarig.preisach import thesis_surface
    >>> from smarig.theory.state_space.boundary import diagonal
    >>> Preisach(thesis_surface("two_c"), state_of(diagonal(185.0, 40.0), thesis_surface("two_c"))).u
    40.0
    """
    check_covers(boundary, hysteresis)
    centre, drawn = _diagonal_start(boundary)
    operator = Preisach(hysteresis)
    if centre is not None:
        operator.go_to_diagonal(centre)
    for u in extrema_along(drawn):
        operator.step(u)
    return operator.state


def _diagonal_start(boundary: Boundary) -> tuple[float | None, tuple[Point, ...]]:
    """ℓ, if B starts as B_ℓ (perhaps along the edge of P_r), and the points from where B leaves it."""
    points, bound = boundary.points, boundary.bound
    for skip in (0, 1):
        ends = points[skip : skip + 2]
        on_edge = ends[0][0] == -bound or ends[0][1] == bound
        if len(ends) == 2 and on_edge and has_slope_minus_one(*ends, bound):
            return 0.5 * sum(ends[1]), points[skip + 1 :]
    return None, points


def distance(first: Boundary, second: Boundary) -> float:
    """d(B₁, B₂) in input units squared; exact to rounding for polylines.

    >>> from smarig.theory.state_space.boundary import anhysteretic, diagonal
    >>> round(distance(anhysteretic(10), diagonal(10, 10)), 9)          # half of the triangle
    100.0
    """
    if first.bound != second.bound:
        raise UsageError(
            f"Boundaries with û = {first.bound:g} and {second.bound:g} belong to different state spaces."
        )
    return rotated_distance(rotated(first), rotated(second))


def rotated_distance(first: RotatedBoundary, second: RotatedBoundary) -> float:
    """d̃ (6.11): the L₁ distance of two rotated boundaries, integrated exactly between all their corners."""
    x = np.union1d(first.abscissa, second.abscissa)
    gap = first(x) - second(x)
    left, right = gap[:-1], gap[1:]
    size = np.abs(left) + np.abs(right)
    crossing = left * right < 0
    height = np.where(crossing, (left**2 + right**2) / np.where(crossing, size, 1.0), size) / 2
    return float(np.sum(height * np.diff(x)))

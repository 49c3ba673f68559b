"""The read-out r(B): the output of a state, independent of the input that led to it (§6.4.3).

    r(B) = ∬_{P₊B} μ − ∬_{P₋B} μ  (+ offset)  =  y₋ + ν(P₊B)

ν is the measure of output changes (theory.md §1), reversible part included. P₊B is evaluated column by column: a level
edge at α from β₀ to β₁ contributes F(α, β₀) − F(α, β₁), an upright edge nothing, and a slope −1 the integral that the
hysteresis provides. Other slopes are cut into ``STEPS`` level edges through their middles.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import UsageError
from smarig.preisach import Everett
from smarig.theory.state_space.boundary import Boundary, Point, has_slope_minus_one

STEPS = 1024


def read_out(boundary: Boundary, hysteresis: Everett) -> float:
    """r(B) in the unit of the output, for any hysteresis whose inputs lie in [−û, û] (else UsageError).

    Exact to rounding for staircases and for states that start from B* or B_ℓ. On segments of other slopes the error
    falls with the square of the step size for a density, and with the step size for single relays.

    >>> from smarig.preisach import thesis_surface
    >>> from smarig.theory.state_space.boundary import anhysteretic
    >>> round(read_out(anhysteretic(185.0), thesis_surface("two_c")), 2)      # not zero: ν is not symmetric
    2.65
    """
    check_covers(boundary, hysteresis)
    columns = (
        _column(start, end, hysteresis, boundary.bound)
        for start, end in pairwise(boundary.points)
        if start[0] != end[0]
    )
    return hysteresis.y_lower + sum(columns)


def check_covers(boundary: Boundary, hysteresis: Everett) -> None:
    """Raise UsageError unless the boundary's triangle contains that of the hysteresis, û ≥ max(|u₋|, |u₊|)."""
    needed = max(abs(hysteresis.lower), abs(hysteresis.upper))
    if boundary.bound < needed:
        raise UsageError(
            f"The boundary is defined for |u| ≤ {boundary.bound:g}, but the hysteresis reaches {needed:g}. "
            f"Define it with û = {needed:g}."
        )


def is_up(boundary: Boundary, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.bool_]:
    """Whether relays (α, β) belong to P₊B: below or left of the boundary, or on it. Arrays broadcast."""
    a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
    return a + b <= np.interp(b - a, boundary.beta - boundary.alpha, boundary.beta + boundary.alpha)


def _column(start: Point, end: Point, hysteresis: Everett, bound: float) -> float:
    """ν of the area under one segment, clipped to the range of the hysteresis."""
    (b0, a0), (b1, a1) = start, end
    low, high = hysteresis.lower, hysteresis.upper
    left, right = min(max(b0, low), high), min(max(b1, low), high)
    if left == right:
        return 0.0
    if a0 == a1:
        return _under_edge(min(a0, high), left, right, hysteresis)
    if has_slope_minus_one(start, end, bound):
        centre = 0.5 * (a1 + b1)
        # a boundary that meets α = β ends there: a degenerate relay at this point is up
        beyond = hysteresis.fall_from_diagonal(centre, right) if right < centre else 0.0
        return hysteresis.fall_from_diagonal(centre, left) - beyond
    return _under_slope(start, end, hysteresis)


def _under_edge(alpha: float, left: float, right: float, hysteresis: Everett) -> float:
    """F(α, β₀) − F(α, β₁). At the end of an edge on α = β, a degenerate relay is up, as after a rise."""
    return hysteresis.everett(alpha, left) - (hysteresis.everett(alpha, right) if right < alpha else 0.0)


def _under_slope(start: Point, end: Point, hysteresis: Everett) -> float:
    """−∫ ∂_βF(B(β), β) dβ over a straight slope, by level edges through the middles of equal steps."""
    (b0, a0), (b1, a1) = start, end
    low, high = hysteresis.lower, hysteresis.upper
    beta = np.linspace(b0, b1, STEPS + 1)
    share = (np.arange(STEPS) + 0.5) / STEPS
    alpha = np.clip(a0 + share * (a1 - a0), low, high)
    beta = np.clip(beta, low, high)
    return float(np.sum(hysteresis.swept(alpha, beta[:-1]) - hysteresis.swept(alpha, beta[1:])))

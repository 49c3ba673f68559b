"""The read-out r(B): the output that belongs to a state, whatever led to it (§6.4.3).

    r(B) = ∬_{P₊B} μ − ∬_{P₋B} μ  (+ offset)  =  y₋ + ν(P₊B)

ν is the measure of output changes (theory.md §1), reversible part included. P₊B is read column by column:
over a level edge at α from β₀ to β₁ stands F(α, β₀) − F(α, β₁), over an upright edge nothing, and over a
slope −1 the integral the hysteresis itself provides. Other slopes are cut into ``STEPS`` level edges
through their middles. Knows nothing of the past: only the curve.
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

    Exact to rounding for staircases and for B*, B_ℓ and what grows out of them. On segments of other slopes
    the error falls with the square of the step for a density, and with the step for single relays.

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
    """UsageError unless the triangle of the boundary holds that of the hysteresis, û ≥ max(|u₋|, |u₊|)."""
    needed = max(abs(hysteresis.lower), abs(hysteresis.upper))
    if boundary.bound < needed:
        raise UsageError(
            f"The boundary is drawn for |u| ≤ {boundary.bound:g}, the hysteresis reaches {needed:g}; "
            f"draw it with û = {needed:g}."
        )


def is_up(boundary: Boundary, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.bool_]:
    """Whether relays (α, β) belong to P₊B: below or left of the boundary, or on it. Arrays, which broadcast."""
    a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
    return a + b <= np.interp(b - a, boundary.beta - boundary.alpha, boundary.beta + boundary.alpha)


def _column(start: Point, end: Point, hysteresis: Everett, bound: float) -> float:
    """ν of what lies under one segment, cut to the range of the hysteresis."""
    (b0, a0), (b1, a1) = start, end
    low, high = hysteresis.lower, hysteresis.upper
    left, right = min(max(b0, low), high), min(max(b1, low), high)
    if left == right:
        return 0.0
    if a0 == a1:
        return _under_edge(min(a0, high), left, right, hysteresis)
    if has_slope_minus_one(start, end, bound):
        centre = 0.5 * (a1 + b1)
        # B meeting α = β ends there: a degenerate relay at the meeting point is up
        beyond = hysteresis.fall_from_diagonal(centre, right) if right < centre else 0.0
        return hysteresis.fall_from_diagonal(centre, left) - beyond
    return _under_slope(start, end, hysteresis)


def _under_edge(alpha: float, left: float, right: float, hysteresis: Everett) -> float:
    """F(α, β₀) − F(α, β₁); an edge that ends on α = β leaves a degenerate relay there up, as rising does."""
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

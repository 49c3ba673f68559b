"""Approximate reachability (Thm 6.4) as a construction: an input that takes B* as close to B as required.

No input generates a slope other than the rest of B*, so ℬ is not reachable (§6.2.4). A slope can be approximated by k
steps through its middles, which an input can generate, with an error of area Δα Δβ/(4k). The steps cover [−û, u]. The
thesis partitions [−û, 0] only and omits the rest (erratum 10).
"""

import math
from itertools import pairwise

import numpy as np

from smarig.core import UsageError
from smarig.theory.state_space.boundary import Boundary, Point
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import H, starts_on_zero_state

MAX_STEPS = 1_000_000


def reach(boundary: Boundary, within: float, tau: float = 0.0) -> InputSignal:
    """An input u ∈ 𝒰(−∞, τ] with d(B, φ(τ, −∞, B*, u)) < ``within`` (an area, input units squared).

    >>> from smarig.theory.state_space.boundary import anhysteretic, diagonal
    >>> from smarig.theory.state_space.maps import H_left
    >>> from smarig.theory.state_space.operator_state import distance
    >>> goal = diagonal(10, 3)                                   # B_ℓ: where set-point regulation starts, §8.3
    >>> distance(goal, H_left(reach(goal, within=0.5), 0.0, bound=10)) < 0.5
    True
    """
    return H(staircase(boundary, within), tau)


def staircase(boundary: Boundary, within: float) -> Boundary:
    """A reachable boundary at a distance less than ``within`` from B; B itself if an input can generate it.

    The numbers of steps k_j of the slopes are chosen so that their sum is least for the allowed area: k_j ∝ √(Δα Δβ).
    UsageError if more than ``MAX_STEPS`` would be needed.
    """
    if not within > 0:
        raise UsageError(
            f"The area within which a boundary is approximated must be positive, got {within:g}."
        )
    points = boundary.points
    kept, sloped = (points[:1], points[1:]) if starts_on_zero_state(boundary) else ((), points)
    roots = [math.sqrt((b1 - b0) * (a0 - a1)) for (b0, a0), (b1, a1) in pairwise(sloped)]
    if not sum(roots) ** 2 / 4 / within < MAX_STEPS:
        raise UsageError(
            f"An approximation within an area of {within:g} needs more than {MAX_STEPS} reversals. "
            "Give a larger area."
        )
    enough = (1 + 1e-6) / (4 * within)  # the margin keeps "less than" true after rounding
    steps = [math.floor(root * sum(roots) * enough) + 1 for root in roots]
    stairs = [point for n, pair in zip(steps, pairwise(sloped)) for point in _stairs(*pair, n)]
    return Boundary((*kept, *sloped[:1], *stairs), boundary.bound)


def _stairs(start: Point, end: Point, steps: int) -> list[Point]:
    """Corners down, across, down, across … down: ``steps`` level edges through the middles of a slope."""
    (b0, a0), (b1, a1) = start, end
    if b0 == b1 or a0 == a1:
        return [end]
    beta = np.linspace(b0, b1, steps + 1).tolist()
    heights = np.linspace(a0, a1, 2 * steps + 1)[1::2].tolist()
    corners = [corner for i, a in enumerate(heights) for corner in ((beta[i], a), (beta[i + 1], a))]
    return [*corners, end]

"""The distance between two states: the area between their boundaries (§6.5.1).

    d(B₁, B₂) = ∬_{P_{B₁B₂}} dα dβ = ∫_{−√2 û}^{0} |B̃₁ − B̃₂| dβ̃        (6.11)

Turned by 45° the area is an L₁ distance of functions. With it ℬ is bounded, d ≤ 2û² (§6.5.3), and complete
(Thm 6.7). It counts relays by area, not by weight: knows no measure μ.
"""

import numpy as np

from smarig.core.errors import UsageError
from smarig.theory.state_space.boundary import Boundary
from smarig.theory.state_space.rotation import RotatedBoundary, rotated


def distance(first: Boundary, second: Boundary) -> float:
    """d(B₁, B₂), input units squared; exact for polylines, to rounding.

    >>> from smarig.theory.state_space.boundary import anhysteretic, diagonal
    >>> round(distance(anhysteretic(10), diagonal(10, 10)), 9)          # half of the triangle
    100.0
    """
    if first.bound != second.bound:
        raise UsageError(
            f"Boundaries with û = {first.bound:g} and {second.bound:g} are not in one state space."
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

"""Boundaries rotated by 45° (§6.5): every state becomes a function with Lipschitz constant 1.

    β̃ = (β − α)/√2 ∈ [−√2 û, 0],      B̃ = (β + α)/√2         (6.10)

Level edges get slope +1 and upright ones −1; nothing is multivalued. Claim 6.3: B ∈ ℬ exactly if
(B̃P1) |B̃(β̃)| ≤ √2 û + β̃, (B̃P2) B̃(−√2 û) = 0, (B̃P3) |B̃(β̃₁) − B̃(β̃₂)| ≤ |β̃₁ − β̃₂|.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.theory.state_space.boundary import ROUNDING, Boundary

ROOT = math.sqrt(2.0)
TOLERANCE = 1e-9  # relative to û: rounding allowed in a computed rotated boundary


@dataclass(frozen=True, eq=False)
class RotatedBoundary:
    """B̃ as a piecewise linear function: ``ordinate`` B̃ at ``abscissa`` β̃, both (n,), rising from −√2 û to 0.

    UsageError names the property of Claim 6.3 that is violated by more than rounding.
    """

    abscissa: Array
    ordinate: Array
    bound: float

    def __post_init__(self) -> None:
        x, h, slack = self.abscissa, self.ordinate, TOLERANCE * self.bound
        if x.shape != h.shape or x.ndim != 1 or x.size < 2 or np.any(np.diff(x) <= 0):
            raise UsageError(
                "A rotated boundary needs one ordinate per abscissa and strictly rising abscissae."
            )
        if abs(x[0] + ROOT * self.bound) > slack or abs(x[-1]) > slack:
            raise UsageError(f"A rotated boundary must span [−√2 û, 0], got [{x[0]:g}, {x[-1]:g}].")
        if not abs(h[0]) <= slack:
            raise UsageError(f"(B̃P2) fails: a rotated boundary must start at 0, this one starts at {h[0]:g}.")
        steep = np.abs(np.diff(h)) - np.diff(x)
        if not np.max(steep) <= slack:
            at = x[int(np.argmax(steep))]
            raise UsageError(
                f"(B̃P3) fails: the slope exceeds ±1 after β̃ = {at:g}, where the unrotated α would rise."
            )

    def __call__(self, abscissa: ArrayLike) -> Array:
        """B̃(β̃) for arrays."""
        return np.interp(np.asarray(abscissa, dtype=float), self.abscissa, self.ordinate)

    def unrotated(self) -> Boundary:
        """The boundary B = R⁻¹B̃ (6.10) without rounding: level and upright edges are exact again."""
        limit = self.bound
        u = float(self.ordinate[-1] / ROOT)
        if abs(u) > (1 - ROUNDING) * limit:
            u = math.copysign(limit, u)
        falling = [
            _without_rounding(
                (sign * self.ordinate - self.abscissa) / ROOT, (limit, sign * u), ROUNDING * limit
            )
            for sign in (1.0, -1.0)  # α and −β
        ]
        points = zip((-falling[1]).tolist(), falling[0].tolist())
        return Boundary(((-limit, limit), *points, (u, u)), limit)


def _without_rounding(v: Array, ends: tuple[float, float], rounding: float) -> Array:
    """Values that fall from ends[0] to ends[1], with rises, overshoots and drops below rounding removed."""
    low = np.minimum.accumulate(np.clip(v, ends[1], ends[0]))
    falls = np.r_[True, -np.diff(low) > rounding]
    level = low[np.maximum.accumulate(np.where(falls, np.arange(low.size), 0))]
    for end in ends:
        level = np.where(np.abs(level - end) <= rounding, end, level)
    return level


def rotated(boundary: Boundary) -> RotatedBoundary:
    """B̃ = R B.

    >>> from smarig.theory.state_space.boundary import anhysteretic
    >>> rotated(anhysteretic(10))([-14.0, -5.0, 0.0])                  # B* is the zero element
    array([0., 0., 0.])
    """
    beta, alpha = boundary.beta, boundary.alpha
    # corners closer than rounding are merged
    abscissa, kept = np.unique((beta - alpha) / ROOT, return_index=True)
    return RotatedBoundary(abscissa, (beta + alpha)[kept] / ROOT, boundary.bound)

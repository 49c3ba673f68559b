"""Interval arithmetic: ranges instead of numbers, so that what is computed holds everywhere in a box.

Holds to rounding of double precision. Knows one formula, the shift f of a surface (5.5).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.hysteresis.fod_surface import FodSurface

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Interval:
    """Ranges [low, high], arrays (n,)."""

    low: Array
    high: Array

    @classmethod
    def hull(cls, *values: Array) -> "Interval":
        """The smallest ranges that hold all of these values."""
        return cls(np.minimum.reduce(values), np.maximum.reduce(values))

    def __add__(self, other: "Interval") -> "Interval":
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other: "Interval") -> "Interval":
        return Interval(self.low - other.high, self.high - other.low)

    def __mul__(self, other: "Interval") -> "Interval":
        a, b, c, d = self.low, self.high, other.low, other.high
        return Interval.hull(a * c, a * d, b * c, b * d)

    def times(self, factor: float) -> "Interval":
        """The ranges of a multiple."""
        return Interval.hull(factor * self.low, factor * self.high)

    @property
    def size(self) -> Array:
        """Largest absolute value in each range."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def width(self) -> Array:
        """high − low."""
        return self.high - self.low


def shift(surface: FodSurface, alpha: Interval) -> tuple[Interval, Interval]:
    """Ranges of f and f′ over α: f′ is monotone in every form, f too but for the parabola's vertex."""
    (f0, d0), (f1, d1) = surface.shift(alpha.low), surface.shift(alpha.high)
    turning = f0
    if surface.form == "parabolic" and surface.x[3] != 0.0:
        turning = surface.shift(np.clip(-surface.x[4] / (2 * surface.x[3]), alpha.low, alpha.high))[0]
    return Interval.hull(f0, f1, turning), Interval.hull(d0, d1)

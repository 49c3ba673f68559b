"""Interval arithmetic: ranges instead of numbers, so that a result holds everywhere in a box.

Results hold to rounding in double precision.
"""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.preisach.hysteresis.fod_surface import FodSurface


@dataclass(frozen=True, eq=False)
class Interval:
    """Ranges [low, high], arrays (n,)."""

    low: Array
    high: Array

    @classmethod
    def hull(cls, *values: Array) -> "Interval":
        """The smallest ranges that contain all these values."""
        return cls(np.minimum.reduce(values), np.maximum.reduce(values))

    def __add__(self, other: "Interval") -> "Interval":
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other: "Interval") -> "Interval":
        return Interval(self.low - other.high, self.high - other.low)

    def __mul__(self, other: "Interval") -> "Interval":
        a, b, c, d = self.low, self.high, other.low, other.high
        return Interval.hull(a * c, a * d, b * c, b * d)

    def times(self, factor: float) -> "Interval":
        """The ranges multiplied by a factor."""
        return Interval.hull(factor * self.low, factor * self.high)

    @property
    def size(self) -> Array:
        """Largest absolute value in each range."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def width(self) -> Array:
        """high − low."""
        return self.high - self.low


def shift_bounds(surface: FodSurface, alpha: Interval) -> tuple[Interval, Interval]:
    """Ranges of f and f′ over α, from their values at the ends and at the turning points that the form gives."""
    form, x = surface.surface_form, surface.x[3:]
    values, slopes = ([at(x, alpha.low), at(x, alpha.high)] for at in (form.value, form.slope))
    values += [form.value(x, np.clip(u, alpha.low, alpha.high)) for u in form.value_turns(x)]
    slopes += [form.slope(x, np.clip(u, alpha.low, alpha.high)) for u in form.slope_turns(x)]
    return Interval.hull(*values), Interval.hull(*slopes)

"""Intervals that hold μ, g and the slopes of a surface (5.5) over whole boxes: what makes a bound proved.

Every factor of the closed forms is monotone, or has one known turning point, so its range over
[α₀, α₁] × [β₀, β₁] is known; products and sums of ranges enclose the rest. An interval shrinks in
proportion to its box. Proved means: to rounding of double precision. Knows no search and no table.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.fod_surface import FodSurface, sigmoid

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


def density(surface: FodSurface, alpha: Interval, beta: Interval) -> Interval:
    """μ = ½ c a x₄ s(1 − s) [x₂(1 − a) + x₄ f′(1 − 2s)], a = σ(x₂(α + x₃)), s = σ(x₄(β + f(α)))."""
    x2, _, x4 = surface.x[:3]
    a, f, slope = _along_alpha(surface, alpha)
    s = _falling(surface, f, beta)
    bracket = _one_minus(a).times(x2) + slope.times(x4) * Interval(1 - 2 * s.high, 1 - 2 * s.low)
    return (a * _bell(s) * bracket).times(0.5 * surface.amplitude * x4)


def reversible(surface: FodSurface, beta: Interval) -> Interval:
    """g = ∂y/∂β(β, β) = c a x₄ s(1 − s): every factor keeps its sign, so g has that of y₊ − y₋."""
    return fall(surface, beta, beta)


def fall(surface: FodSurface, alpha: Interval, beta: Interval) -> Interval:
    """∂y/∂β = c a x₄ s(1 − s), the strip a falling input sweeps; the sign of y₊ − y₋ everywhere."""
    a, f, _ = _along_alpha(surface, alpha)
    return (a * _bell(_falling(surface, f, beta))).times(surface.amplitude * surface.x[2])


def rise(surface: FodSurface, alpha: Interval, beta: Interval) -> Interval:
    """∂F/∂α = c a [x₂(1 − a)(s_α − s_β) + x₄(f′(p_α − p_β) + p_α)], p = s(1 − s), s_u = σ(x₄(u + f(α)))."""
    x2, _, x4 = surface.x[:3]
    a, f, slope = _along_alpha(surface, alpha)
    here, there = _falling(surface, f, alpha), _falling(surface, f, beta)
    top, bottom = _bell(here), _bell(there)
    growth = _one_minus(a).times(x2) * (here - there)
    drift = slope * (top - bottom) + top
    return (a * (growth + drift.times(x4))).times(surface.amplitude)


def _along_alpha(surface: FodSurface, alpha: Interval) -> tuple[Interval, Interval, Interval]:
    """Ranges of a, f and f′ over α."""
    x2, x3 = surface.x[:2]
    (f0, d0), (f1, d1) = surface.shift(alpha.low), surface.shift(alpha.high)
    turning = f0
    if surface.form == "parabolic" and surface.x[3] != 0.0:
        turning = surface.shift(np.clip(-surface.x[4] / (2 * surface.x[3]), alpha.low, alpha.high))[0]
    a = Interval.hull(sigmoid(x2 * (alpha.low + x3)), sigmoid(x2 * (alpha.high + x3)))
    return a, Interval.hull(f0, f1, turning), Interval.hull(d0, d1)


def _falling(surface: FodSurface, f: Interval, u: Interval) -> Interval:
    x4 = surface.x[2]
    return Interval.hull(sigmoid(x4 * (u.low + f.low)), sigmoid(x4 * (u.high + f.high)))


def _one_minus(a: Interval) -> Interval:
    return Interval(1 - a.high, 1 - a.low)


def _bell(s: Interval) -> Interval:
    """s(1 − s) for s in [0, 1]: highest at ½."""
    ends = Interval.hull(s.low * (1 - s.low), s.high * (1 - s.high))
    return Interval(ends.low, np.where((s.low < 0.5) & (s.high > 0.5), 0.25, ends.high))

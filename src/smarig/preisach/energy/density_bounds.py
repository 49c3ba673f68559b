"""Bounds of the density μ of an analytic surface (5.5) over boxes, by interval arithmetic on its closed form.

Bounds, not samples: whatever μ does inside a box, it stays between them. Knows FodSurface and no energy.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.fod_surface import FodSurface, sigmoid

Array = NDArray[np.float64]
_EPS = float(np.finfo(float).eps)


class Interval(NamedTuple):
    """Lower and upper bound, arrays of one shape."""

    low: Array
    high: Array

    def __mul__(self, other: "Interval") -> "Interval":  # type: ignore[override]
        ends = [x * y for x in self for y in other]
        return Interval(np.minimum.reduce(ends), np.maximum.reduce(ends))


def _hull(x: Array, y: Array) -> Interval:
    return Interval(np.minimum(x, y), np.maximum(x, y))


def shift_bounds(surface: FodSurface, a0: Array, a1: Array) -> tuple[Interval, Interval]:
    """f and f′ over [a0, a1]: f′ is monotone in every form, f too but for the parabola's vertex."""
    (f0, d0), (f1, d1) = surface.shift(a0), surface.shift(a1)
    f = _hull(f0, f1)
    if surface.form == "parabolic" and surface.x[3] != 0.0:
        vertex = -surface.x[4] / (2 * surface.x[3])
        inside = (a0 < vertex) & (vertex < a1)
        at, _ = surface.shift(np.where(inside, vertex, a0))
        f = Interval(np.minimum(f.low, at), np.maximum(f.high, at))
    return f, _hull(d0, d1)


def density_bounds(surface: FodSurface, a0: Array, a1: Array, b0: Array, b1: Array) -> Interval:
    """Bounds of 2μ over boxes [a0, a1] × [b0, b1] (output/K²), by interval arithmetic on its closed form

    2μ = c · a · x₄ s(1 − s) · [x₂(1 − a) + x₄ f′ (1 − 2s)],   a = σ(x₂(α + x₃)),   s = σ(x₄(β + f(α))).

    a and s(1 − s) are positive, so the sign comes from the bracket alone, even where s(1 − s) underflows;
    the bracket, where terms cancel, is widened by its rounding.
    """
    x2, x3, x4 = surface.x[:3]
    f, df = shift_bounds(surface, a0, a1)
    a = _hull(sigmoid(x2 * (a0 + x3)), sigmoid(x2 * (a1 + x3)))
    z = _hull(x4 * (b0 + f.low), x4 * (b1 + f.high))
    bell0, bell1 = _bell(z.low), _bell(z.high)
    bell = Interval(
        np.minimum(bell0, bell1), np.where((z.low < 0) & (z.high > 0), 0.25, np.maximum(bell0, bell1))
    )
    tilt = Interval(-np.tanh(0.5 * z.high), -np.tanh(0.5 * z.low))  # 1 − 2s
    drift = Interval(*_scaled(x4, df)) * tilt
    growth = Interval(*_scaled(x2, Interval(1 - a.high, 1 - a.low)))
    slack = 4 * _EPS * (np.abs(growth.high) + np.maximum(np.abs(drift.low), np.abs(drift.high)))
    bracket = Interval(growth.low + drift.low - slack, growth.high + drift.high + slack)
    return Interval(*_scaled(surface.amplitude * x4, a * bell * bracket))


def _bell(z: Array) -> Array:
    """s(1 − s) without cancellation in the tails."""
    return 0.25 / np.cosh(np.minimum(0.5 * np.abs(z), 300.0)) ** 2


def _scaled(factor: float, interval: Interval) -> tuple[Array, Array]:
    low, high = factor * interval.low, factor * interval.high
    return (low, high) if factor >= 0 else (high, low)

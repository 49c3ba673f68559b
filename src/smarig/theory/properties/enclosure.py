"""Intervals that contain μ, g and the slopes of a surface (5.5) over whole boxes: the basis of proved bounds.

Every factor of the closed forms is monotone or has one known turning point, so its range over [α₀, α₁] × [β₀, β₁] is
known. Products and sums of ranges enclose the rest. An interval shrinks in proportion to its box. A proof holds to
rounding in double precision.
"""

import numpy as np

from smarig.preisach import FodSurface, Interval, shift_bounds, sigmoid


def density(surface: FodSurface, alpha: Interval, beta: Interval) -> Interval:
    """μ = ½ c a x₄ s(1 − s) [x₂(1 − a) + x₄ f′(1 − 2s)], a = σ(x₂(α + x₃)), s = σ(x₄(β + f(α)))."""
    x2, _, x4 = surface.x[:3]
    a, f, slope = _along_alpha(surface, alpha)
    s = _falling(surface, f, beta)
    bracket = _one_minus(a).times(x2) + slope.times(x4) * Interval(1 - 2 * s.high, 1 - 2 * s.low)
    return (a * _bell(s) * bracket).times(0.5 * surface.amplitude * x4)


def reversible(surface: FodSurface, beta: Interval) -> Interval:
    """g = ∂y/∂β(β, β) = c a x₄ s(1 − s). Every factor keeps its sign, so g has the sign of y₊ − y₋."""
    return fall(surface, beta, beta)


def fall(surface: FodSurface, alpha: Interval, beta: Interval) -> Interval:
    """∂y/∂β = c a x₄ s(1 − s): the strip that a falling input sweeps, everywhere with the sign of y₊ − y₋."""
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
    a = Interval.hull(sigmoid(x2 * (alpha.low + x3)), sigmoid(x2 * (alpha.high + x3)))
    return a, *shift_bounds(surface, alpha)


def _falling(surface: FodSurface, f: Interval, u: Interval) -> Interval:
    x4 = surface.x[2]
    return Interval.hull(sigmoid(x4 * (u.low + f.low)), sigmoid(x4 * (u.high + f.high)))


def _one_minus(a: Interval) -> Interval:
    return Interval(1 - a.high, 1 - a.low)


def _bell(s: Interval) -> Interval:
    """s(1 − s) for s in [0, 1], largest at ½."""
    ends = Interval.hull(s.low * (1 - s.low), s.high * (1 - s.high))
    return Interval(ends.low, np.where((s.low < 0.5) & (s.high > 0.5), 0.25, ends.high))

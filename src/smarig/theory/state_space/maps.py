"""The maps of Chapter 6 between inputs, memory sequences and boundaries: F_τ, F_τʳ, G, G⁻¹, H_τˡ, H_τ.

F extracts from an input the extrema that the operator remembers. G converts them into a staircase. Both have inverses
as far as possible: Fʳ builds one of many inputs, and G⁻¹ is defined on the range of G. Values are copied and never
computed, so compositions are exact to the last bit.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.theory.state_space.boundary import Boundary, Point, has_slope_minus_one, staircase_points
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.memory_sequence import MemorySequence


def F(u: InputSignal, tau: float, bound: float) -> MemorySequence:
    """F_τ u = s(u, τ) (6.1): the reduced memory sequence of u ∈ 𝒰 at time τ; û is ``bound``.

    s₁ = u(t₁), where t₁ is the last time at which |u| is largest. The next elements are, in turn, the least and the
    greatest value after the last time at which the previous one was attained, until that time is τ. O(n) in the knots.

    >>> F(InputSignal(range(6), (0, 5, -3, 2, -1, 1)), tau=4.5, bound=10).values
    (5.0, -3.0, 2.0, -1.0, 0.0)
    """
    past = u.until(tau)
    if past.values[0] != 0:
        raise UsageError(
            f"The input starts at u = {past.values[0]:g}, but inputs of 𝒰 start at rest, u(−∞) = 0."
        )
    v = np.array(past.values)
    if not np.max(np.abs(v)) <= bound:
        raise UsageError(
            f"The input reaches |u| = {np.max(np.abs(v)):g}, which exceeds its bound û = {bound:g}."
        )
    maxima, minima = _last_maximum_from(v), _last_maximum_from(-v)
    at = int(_last_maximum_from(np.abs(v))[0])
    kept, highest = [at], v[at] > 0
    while at < v.size - 1:
        at = int((minima if highest else maxima)[at + 1])
        kept.append(at)
        highest = not highest
    return MemorySequence(tuple(v[kept].tolist()), bound)


def _last_maximum_from(v: Array) -> NDArray[np.intp]:
    """For every k, the last index of max v[k:]."""
    back = v[::-1]
    record = np.r_[True, back[1:] > np.maximum.accumulate(back)[:-1]]
    first = np.maximum.accumulate(np.where(record, np.arange(v.size), 0))
    return (v.size - 1 - first)[::-1]


def F_right(s: MemorySequence, tau: float, start: float | None = None) -> InputSignal:
    """F_τʳ s (6.5): straight lines from 0 at t₀ = ``start`` through the elements of s, constant until the end τ.

    The partition is t_i = t_{i−1} + (τ − t₀)·6/(π² i²). The thesis prints the weight 1/(2i²) in (6.4). With it t_i
    tends to t₀ + (π²/12)(τ − t₀), not to τ, and an infinite s would not fill the interval (erratum 2).

    >>> F_right(MemorySequence((5, -3), bound=10), tau=1, start=0).values
    (0.0, 5.0, -3.0, -3.0)
    """
    start = tau - max(1.0, abs(tau)) if start is None else start
    if not start < tau:
        raise UsageError(f"An input that ends at τ = {tau:g} must start before τ, not at t₀ = {start:g}.")
    times = (start + (tau - start) * np.cumsum(partition_weights(s.N))).tolist()
    return InputSignal((start, *times, tau), (0.0, *s.values, s.limit))


def partition_weights(n: int) -> Array:
    """The first n shares of the time in (6.4), corrected: 6/(π² i²), which sum to 1 over all i."""
    return 6 / math.pi**2 / np.arange(1.0, n + 1) ** 2


def G(s: MemorySequence) -> Boundary:
    """G(s): the boundary with corners p₀ = (−û, û), p₁ = (−|s₁|, |s₁|), p_i = (s_i, s_{i−1}) or (s_{i−1}, s_i)
    as s falls or rises, and p_i = (u, u) for i > N(s) (the thesis prints it for i = N too: erratum 10).

    >>> G(MemorySequence((5, -3, 2), bound=10)).points
    ((-10.0, 10.0), (-5.0, 5.0), (-3.0, 5.0), (-3.0, 2.0), (2.0, 2.0))
    """
    first = abs(s.values[0])
    return Boundary(((-s.bound, s.bound), (-first, first), *staircase_points(s.values)), s.bound)


def G_inverse(boundary: Boundary) -> MemorySequence:
    """G⁻¹(B): the sequence with staircase B, for B ∈ Ra(G): a part of B*, then level and upright edges.

    UsageError for a boundary that no input generates (approximate it with ``reachability``). The thesis prints the
    corners as (α_i, β_i) here and as (β_i, α_i) in G; they are (β_i, α_i).

    >>> G_inverse(Boundary(((-10, 10), (-10, 4), (1, 4), (1, 1)), bound=10)).values
    (-10.0, 4.0, 1.0)
    """
    points = boundary.points
    if starts_on_zero_state(boundary):
        points = points[1:]
    return MemorySequence(tuple(extrema_along(points)), boundary.bound)


def starts_on_zero_state(boundary: Boundary) -> bool:
    """Whether the first segment lies on B* = {α = −β}, as part of the memory of the initial state."""
    points = boundary.points
    return len(points) > 1 and has_slope_minus_one(points[0], points[1], boundary.bound)


def extrema_along(points: Sequence[Point]) -> list[float]:
    """Extrema that generate level and upright edges through the points: s₁, …, u (the last may occur twice)."""
    if len(points) == 1:
        return [points[0][1]]
    level = points[0][1] == points[1][1]
    extrema = [points[0][1] if level else points[0][0]]
    for (b0, a0), (b1, a1) in pairwise(points):
        if a0 != a1 and b0 != b1:
            raise UsageError(
                f"The boundary is slanted between (β, α) = ({b0:g}, {a0:g}) and ({b1:g}, {a1:g}), which no input "
                "generates. Approximate it by a staircase (state_space.reachability)."
            )
        extrema.append(b1 if a0 == a1 else a1)
    return extrema


def H(boundary: Boundary, tau: float) -> InputSignal:
    """H_τ = F_τʳ G⁻¹: an input that ends at τ and takes B* to the boundary."""
    return F_right(G_inverse(boundary), tau)


def H_left(u: InputSignal, tau: float, bound: float) -> Boundary:
    """H_τˡ = G F_τ: the boundary that an input has generated at time τ."""
    return G(F(u, tau, bound))

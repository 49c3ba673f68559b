"""The work of moving the input, with the move cut into segments along the remembered boundary (thesis Thm 7.2).

A monotone input sweeps the Preisach plane strip by strip. Between two wipe-outs all strips end at one remembered
extremum e (or on a diagonal boundary B_ℓ), and the output is F(·, e) up to a constant. Then

    ∫ u dy = [u y] − ∫ y du                                                  (7.2), by parts

is exact: without trapezoids or density, for any sign of ν, and including jumps of relays. Inputs beyond saturation do
no work.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach import Everett, State
from smarig.theory.energy.moments import breaks, integral


class SweepSegment(NamedTuple):
    """The input moves from ``start`` to ``stop`` with all strips ending at ``base`` (or on B_base)."""

    start: float
    stop: float
    base: float
    diagonal: bool = False


class MovingBoundary:
    """A boundary during a run: the remembered extrema of a ``State``, without the outputs.

    ``extrema[0]`` is the base (u₋, or the centre ℓ of B_ℓ), then alternating maxima and minima, nested.
    """

    def __init__(self, state: State, lower: float, upper: float) -> None:
        self.extrema, self.u, self.diagonal = list(state.extrema), state.u, state.diagonal
        self.lower, self.upper = lower, upper

    def copy(self) -> "MovingBoundary":
        """An independent copy of the boundary."""
        copied = object.__new__(MovingBoundary)
        copied.__dict__.update(self.__dict__, extrema=self.extrema.copy())
        return copied

    def move(self, u: float) -> list[SweepSegment]:
        """Move to u (saturated) and return the segments of the move in order."""
        u = min(max(u, self.lower), self.upper)
        if u == self.u:
            return []
        segments = list(self._segments(u))
        self.u = u
        if u in (self.lower, self.upper):
            self.extrema, self.diagonal = [self.lower], False
        return segments

    def _segments(self, u: float) -> Iterator[SweepSegment]:
        rising, at, stack = u > self.u, self.u, self.extrema
        if at != stack[-1] and rising == (at < stack[-1]):
            stack.append(at)
        while True:
            wiped = self._next_wiped(rising)
            if wiped is None or (u < wiped if rising else u > wiped):
                break
            yield SweepSegment(at, wiped, *self._base())
            at = wiped
            del stack[1 if len(stack) == 2 else -2 :]
        if at != u:
            yield SweepSegment(at, u, *self._base())

    def _base(self) -> tuple[float, bool]:
        return self.extrema[-1], self.diagonal and len(self.extrema) == 1

    def _next_wiped(self, rising: bool) -> float | None:
        """The input at which the last two extrema are wiped out, if there is one on this side."""
        stack = self.extrema
        if len(stack) > 2:
            return stack[-2]
        if len(stack) == 2 and self.diagonal:
            return 2 * stack[0] - stack[1]
        return None if rising or len(stack) == 1 else stack[0]


def work_of_segments(hysteresis: Everett, segments: Iterable[SweepSegment]) -> Array:
    """∫ u dy over each segment, shape (n,), in output times input units."""
    segments = list(segments)
    works = np.zeros(len(segments))
    straight = [k for k, p in enumerate(segments) if not p.diagonal]
    if straight:
        start, stop, base = np.array([segments[k][:3] for k in straight]).T
        works[straight] = _against_corner(hysteresis, start, stop, base)
    for k, segment in enumerate(segments):
        if segment.diagonal:
            works[k] = _off_diagonal(hysteresis, segment)
    return works


def work(hysteresis: Everett, state: State, u: float) -> float:
    """Q = 2∬_Ω μα (rising) or −2∬_Ω μβ (falling) of one monotone move from a state to u, ν for 2μ (7.2)."""
    return float(
        work_of_segments(hysteresis, MovingBoundary(state, hysteresis.lower, hysteresis.upper).move(u)).sum()
    )


def _against_corner(hysteresis: Everett, start: Array, stop: Array, base: Array) -> Array:
    """Work of segments whose strips end at an extremum. One formula serves rising and falling moves.

    A falling output is −F and the move runs backwards, so the signs cancel. F(e, e) ≠ 0 only for a degenerate relay at
    e itself, which switches at the start of the segment and not before.
    """
    low, high = np.minimum(start, stop), np.maximum(start, stop)

    def output(v: Array, at: Array) -> Array:
        """The swept output: F(v, e) when rising from e, and F(e, v) when falling from it."""
        return hysteresis.swept(np.maximum(v, at), np.minimum(v, at))

    under = integral(lambda v, k: output(v, base[k]), low, high, breaks(hysteresis))
    swept = stop * output(stop, base) - np.where(start == base, 0.0, start * output(start, base))
    return np.where(stop > start, swept, -swept) - under


def _off_diagonal(hysteresis: Everett, segment: SweepSegment) -> float:
    """∫ u dR along a boundary of slope −1, where R is the output change of the operator from B_ℓ."""
    centre, low, high = segment.base, min(segment[:2]), max(segment[:2])
    rising = segment.stop > segment.start
    release = hysteresis.rise_from_diagonal if rising else hysteresis.fall_from_diagonal
    own = breaks(hysteresis)
    cuts = np.unique(np.concatenate([own, 2 * centre - own]))

    def output(v: Array, _: NDArray[np.intp]) -> Array:
        return np.array([release(centre, x) for x in v.ravel().tolist()]).reshape(v.shape)

    under = integral(output, np.array([low]), np.array([high]), cuts)[0]
    before = 0.0 if segment.start == centre else segment.start * release(centre, segment.start)
    swept = segment.stop * release(centre, segment.stop) - before
    return (swept if rising else -swept) - float(under)

"""The inverse of the Preisach operator: the least monotone move of the input that gives a wanted output.

The outputs at the remembered extrema determine the branch segment that contains the target. On this segment F is
solved for the input: exactly for relays (the first threshold that reaches the target) and for tables (in the cell that
contains it), to rounding for smooth surfaces.

The output must be monotone along the move: strip sums ∂F/∂α ≥ 0 when rising and ∂y/∂β ≥ 0 when falling. This is weaker
than μ ≥ 0 (theory.md §1). Otherwise a DataError names the inputs between which the output reverses. Smooth surfaces are
checked at 256 inputs, so a narrower reversal is not detected.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import isfinite, nextafter
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError, UsageError
from smarig.preisach.everett import Everett, from_diagonal
from smarig.preisach.kernel import ExtremaStack, KeyedEverett, keyed

ROUNDING = 1e-12  # of the output range
GRID_POINTS = 256
MAX_NODES = 600  # with more nodes, monotonicity is checked along each move instead of once for all moves


class BranchSegment(NamedTuple):
    """A part of the move between two inputs with one formula for the output, for a scalar and for an array."""

    start: float
    end: float
    y_end: float
    output: Callable[[float], float]
    outputs: Callable[[Array], Array]


def bracketed_root(f: Callable[[float], float], near: float, far: float) -> float:
    """Zero of a function that is negative at ``near`` and positive at ``far``; otherwise the end that violates this.

    Regula falsi with Anderson and Björck's weights, which ends at once if f is linear. Every fourth step bisects, so
    about two hundred evaluations are enough for any f.
    """
    at_near, at_far = f(near), f(far)
    if at_near >= 0 or at_far <= 0:
        return near if at_near >= 0 else far
    width, count, moved = 1e-16 * abs(far - near), 0, ""
    while abs(far - near) > width:
        count += 1
        u = far - at_far * (far - near) / (at_far - at_near) if count % 4 else 0.5 * (near + far)
        if not min(near, far) < u < max(near, far):
            u = 0.5 * (near + far)
            if u in (near, far):
                break
        here = f(u)
        if here == 0.0:
            return u
        if here < 0:
            if moved == "near":
                at_far *= _weight(here / at_near)
            near, at_near, moved = u, here, "near"
        else:
            if moved == "far":
                at_near *= _weight(here / at_far)
            far, at_far, moved = u, here, "far"
    return far


def _weight(left: float) -> float:
    """Weight of the value at an end that was kept twice, from the ratio of the values at the other end."""
    return 1.0 - left if left < 1.0 else 0.5


def _is_finite(target: float) -> bool:
    try:
        return isfinite(target)
    except NOT_NUMBERS:  # text, an array, or an integer too large for a float
        raise UsageError(f"The inverse needs a number as its output, got {target!r:.40}.") from None


def _format_distinct(a: float, b: float) -> tuple[str, str]:
    """Two different numbers as texts with enough digits (six or more) to show that they differ."""
    digits = next((n for n in range(6, 17) if f"{a:.{n}g}" != f"{b:.{n}g}"), 17)
    return f"{a:.{digits}g}", f"{b:.{digits}g}"


@dataclass(frozen=True, eq=False)
class InverseSolver:
    """Monotone moves of one hysteresis, and the outputs that they reach."""

    hysteresis: Everett

    @cached_property
    def keyed(self) -> KeyedEverett:
        """F by keys, as in the loop."""
        return keyed(self.hysteresis)

    @cached_property
    def rounding(self) -> float:
        """Outputs that differ by less than this count as equal."""
        h = self.hysteresis
        return ROUNDING * abs(h.everett(h.upper, h.lower))

    @cached_property
    def steps(self) -> list[float]:
        """Inputs at which the output jumps, with constant output between them. Empty for a continuous hysteresis."""
        return np.asarray(getattr(self.hysteresis, "steps", ())).tolist()

    @cached_property
    def slack(self) -> float:
        """Tolerance for reaching a target: nonzero only for jumps, whose sums depend on their order."""
        return self.rounding if self.steps else 0.0

    @cached_property
    def kinks(self) -> list[float]:
        """Inputs at which the slope jumps; for relays, at which the output jumps."""
        return self.steps or np.asarray(getattr(self.hysteresis, "kinks", ())).tolist()

    @cached_property
    def nodes(self) -> Array:
        """Inputs at which monotonicity is checked."""
        even = np.linspace(self.hysteresis.lower, self.hysteresis.upper, GRID_POINTS + 1)
        return np.array(self.steps) if self.steps else np.union1d(even, self.kinks)

    @cached_property
    def monotone(self) -> bool:
        """Whether every move is monotone: F rises with α and falls with β at all nodes."""
        u = self.nodes
        if u.size > MAX_NODES:
            return False
        values = np.where(u[:, None] >= u, self.hysteresis.swept(u[:, None], u), 0.0)
        low = -self.rounding
        rises = np.where(u[1:, None] > u, np.diff(values, axis=0), 0.0)
        falls = np.where(u[:, None] > u[:-1], -np.diff(values, axis=1), 0.0)
        return bool(np.all(rises >= low) and np.all(falls >= low))

    def solve(self, stack: ExtremaStack, u: float, y: float, target: float) -> float:
        """Input of the least move from (u, y) that gives the target output. DataError if there is none."""
        if not _is_finite(target):
            raise DataError(f"Output {target:g} cannot be reached: it is not a finite number.")
        if abs(target - y) <= self.slack:
            return u
        up = target > y
        end = y
        for segment in self._branch_segments(stack, u, y, up):
            ends = self._bracket(segment, target, up)
            if ends is not None:
                return (
                    ends[1]
                    if self.steps
                    else bracketed_root(self._residual_function(segment, target, up), *ends)
                )
            end, u = segment.y_end, segment.end
        if abs(target - end) <= self.rounding:
            return u
        wanted, last = _format_distinct(target, end)
        raise DataError(f"Output {wanted} cannot be reached: the range ends at {last}.")

    # --- segments of a move ----------------------------------------------------------------------

    def _branch_segments(self, s: ExtremaStack, u: float, y: float, up: bool) -> Iterator[BranchSegment]:
        """Segments from the present input to saturation. Each ends at a remembered extremum, which it wipes out."""
        h, diagonal = self.hysteresis, s.centre == s.centre
        end = h.upper if up else h.lower
        k = s.top
        # The input reverses: the new branch starts at the present point.
        if u != s.U[k] and (u < s.U[k]) == up:
            edge = min(max(s.U[k], h.lower), h.upper)
            yield self._branch(u, y, u, edge, s.Y[k] if k > 1 or not diagonal else None, up)
            u = edge
            k -= 1
        while k > 2 or (k == 2 and not diagonal):
            yield self._branch(s.U[k], s.Y[k], u, s.U[k - 1], s.Y[k - 1], up)
            u = s.U[k - 1]
            k -= 2
        if not diagonal:
            if k == 1:
                yield self._branch(s.U[1], s.Y[1], u, end, None, up)
            return
        if k == 2:
            edge = min(max(s.U[1], h.lower), h.upper)
            yield self._branch(s.U[2], s.Y[2], u, edge, None, up)
            u = edge
        yield self._released(s, u, end)

    def _branch(
        self, u0: float, y0: float, start: float, end: float, y_end: float | None, up: bool
    ) -> BranchSegment:
        k, swept = self.keyed, self.hysteresis.swept
        between, place, params = k.between, k.place, k.params
        own = place(params, u0)[1 if up else 0]
        if up:
            segment = BranchSegment(
                start,
                end,
                0.0,
                lambda u: y0 + between(params, place(params, u)[0], own),
                lambda u: y0 + swept(u, u0),
            )
        else:
            segment = BranchSegment(
                start,
                end,
                0.0,
                lambda u: y0 - between(params, own, place(params, u)[1]),
                lambda u: y0 - swept(u0, u),
            )
        return segment._replace(y_end=segment.output(end) if y_end is None else y_end)

    def _released(self, s: ExtremaStack, start: float, end: float) -> BranchSegment:
        def outputs(u: ArrayLike) -> Array:
            return s.Y[0] + from_diagonal(self.hysteresis, s.centre, u)

        def output(u: float) -> float:
            return float(outputs([u])[0])

        return BranchSegment(start, end, output(end), output, outputs)

    # --- search within one segment -------------------------------------------------------------------

    def _residual_function(self, segment: BranchSegment, target: float, up: bool) -> Callable[[float], float]:
        sign, tiny = (1.0 if up else -1.0), 1e-3 * self.rounding

        def residual(u: float) -> float:
            far = sign * (segment.output(u) - target)
            # accept the target to rounding; do not search the last bit
            return 0.0 if -tiny < far < tiny else far

        return residual

    def _bracket(self, segment: BranchSegment, target: float, up: bool) -> tuple[float, float] | None:
        """Neighbouring kinks (or nodes) around the target. None if this segment does not reach it."""
        if not self.monotone:
            return self._first_crossing(segment, target, up)
        if (target - segment.y_end if up else segment.y_end - target) > self.slack:
            return None
        residual, inside = (
            self._residual_function(segment, target, up),
            self._nodes_inside(segment, self.kinks),
        )
        low, high = 0, len(inside)
        while low < high:
            middle = (low + high) // 2
            if residual(inside[middle]) >= -self.slack:
                high = middle
            else:
                low = middle + 1
        near = inside[low - 1] if low > 0 else segment.start
        return near, inside[low] if low < len(inside) else segment.end

    def _nodes_inside(self, segment: BranchSegment, places: list[float]) -> list[float]:
        """The given inputs (rising) strictly between the segment's ends, in the order in which the move passes them.

        For relays, a move away from a threshold switches immediately, so the first input is the next float.
        """
        if segment.end > segment.start:
            inside = places[bisect_right(places, segment.start) : bisect_left(places, segment.end)]
        else:
            inside = places[bisect_right(places, segment.end) : bisect_left(places, segment.start)][::-1]
        if self.steps and segment.start != segment.end:
            inside.insert(0, nextafter(segment.start, segment.end))
        return inside

    def _first_crossing(self, segment: BranchSegment, target: float, up: bool) -> tuple[float, float] | None:
        """Neighbouring nodes around the first crossing of the target. DataError if the output reverses before it."""
        u = np.array([segment.start, *self._nodes_inside(segment, self.nodes.tolist()), segment.end])
        progress = (segment.outputs(u) - target) * (1.0 if up else -1.0)
        there = np.flatnonzero(progress[1:] >= -self.slack)
        last = int(there[0]) if there.size else u.size - 2
        back = np.flatnonzero(np.diff(progress[: last + 2]) < -self.rounding)
        if back.size:
            more = np.flatnonzero(np.diff(progress[back[0] :]) >= 0)
            until = u[back[0] + more[0]] if more.size else u[-1]
            raise DataError(
                f"The output is not monotone on the way to {target:g}: while the input "
                f"{'rises' if up else 'falls'} from {u[back[0]]:g} to {until:g} the output reverses, "
                "so no inverse exists there."
            )
        return (float(u[last]), float(u[last + 1])) if there.size else None

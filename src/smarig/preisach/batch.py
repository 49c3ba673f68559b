"""Many at once: many inputs through one hysteresis, or one input through many hystereses.

The memory does not depend on the output. So along one input the extrema and wipe-outs are found once
(``memory_trace``), and a hysteresis adds only its numbers: F at all corners as arrays, then sums along the chains

    y_i = y_parent(i) + F(u_i, u_parent(i)) rising,      y_i = y_parent(i) − F(u_parent(i), u_i) falling.

Knows no fit; fits of many parameter sets to one run are what it is for.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core.errors import UsageError
from smarig.preisach.everett import Everett, from_diagonal
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.kernel import ExtremaStack, python_loop
from smarig.preisach.operator import Initial, Preisach, input_array

Array = NDArray[np.float64]
Index = NDArray[np.intp]
NO_PARENT = -1


@dataclass(frozen=True, eq=False)
class MemoryTrace:
    """Corners of the memory along an input: points ``u`` (m,) and the extremum each hangs on, ``parent`` (m,).

    Point 0 is negative saturation; then come the extrema of the initial state and its present point; the
    samples are the points from ``first`` on. A point without a parent (−1) is negative saturation itself,
    or has left the diagonal state B_ℓ, ℓ = ``centre``, in one move.
    """

    u: Array
    parent: Index
    first: int
    centre: float

    @property
    def alpha(self) -> Array:
        """Upper input of each point's corner."""
        return np.maximum(self.u, self.u[self.parent])

    @property
    def beta(self) -> Array:
        """Lower input of each point's corner."""
        return np.minimum(self.u, self.u[self.parent])

    @property
    def sign(self) -> Array:
        """+1 where the point was reached rising from its parent, −1 falling."""
        return np.where(self.u >= self.u[self.parent], 1.0, -1.0)

    @cached_property
    def _jumps(self) -> list[Index]:
        """Ancestors 1, 2, 4, … generations back of the points that are parents; the last index is nobody."""
        knots = self._knots
        back = np.searchsorted(knots, self.parent[knots])
        back[self.parent[knots] == NO_PARENT] = knots.size
        jumps, back = [], np.append(back, knots.size)
        while (back < knots.size).any():
            jumps.append(back)
            back = back[back]
        return jumps

    @cached_property
    def _knots(self) -> Index:
        return np.unique(np.append(self.parent[self.parent != NO_PARENT], 0))

    def outputs(self, hysteresis: Everett) -> Array:
        """Outputs of one hysteresis at the samples, (n,)."""
        moved = self.u != self.u[self.parent]  # back in u₋ all relays are off, those of α = β = u₋ too
        change = np.where(moved, self.sign * hysteresis.swept(self.alpha, self.beta), 0.0)
        alone = self.parent == NO_PARENT
        change[0] = hysteresis.y_lower
        alone[0] = False
        if alone.any():
            at_rest = hysteresis.y_lower + hysteresis.fall_from_diagonal(self.centre, hysteresis.lower)
            change[alone] = at_rest + from_diagonal(hysteresis, self.centre, self.u[alone])
        sums = np.append(change[self._knots], 0.0)
        for back in self._jumps:
            sums = sums + sums[back]
        own = self.parent[self.first :]
        at = np.where(own == NO_PARENT, sums.size - 1, np.searchsorted(self._knots, own))
        return change[self.first :] + sums[at]


def memory_trace(inputs: ArrayLike, lower: float, upper: float, initial: Initial = "negative") -> MemoryTrace:
    """Follow the memory of a hysteresis over [lower, upper] along inputs (n,) from an initial state."""
    state = Preisach(RelayMeasure.zero(lower, upper), initial, compiled=False).state
    u = np.clip(input_array(inputs), lower, upper)
    chain = [lower, *state.extrema[1:], state.u]
    present, path = len(chain) - 1, np.concatenate([chain, u])
    parent = [NO_PARENT, *range(present), *[NO_PARENT] * u.size]
    stack = ExtremaStack.from_state(state, lambda point: (point, point))
    stack.K[1:] = range(stack.top)
    if state.diagonal:
        parent[1] = NO_PARENT
        saturated = np.flatnonzero((u == lower) | (u == upper))[:1] + present + 1
        end = int(saturated[0]) if saturated.size else path.size
        _find_parents(parent, path, present, end, stack)
        present, stack = end, ExtremaStack(np.inf, [lower], [0], [0.0], np.nan)
        parent[end : end + 1] = [0] * len(parent[end : end + 1])
    _find_parents(parent, path, present, path.size, stack)
    return MemoryTrace(
        path, _with_unmoved_points(np.array(parent, dtype=np.intp), path), len(chain), state.extrema[0]
    )


def _find_parents(parent: list[int], path: Array, begin: int, end: int, stack: ExtremaStack) -> None:
    """Run the loop over points begin + 1 … end − 1, with point numbers for keys and no outputs."""
    u, numbers = path[begin:end].tolist(), list(range(begin, end))
    if len(u) > 1:
        stack.reserve(len(u))
        nothing = [0.0] * len(u)
        memory = stack.centre, stack.U, stack.K, stack.Y, stack.top
        python_loop(_record_parent)(parent, u, numbers, numbers, nothing, nothing, *memory)


def _record_parent(parent: list[int], a: int, b: int) -> float:
    """In the place of an Everett function: of two points, the later one hangs on the earlier."""
    parent[max(a, b)] = min(a, b)
    return 0.0


def _with_unmoved_points(parent: Index, path: Array) -> Index:
    """Points the loop asked no F for: standing still, they hang where they hung; in u₋ they hang on point 0."""
    moved = np.append(True, path[1:] != path[:-1])
    parent = parent[np.maximum.accumulate(np.where(moved, np.arange(path.size), 0))]
    return np.where((parent == NO_PARENT) & (path == path[0]) & (np.arange(path.size) > 0), 0, parent)


def simulate_many(
    hystereses: Everett | Sequence[Everett], inputs: ArrayLike, initial: Initial = "negative"
) -> Array:
    """Outputs (k, n): of k hystereses along one input (n,), or of one hysteresis along k inputs (k, n).

    The same numbers as ``Preisach(h, initial).simulate(u)`` each, to rounding. A State as the initial one
    gives its extrema; outputs at them are each hysteresis's own. UsageError for any other shapes.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import surface
    >>> simulate_many([surface("one_c"), surface("one_e")], [90.0, 40.0, 60.0]).shape
    (2, 3)
    >>> simulate_many(surface("one_c"), [[90.0, 40.0], [50.0, 20.0], [0.0, 174.1]]).shape
    (3, 2)
    """
    u = np.asarray(inputs, dtype=float)
    if not isinstance(hystereses, Sequence):
        if u.ndim != 2:
            raise UsageError(f"One hysteresis takes inputs of shape (k, n), got {u.shape}.")
        operator = Preisach(hystereses)
        return np.array([operator.simulate(row, initial) for row in u]).reshape(u.shape)
    if u.ndim != 1:
        raise UsageError(f"Several hystereses share one input of shape (n,), got {u.shape}.")
    outputs = np.empty((len(hystereses), u.size))
    traces: dict[tuple[float, float], MemoryTrace] = {}
    for k, h in enumerate(hystereses):
        ends = h.lower, h.upper
        if ends not in traces:
            traces[ends] = memory_trace(u, *ends, initial)
        outputs[k] = traces[ends].outputs(h)
    return outputs

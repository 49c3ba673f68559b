"""The Preisach operator, represented by its remembered extrema: no relay grid, no integration, exact to rounding.

The boundary B of the Preisach plane is a staircase whose corners are the remembered extrema (thesis §3.1, §6.1). The
operator keeps them on a stack, with the output at each. A monotone move costs one evaluation of the Everett function F,
and wiping-out removes elements from the stack (§3.3.1). The amortised cost of a move is O(1).

    rising from a minimum m:  y = y(m) + F(u, m)        falling from a maximum M:  y = y(M) − F(M, u)

The loop itself is in ``kernel.py``. Inputs beyond the saturation range [u₋, u₊] are saturated.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError, UsageError
from smarig.preisach import compiled as fast
from smarig.preisach.checked_input import (
    NAN_INPUT,
    input_array,
    input_number,
    input_rows,
    not_a_number,
    vector,
)
from smarig.preisach.everett import Everett, from_diagonal
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.inverse import InverseSolver
from smarig.preisach.kernel import ExtremaStack, KernelInput, follow, keyed, python_loop
from smarig.preisach.state import State as State

Initial = Literal["negative", "positive", "anhysteretic"] | State


class Preisach:
    """Preisach operator y = Γ[u] for a FOD surface, a FOD table or a measure of relays.

    ``compiled``: None compiles the loop with numba (extra ``fast``) if numba is installed and the input, or the
    announced number of further ``samples``, is long enough. True always compiles, False never. The loop is the same.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    >>> wire = Preisach.from_surface(thesis_surface("one_c"))
    >>> y = wire.simulate([80.0, 40.0, 60.0, 40.0])       # a minor loop closes: wiping-out
    >>> bool(y[1] == y[3])
    True
    """

    u: float
    y: float

    def __init__(
        self,
        hysteresis: Everett,
        initial: Initial = "negative",
        *,
        compiled: bool | None = None,
        samples: int = 0,
    ) -> None:
        if not hasattr(hysteresis, "everett"):
            of_model = " Call operator() of a model." if hasattr(hysteresis, "operator") else ""
            raise UsageError(
                "A Preisach operator needs a hysteresis (a surface, a table or a measure of relays), "
                f"got {hysteresis!r:.40}.{of_model}"
            )
        self.hysteresis = hysteresis
        self._keyed = keyed(hysteresis)
        self._params, self._between = self._keyed.params, self._keyed.between
        self._place_inside = self._keyed.place
        self._run = python_loop(self._between)
        self._compiled, self._samples = compiled, samples
        self._lower, self._upper = hysteresis.lower, hysteresis.upper
        self.reset(initial)

    @classmethod
    def from_surface(cls, surface: FodSurface) -> "Preisach":
        """Operator of an analytic FOD surface (5.5)."""
        return cls(surface)

    @classmethod
    def from_table(cls, alpha: ArrayLike, beta: ArrayLike, y: ArrayLike) -> "Preisach":
        """Operator of a FOD table y[i, j] = y(α_i, β_j), NaN where β_j > α_i. Bilinear, exact at the nodes."""
        return cls(FodTable.from_arrays(alpha, beta, y))

    @classmethod
    def from_measure(cls, alpha: ArrayLike, beta: ArrayLike, mass: ArrayLike) -> "Preisach":
        """Operator of relays (α_k, β_k) with signed mass: y = Σ mass_k γ_k, γ = ±1."""
        return cls(RelayMeasure.from_arrays(alpha, beta, mass))

    # --- state -----------------------------------------------------------------------------------

    @property
    def state(self) -> State:
        """A frozen copy of the memory."""
        s = self._stack
        oldest = 2 if self._diagonal else 1
        base, y_base = ((s.centre,), (s.Y[0],)) if self._diagonal else ((), ())
        extrema, outputs = s.U[oldest : s.top + 1], s.Y[oldest : s.top + 1]
        return State((*base, *extrema), (*y_base, *outputs), self.u, self.y, self._diagonal)

    @property
    def _diagonal(self) -> bool:
        return not math.isnan(self._stack.centre)

    def reset(self, initial: Initial = "negative") -> float:
        """Go to "negative" or "positive" saturation, the "anhysteretic" state (B*), or a State. Returns y.

        DataError if a State is not nested or lies outside the range of this hysteresis.
        """
        if isinstance(initial, State):
            self._restore(initial)
        elif initial == "anhysteretic":
            self.go_to_diagonal(0.0)
        elif initial in ("negative", "positive"):
            self._saturate(self._lower if initial == "negative" else self._upper)
        else:
            raise UsageError(
                f"Initial state '{initial}' must be negative, positive, anhysteretic or a State."
            )
        return self.y

    def go_to_diagonal(self, centre: float) -> float:
        """Go to B_ℓ = {α = 2ℓ − β} (§8.3), ℓ = centre clipped to the range. Returns ψ(ℓ) = r(B_ℓ)."""
        h = self.hysteresis
        centre = float(min(max(input_number(centre), self._lower), self._upper))
        # F alone does not give the output of B_ℓ. ψ is therefore computed from below: a fall from B_ℓ to u₋
        # switches off exactly the relays that are up in B_ℓ.
        y = h.y_lower + h.fall_from_diagonal(centre, self._lower)
        self._set_state(State((centre,), (y,), centre, y, True))
        return y

    def _saturate(self, u: float) -> float:
        h, k = self.hysteresis, self._keyed
        y = h.y_lower
        if u > self._lower:
            (a, _), (_, b) = k.place(k.params, u), k.place(k.params, self._lower)
            y += k.between(k.params, a, b)
        self._set_state(State((self._lower,), (h.y_lower,), u, y))
        return y

    def _restore(self, state: State) -> None:
        """Restore a given state after checking it."""
        state.check()
        inside = all(self._lower <= u <= self._upper for u in (*state.extrema, state.u))
        if not inside or (state.extrema[0] != self._lower and not state.diagonal):
            raise DataError(
                f"This Preisach state spans {min(*state.extrema, state.u):g} to "
                f"{max(*state.extrema, state.u):g} and does not belong to a hysteresis over "
                f"[{self._lower:g}, {self._upper:g}]."
            )
        self._set_state(state.reduced())

    def _set_state(self, state: State) -> None:
        self._stack = ExtremaStack.from_state(state, self._place)
        self._set_point(state.u, state.y)

    def _set_point(self, u: float, y: float) -> None:
        self.u, self.y = u, y
        self._a, self._b = self._place(u)

    def _place(self, u: float) -> tuple[Any, Any]:
        """Keys of an input. The mirror image of an extremum may lie outside the range."""
        return self._keyed.place(self._keyed.params, min(max(u, self._lower), self._upper))

    # --- motion ----------------------------------------------------------------------------------

    def step(self, u: float) -> float:
        """Move monotonically from the present input to u. Returns the output there."""
        try:
            inside = self._lower < u < self._upper
        except NOT_NUMBERS:
            raise not_a_number(u) from None
        if not inside:
            if u != u:
                raise DataError(NAN_INPUT)
            u = self._lower if u <= self._lower else self._upper
            return self.y if u == self.u else self._saturate(u)
        a, b = self._place_inside(self._params, u)
        s, now = self._stack, self.u
        U, top = s.U, s.top
        # along the present branch, which most steps do not leave, as in the loop
        if U[top] <= now < u < U[top - 1]:
            self.y = s.Y[top] + self._between(self._params, a, s.K[top])
        elif U[top] >= now > u > U[top - 1]:
            self.y = s.Y[top] - self._between(self._params, s.K[top], b)
        else:
            s.top, self.y = self._move_result(u, a, b)
        self.u, self._a, self._b = u, a, b
        return self.y

    def _move_result(self, u: float, a: Any, b: Any) -> tuple[int, float]:
        """The stack's new top and the output after a move to u with keys a and b, inside the range."""
        s, now = self._stack, self.u
        y, released = [self.y, self.y], None
        if s.top + 2 > len(s.U):
            s.reserve(64)
        if s.centre == s.centre and not min(s.U[0], s.U[1]) < u < max(s.U[0], s.U[1]):
            released = (0.0, s.Y[0] + float(from_diagonal(self.hysteresis, s.centre, [u])[0]))
        us, as_, bs = (now, u), (self._a, a), (self._b, b)
        top = self._run(self._params, us, as_, bs, y, released, s.centre, s.U, s.K, s.Y, s.top)
        return top, y[1]

    def peek(self, u: float) -> float:
        """The output that step(u) would give, without changing the memory."""
        try:
            u = min(max(u, self._lower), self._upper)
        except NOT_NUMBERS:
            raise not_a_number(u) from None
        if u != u or u in (self._lower, self._upper):
            saved = self._stack, self.u, self.y
            y = self.step(u)
            self._stack = saved[0]
            self._set_point(*saved[1:])
            return y
        s = self._stack
        below = s.U[0], s.U[1]  # a move overwrites only these; the elements it removes stay in the lists
        _, y = self._move_result(u, *self._place(u))
        s.U[0], s.U[1] = below
        return y

    def simulate(self, u: Sequence[float] | ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs for inputs u from an initial state. Moves between samples are monotone.

        Inputs of shape (n,) give n outputs, and the memory is then that after the last of them. A batch of inputs,
        (n_inputs, n_samples), gives outputs of its shape: each row starts anew from the initial state, in which the
        memory stays. Rows run compiled, and in threads, where that takes less time; the numbers are the same.
        """
        inputs = input_rows(u)
        self.reset(initial)
        return self._follow_batch(inputs) if inputs.ndim == 2 else self._follow(inputs)

    def follow(self, u: Sequence[float] | ArrayLike) -> Array:
        """Outputs for inputs u, shape (n,), from the present state: many steps in one call."""
        return self._follow(input_array(u))

    def follow_with_states(self, u: ArrayLike, at: Sequence[int]) -> tuple[Array, tuple[State, ...]]:
        """Outputs (m,) and memories at the indices ``at`` (m,), ascending, of inputs u (n,), from the present state."""
        inputs = input_array(u)
        # from a diagonal state, all moves are integrated at once
        released = self._released(np.clip(inputs, self._lower, self._upper)) if self._diagonal else inputs
        begin, path, outputs, states = 0, inputs.tolist(), [], []
        for end in (np.asarray(at) + 1).tolist():
            if self._diagonal:
                self._follow(inputs[begin:end], released[begin:end])
            else:
                for v in path[begin:end]:
                    self.step(v)
            begin = end
            outputs.append(self.y)
            states.append(self.state)
        return np.array(outputs), tuple(states)

    def _follow(self, inputs: Array, released: Array | None = None) -> Array:
        y = np.empty(inputs.size)
        done = self._leave_diagonal(inputs, y, released) if self._diagonal else 0
        self._run_loop(inputs[done:], y[done:])
        return y

    def _follow_batch(self, inputs: Array) -> Array:
        """Outputs (n, m) of inputs (n, m), each row from the present state, which stays."""
        y, state = np.empty(inputs.shape), self.state
        compiled = fast.worth_compiling(self._keyed, max(inputs.size, self._samples), self._compiled)
        if compiled and inputs.size and not self._diagonal:
            given = KernelInput(self.u, self.y, inputs, self._lower, self._upper)
            fast.follow_batch(self._keyed, self._stack, given, y)
            return y
        for row, outputs in zip(inputs, y):
            outputs[:] = self._follow(row)
            self.reset(state)
        return y

    def _leave_diagonal(self, inputs: Array, y: Array, released: Array | None) -> int:
        """Follow the inputs up to the first that saturates and so ends a diagonal state. Returns their number."""
        saturated = np.flatnonzero((inputs <= self._lower) | (inputs >= self._upper))[:1]
        end = int(saturated[0]) if saturated.size else inputs.size
        own = self._released(inputs[:end]) if released is None else released[:end]
        self._run_loop(inputs[:end], y[:end], own)
        if end < inputs.size:
            y[end] = self._saturate(self._lower if inputs[end] <= self._lower else self._upper)
        return end + 1

    def _released(self, inputs: Array) -> Array:
        """Outputs of one move from B_ℓ to each input further from ℓ than all before it; NaN elsewhere."""
        s = self._stack
        away = np.abs(np.concatenate([[s.U[0]], inputs]) - s.centre)
        furthest = np.maximum.accumulate(away)
        # include inputs within rounding of the limit; the loop makes the final decision by mirror images
        wanted = np.flatnonzero(away[1:] >= furthest[:-1] - 1e-12 * (self._upper - self._lower))
        outputs = np.full(inputs.size, np.nan)
        if wanted.size:
            outputs[wanted] = s.Y[0] + from_diagonal(self.hysteresis, s.centre, inputs[wanted])
        return outputs

    def _run_loop(self, inputs: Array, y: Array, released: Array | None = None) -> None:
        if inputs.size:
            kernel_input = KernelInput(self.u, self.y, inputs, self._lower, self._upper, released)
            loop = (
                fast.follow
                if fast.worth_compiling(self._keyed, max(inputs.size, self._samples), self._compiled)
                else follow
            )
            loop(self._keyed, self._stack, kernel_input, y)
            self._set_point(min(max(float(inputs[-1]), self._lower), self._upper), float(y[-1]))

    # --- inverse ---------------------------------------------------------------------------------

    def inverse(self, y_target: float, state: State | None = None) -> float:
        """The input that reaches y_target from the state (default: the present one) by the least monotone move.

        The operator's memory does not change. See ``inverse.py``.
        """
        if state is None:
            return self._inverse_solver.solve(self._stack, self.u, self.y, y_target)
        here = self._stack, self.u, self.y
        try:
            self.reset(state)
            return self._inverse_solver.solve(self._stack, self.u, self.y, y_target)
        finally:
            self._stack = here[0]
            self._set_point(*here[1:])

    def inverse_trajectory(self, y: Sequence[float] | ArrayLike) -> Array:
        """Inputs (n,) that bring the output to each y in turn, each by the least monotone move.

        The memory changes, as with ``follow``. If an output cannot be reached, a DataError names the sample, and the
        memory is that before the sample. UsageError for another shape.
        """
        targets = vector(y, "The inverse", "output")
        u = np.empty(targets.size)
        for k, target in enumerate(targets.tolist()):
            try:
                u[k] = self.inverse(target)
            except DataError as error:
                raise DataError(f"Sample {k}: {error}") from None
            self.step(u[k].item())
        return u

    @cached_property
    def _inverse_solver(self) -> InverseSolver:
        return InverseSolver(self.hysteresis)

    def __repr__(self) -> str:
        h = self.hysteresis
        return (
            f"Preisach({type(h).__name__}, range [{h.lower:g}, {h.upper:g}], "
            f"u={self.u:g}, y={self.y:g}, {self._stack.top - 1} remembered extrema)"
        )

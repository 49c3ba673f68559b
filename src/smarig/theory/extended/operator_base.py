"""Common base of the extensions of §3.5: the classical memory with its corners, and stepwise simulation."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach import Everett, Initial, Preisach, State, input_rows


class SteppedOperator(Protocol):
    """The common methods of all operators here, each with its own kind of state; ``reset`` and ``step`` return y."""

    def reset(self, initial: Any) -> float: ...
    def step(self, u: float) -> float: ...


class ExtendedOperator:
    """An extension with the memory of Γ, the Preisach operator of ``hysteresis``, and another read-out.

    The base class is Γ itself. An extension overrides ``_read_out`` or ``step``.
    """

    def __init__(self, hysteresis: Everett, initial: Initial = "negative") -> None:
        self.hysteresis = hysteresis
        self._memory = Preisach(hysteresis)
        self.reset(initial)

    @property
    def state(self) -> State:
        """The memory of Γ, including the outputs of Γ."""
        return self._memory.state

    def reset(self, initial: Initial = "negative") -> float:
        """Go to saturation or to a state of Γ. Returns y."""
        return self._read_out(self._memory.reset(initial))

    def step(self, u: float) -> float:
        """Move monotonically to u. Returns y."""
        return self._read_out(self._memory.step(u))

    def simulate(self, u: ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs for inputs u (n,), or (n_inputs, n_samples) of a batch."""
        return simulate_steps(self, u, initial)

    def _read_out(self, y: float) -> float:
        """The output, given the output y of Γ."""
        return y


def simulate_steps(model: SteppedOperator, u: Sequence[float] | ArrayLike, initial: Any) -> Array:
    """Outputs (n,) for inputs u (n,), with monotone moves between samples, from an initial state; rows of a batch each.

    Afterwards the memory is that of the last sample.
    """
    inputs = input_rows(u)
    if inputs.ndim == 2:
        rows = [simulate_steps(model, row, initial) for row in inputs]
        return np.array(rows).reshape(inputs.shape)
    model.reset(initial)
    return np.fromiter((model.step(v) for v in inputs.tolist()), dtype=float, count=inputs.size)


def corners(state: State) -> list[tuple[float, float]]:
    """(M₁, u₋), (M₁, m₁), (M₂, m₁), …: the corners (α, β) of the staircase, oldest first; see ``reduced_memory``."""
    _check_steps(state)
    e = state.extrema
    return [(e[k], e[k - 1]) if k % 2 else (e[k - 1], e[k]) for k in range(1, len(e))]


def reduced_memory(state: State) -> tuple[float, ...]:
    """(u₋, M₁, m₁, …, u): remembered extrema, oldest first, and the present input if it is not one of them.

    It needs a memory that started in saturation, because a diagonal boundary B_ℓ has no steps (UsageError).
    """
    _check_steps(state)
    e = state.extrema
    return e if e[-1] == state.u else (*e, state.u)


def _check_steps(state: State) -> None:
    if state.diagonal:
        raise UsageError(
            "This extension needs a staircase memory. Drive to saturation before using it "
            "(the anhysteretic state has a slanted boundary)."
        )

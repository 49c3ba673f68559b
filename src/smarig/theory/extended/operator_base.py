"""What the extensions of §3.5 share: the classical memory with its corners, and one way to drive a model."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import UsageError
from smarig.preisach import Everett, Initial, Preisach, State, input_array

Array = NDArray[np.float64]


class SteppedOperator(Protocol):
    """What every operator here can do, each from states of its own; ``reset`` and ``step`` return the output."""

    def reset(self, initial: Any) -> float: ...
    def step(self, u: float) -> float: ...


class ExtendedOperator:
    """An extension that remembers what Γ does, the Preisach operator of ``hysteresis``, and reads it otherwise.

    As it stands it is Γ itself: an extension gives its own ``_read_out`` or ``step``.
    """

    def __init__(self, hysteresis: Everett, initial: Initial = "negative") -> None:
        self.hysteresis = hysteresis
        self._memory = Preisach(hysteresis)
        self.reset(initial)

    @property
    def state(self) -> State:
        """The memory of Γ, with the outputs of Γ in it."""
        return self._memory.state

    def reset(self, initial: Initial = "negative") -> float:
        """Go to saturation or to a state of Γ; returns y."""
        return self._read_out(self._memory.reset(initial))

    def step(self, u: float) -> float:
        """Move monotonically to u; returns y."""
        return self._read_out(self._memory.step(u))

    def simulate(self, u: ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs (n,) for inputs u (n,)."""
        return simulate_steps(self, u, initial)

    def _read_out(self, y: float) -> float:
        """The output, when that of Γ is y."""
        return y


def simulate_steps(model: SteppedOperator, u: Sequence[float] | ArrayLike, initial: Any) -> Array:
    """Outputs (n,) for inputs u (n,), moves monotone between samples, from an initial state."""
    inputs = input_array(u)
    model.reset(initial)
    return np.fromiter((model.step(v) for v in inputs.tolist()), dtype=float, count=inputs.size)


def corners(state: State) -> list[tuple[float, float]]:
    """(M₁, u₋), (M₁, m₁), (M₂, m₁), …: the corners (α, β) of the staircase, oldest first; see ``reduced_memory``."""
    _check_steps(state)
    e = state.extrema
    return [(e[k], e[k - 1]) if k % 2 else (e[k - 1], e[k]) for k in range(1, len(e))]


def reduced_memory(state: State) -> tuple[float, ...]:
    """(u₋, M₁, m₁, …, u): remembered extrema, oldest first, and the present input where it is none of them.

    Only for a memory that began in saturation: a diagonal boundary B_ℓ has no steps (UsageError).
    """
    _check_steps(state)
    e = state.extrema
    return e if e[-1] == state.u else (*e, state.u)


def _check_steps(state: State) -> None:
    if state.diagonal:
        raise UsageError(
            "This extension needs a memory of steps; drive to saturation before using it "
            "(the anhysteretic state has a slanted boundary)."
        )

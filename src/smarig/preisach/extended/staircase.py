"""What the extensions of §3.5 share: the corners of the Preisach staircase, and one way to drive a model.

Knows no output law.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.errors import UsageError
from smarig.preisach.operator import Initial, State


class Stepped(Protocol):
    """What every operator here can do; ``reset`` and ``step`` return the output."""

    def reset(self, initial: Initial = "negative") -> float: ...
    def step(self, u: float) -> float: ...


def drive(model: Stepped, u: Sequence[float] | ArrayLike, initial: Initial) -> NDArray[np.float64]:
    """Outputs (n,) for inputs u (n,), moves monotone between samples, from an initial state."""
    inputs = np.asarray(u, dtype=float)
    if inputs.ndim != 1:
        raise UsageError(f"simulate takes a one-dimensional input, got shape {inputs.shape}.")
    model.reset(initial)
    return np.fromiter((model.step(v) for v in inputs.tolist()), dtype=float, count=inputs.size)


def corners(state: State) -> list[tuple[float, float]]:
    """(M₁, u₋), (M₁, m₁), (M₂, m₁), …: the corners (α, β) of the staircase, oldest first.

    Only for a memory that began in saturation: a diagonal boundary B_ℓ has no corners (UsageError).
    """
    if state.diagonal:
        raise UsageError(
            "This extension needs a memory of steps; drive to saturation before using it "
            "(the anhysteretic state has a slanted boundary)."
        )
    e = state.extrema
    return [(e[k], e[k - 1]) if k % 2 else (e[k - 1], e[k]) for k in range(1, len(e))]

"""A fully reversible component: a function of the present input, added to the output.

    y(t) = Γ[u](t) + r(u(t))

(Mayergoyz, ch. 2: r = ½(y⁺ + y⁻) is the fully reversible part of the non-linear model; thesis §3.5).
r has no memory, so wiping-out and congruency survive; it may go on where Γ is saturated. A hysteresis
with mass on α = β holds a reversible part already (theory.md §1): r is what goes beyond it. Knows no data.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.errors import DataError
from smarig.preisach.everett import Everett
from smarig.preisach.extended.staircase import drive
from smarig.preisach.operator import Initial, Preisach, State

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reversible:
    """r(u): values (n,) in output units at increasing inputs (n,), linear between, constant beyond."""

    nodes: Array
    values: Array

    def __post_init__(self) -> None:
        if self.nodes.ndim != 1 or self.nodes.shape != self.values.shape or self.nodes.size == 0:
            raise DataError("A reversible part needs as many values as inputs, and at least one.")
        if np.any(np.diff(self.nodes) <= 0) or not np.isfinite(self.values).all():
            raise DataError("A reversible part needs strictly increasing inputs and finite values.")

    def at(self, u: ArrayLike) -> Array:
        """r(u), broadcasts."""
        return np.interp(np.asarray(u, dtype=float), self.nodes, self.values)


class ReversiblePreisach:
    """Γ[u] + r(u); see the module.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> linear = Reversible(np.array([0.0, 200.0]), np.array([0.0, 1.0]))
    >>> float(ReversiblePreisach(surface("one_c"), linear).simulate([200.0])[0])   # saturation 12.54, and r
    13.54
    """

    def __init__(self, hysteresis: Everett, part: Reversible, initial: Initial = "negative") -> None:
        self.hysteresis, self.part = hysteresis, part
        self._memory = Preisach(hysteresis)
        self.reset(initial)

    @property
    def state(self) -> State:
        """The classical memory."""
        return self._memory.state

    def reset(self, initial: Initial = "negative") -> float:
        """Go to a state; returns y."""
        y = self._memory.reset(initial)
        return y + float(self.part.at(self._memory.u))

    def step(self, u: float) -> float:
        """Move monotonically to u; returns y. Γ saturates, r does not."""
        return self._memory.step(u) + float(self.part.at(u))

    def simulate(self, u: ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs (n,) for inputs u (n,)."""
        return drive(self, u, initial)

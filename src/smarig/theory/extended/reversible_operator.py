"""A fully reversible component: a function of the present input, added to the output.

    y(t) = Γ[u](t) + r(u(t))

(Mayergoyz, ch. 2: r = ½(y⁺ + y⁻) is the fully reversible part of the nonlinear model; thesis §3.5).
r has no memory, so wiping-out and congruency still hold. It may change where Γ is saturated. A hysteresis with mass on
α = β already contains a reversible part (theory.md §1); r is added to it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError
from smarig.preisach import Everett, Initial
from smarig.theory.extended.operator_base import ExtendedOperator


@dataclass(frozen=True, eq=False)
class ReversiblePart:
    """r(u): values (n,) in output units at increasing inputs (n,), linear between, constant beyond."""

    nodes: Array
    values: Array

    def __post_init__(self) -> None:
        try:
            nodes, values = np.asarray(self.nodes, dtype=float), np.asarray(self.values, dtype=float)
        except NOT_NUMBERS:
            raise DataError("A reversible part needs numbers as inputs and values.") from None
        if nodes.ndim != 1 or nodes.shape != values.shape or nodes.size == 0:
            raise DataError("A reversible part needs the same number of values and inputs, at least one.")
        if np.any(np.diff(nodes) <= 0) or not (np.isfinite(nodes).all() and np.isfinite(values).all()):
            raise DataError("A reversible part needs strictly increasing, finite inputs and finite values.")
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "values", values)

    def at(self, u: ArrayLike) -> Array:
        """r(u). Broadcasts."""
        return np.interp(np.asarray(u, dtype=float), self.nodes, self.values)


class ReversiblePreisach(ExtendedOperator):
    """Γ[u] + r(u); see the module.

    >>> from smarig.preisach import thesis_surface
    >>> linear = ReversiblePart(np.array([0.0, 200.0]), np.array([0.0, 1.0]))
    >>> float(ReversiblePreisach(thesis_surface("one_c"), linear).simulate([200.0])[0])   # saturation 12.54, plus r
    13.54
    """

    def __init__(self, hysteresis: Everett, part: ReversiblePart, initial: Initial = "negative") -> None:
        self.part = part
        super().__init__(hysteresis, initial)

    def step(self, u: float) -> float:
        """Move monotonically to u. Returns y. Γ saturates, r does not."""
        return self._memory.step(u) + float(self.part.at(u))

    def _read_out(self, y: float) -> float:
        return y + float(self.part.at(self._memory.u))

"""The nonlinear (input-dependent) Preisach model: comparable minor loops have only equal vertical chords.

    y(t) = ∬ μ(α, β, u(t)) γ_αβ u dα dβ  =  Γ[u](t) + Σ_k (−1)^{k+1} Q(α_k, β_k, u(t))

(Mayergoyz, Mathematical Models of Hysteresis, ch. 2; thesis §3.5). Γ is the classical operator of the
first-order curves, (α_k, β_k) the corners of the staircase, and the excess

    Q(α, β, u) = P(α, β, u) − [F(α, β) − F(α, u) − F(u, β)],     P(α, β, u) = y_α(u) − y_αβ(u)

is the amount by which a second-order curve (saturation → α → β → u) lies below the congruent one. Q ≡ 0 gives the
classical model bit for bit. Wiping-out holds; congruency does not.
"""

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import NOT_NUMBERS, Array, DataError
from smarig.preisach import Everett, Initial
from smarig.theory.extended.operator_base import ExtendedOperator, corners


@dataclass(frozen=True, eq=False)
class SecondOrderExcess:
    """Q on a partition ``nodes`` (n,), trilinear between them; ``values`` (n, n, n) in output units.

    Q vanishes at u = α, at u = β and, because the base contains the first-order curves, at β = u₋. The tensor is
    totally antisymmetric in (α, β, u), so its interpolant also vanishes on the two slanted planes.
    """

    nodes: Array
    values: Array

    def __post_init__(self) -> None:
        nodes, values = _checked_tensor(self.nodes, self.values)
        if not np.isfinite(values).all():
            raise DataError("An excess contains a value that is not finite.")
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "values", values)

    @classmethod
    def from_nodes(cls, nodes: ArrayLike, q: ArrayLike) -> "SecondOrderExcess":
        """The excess from q[i, j, k] = Q(u_i, u_j, u_k), used for 0 < j < k < i only. DataError if one is missing."""
        u, table = _checked_tensor(nodes, q)
        inner_values = np.where(second_order_mask(u.size), table, 0.0)
        if not np.isfinite(inner_values).all():
            alpha, beta, at = u[np.argwhere(~np.isfinite(inner_values))[0]]
            raise DataError(
                f"No second-order value at α = {alpha:g}, β = {beta:g}, u = {at:g}. Measure that curve too."
            )
        return cls(u, _antisymmetric(inner_values))

    def at(self, alpha: float, beta: float, u: float) -> float:
        """Q(α, β, u), scalar; zero unless β < u < α."""
        if not beta < u < alpha:
            return 0.0
        value = self.values
        for x in (alpha, beta, u):
            k = bisect_right(self.nodes, x, 1, self.nodes.size - 1) - 1
            t = (x - self.nodes[k]) / (self.nodes[k + 1] - self.nodes[k])
            value = value[k] + t * (value[k + 1] - value[k])
        return float(value)


def _checked_tensor(nodes: ArrayLike, values: ArrayLike) -> tuple[Array, Array]:
    """A partition (n,) and a tensor (n, n, n) on it, as floats. DataError for anything else."""
    try:
        u, table = np.asarray(nodes, dtype=float), np.asarray(values, dtype=float)
    except NOT_NUMBERS:
        raise DataError("An excess needs numbers as inputs and values.") from None
    rising = u.ndim == 1 and u.size > 1 and np.isfinite(u).all() and np.all(np.diff(u) > 0)
    if not rising or table.shape != (u.size,) * 3:
        raise DataError(
            f"An excess of shape {table.shape} does not fit a partition of shape {u.shape}. "
            "Give n strictly increasing, finite inputs and an array (n, n, n)."
        )
    return u, table


def check_excess_range(excess: SecondOrderExcess, hysteresis: Everett) -> None:
    """Raise DataError if the excess does not cover the whole range of the hysteresis."""
    first, last = excess.nodes[0], excess.nodes[-1]
    if first > hysteresis.lower or last < hysteresis.upper:
        raise DataError(
            f"The excess covers only [{first:g}, {last:g}]; the range of the hysteresis is "
            f"[{hysteresis.lower:g}, {hysteresis.upper:g}]."
        )


def second_order_mask(n: int) -> NDArray[np.bool_]:
    """Where a second-order curve adds information: index triples (α, β, u) with 0 < j < k < i, shape (n, n, n)."""
    i, j, k = np.indices((n, n, n))
    return (j > 0) & (j < k) & (k < i)


def _antisymmetric(q: Array) -> Array:
    """The totally antisymmetric tensor with the values of q on j < k < i."""
    even = q + q.transpose(1, 2, 0) + q.transpose(2, 0, 1)
    return even - even.transpose(0, 2, 1)


class NonlinearPreisach(ExtendedOperator):
    """Γ of the first-order curves plus the excess of the second-order curves; see the module.

    The output is in the hysteresis's unit. The memory is the classical one. Histories must start in saturation.

    >>> from smarig.preisach import thesis_surface
    >>> from smarig.preisach import Preisach
    >>> none = SecondOrderExcess.from_nodes([0.0, 50.0, 100.0, 174.1], np.zeros((4, 4, 4)))
    >>> u = [120.0, 40.0, 90.0, 60.0, 110.0]
    >>> plain = Preisach.from_surface(thesis_surface("one_e")).simulate(u)
    >>> bool(np.all(NonlinearPreisach(thesis_surface("one_e"), none).simulate(u) == plain))
    True
    """

    def __init__(self, hysteresis: Everett, excess: SecondOrderExcess, initial: Initial = "negative") -> None:
        check_excess_range(excess, hysteresis)
        self.excess = excess
        super().__init__(hysteresis, initial)

    def _read_out(self, y: float) -> float:
        """The output. The cost grows with the depth of the memory."""
        state, sign = self._memory.state, 1.0
        for alpha, beta in corners(state):
            y += sign * self.excess.at(alpha, beta, state.u)
            sign = -sign
        return y

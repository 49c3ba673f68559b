"""The restricted Preisach model of order n: the weighting function depends on n past dominant extrema.

    y(t) = ∬ μ(α, β; e_1 … e_n) γ_αβ u dα dβ

e_1 = M_1, e_2 = m_1, e_3 = M_2, … are the dominant extrema since negative saturation, oldest first (thesis §3.5;
Mayergoyz & Friedman, IEEE Trans. Magn. 24:212, 1988). Loops are comparable if they run between the same inputs after
the same e_1 … e_n. Comparable loops are congruent; others need not be. As changes of output along the reduced memory
p_0 = u₋, p_1 = e_1, …, p_K = e_K, p_K+1 = u, with F the Everett function of the first-order curves,

    y = Γ[u] − Σ_k s_k Σ_{j ≤ min(n, k−1)} Q_j(e_1 … e_j; b_k, a_k),   a_k, b_k = max, min of p_k−1, p_k,   s_k = ±1

s_k is the direction of the k-th move. Q_j is the amount by which a curve of order j + 1 inside the triangle
e_j … e_j−1 rises less than one that follows e_1 … e_j−1 only. Q_j vanishes at a = b, and over the whole triangle
(a, b = e_j−1, e_j in their order), so loops close and wiping-out holds. Q = 0 gives the classical model bit for bit.

The weights depend on the oldest extrema for this reason: if they depended on the n most recent ones, a branch e_K → u
that closes a loop at e_K−1 would have to undo e_K−1 → e_K, which depends on one extremum more. By induction, only the
Everett function of the classical model would then give wiping-out.
"""

from collections.abc import Callable, Sequence

from smarig.core import UsageError
from smarig.preisach import Everett, Initial
from smarig.theory.extended.nonlinear_operator import SecondOrderExcess, check_excess_range
from smarig.theory.extended.operator_base import ExtendedOperator, reduced_memory

Excess = Callable[[tuple[float, ...], float, float], float]


class RestrictedPreisach(ExtendedOperator):
    """Γ of the first-order curves minus the excess of inner curves; see the module.

    ``excesses``: Q_1 … Q_n, each (extrema (j,), β, α) → output. Their number is the order n. Histories must start in
    saturation.

    >>> import numpy as np
    >>> from smarig.preisach import thesis_surface
    >>> from smarig.preisach import Preisach
    >>> none, u = [lambda extrema, beta, alpha: 0.0], [120.0, 40.0, 90.0, 60.0]
    >>> plain = Preisach.from_surface(thesis_surface("one_e")).simulate(u)
    >>> bool(np.all(RestrictedPreisach(thesis_surface("one_e"), none).simulate(u) == plain))
    True
    """

    def __init__(
        self, hysteresis: Everett, excesses: Sequence[Excess], initial: Initial = "negative"
    ) -> None:
        if not all(callable(q) for q in excesses):
            raise UsageError("A restricted model needs one function Q_j(extrema, β, α) for each order.")
        self.excesses = tuple(excesses)
        super().__init__(hysteresis, initial)

    @classmethod
    def first_order(
        cls, hysteresis: Everett, excess: SecondOrderExcess, initial: Initial = "negative"
    ) -> "RestrictedPreisach":
        """The model with n = 1 from second-order curves: Q_1(M_1; β, α) is their excess Q(M_1, β, α)."""
        check_excess_range(excess, hysteresis)
        return cls(hysteresis, [_first_order_excess(excess)], initial)

    @property
    def order(self) -> int:
        """The number of extrema that the weights depend on."""
        return len(self.excesses)

    def _read_out(self, y: float) -> float:
        """The output. The cost grows with the depth of the memory."""
        path = reduced_memory(self._memory.state)
        extrema = path[1:-1]
        for k in range(2, len(path)):
            low, high = sorted(path[k - 1 : k + 1])
            sign = 1.0 if path[k] > path[k - 1] else -1.0
            for j, excess in enumerate(self.excesses[: k - 1], 1):
                y -= sign * excess(extrema[:j], low, high)
        return y


def _first_order_excess(excess: SecondOrderExcess) -> Excess:
    def of_first_maximum(extrema: tuple[float, ...], beta: float, alpha: float) -> float:
        return excess.at(extrema[0], beta, alpha)

    return of_first_maximum

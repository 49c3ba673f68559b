"""A finite, signed measure of relays as a hysteresis: y = Σ mass_k γ_k (3.1), by prefix sums.

Convention: a relay (α, β) is +1 for u ≥ α and −1 for u ≤ β; in between it keeps its value. In the diagonal state B_ℓ
the relays with α + β < 2ℓ and those with α ≤ ℓ are +1; the others are −1.
"""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import NOT_NUMBERS, Array, DataError
from smarig.preisach.kernel import CompiledKeys, KeyedEverett

_LARGEST = 1e100


@dataclass(frozen=True, eq=False)
class RelayMeasure:
    """Relays at (α_k, β_k), α_k ≥ β_k, with signed mass; F(α, β) = 2 Σ mass over α_k ≤ α, β_k ≥ β."""

    alpha: Array
    beta: Array
    mass: Array
    _alphas: Array = field(repr=False)
    _betas: Array = field(repr=False)
    _sums: Array = field(repr=False)

    @classmethod
    def from_arrays(cls, alpha: ArrayLike, beta: ArrayLike, mass: ArrayLike) -> "RelayMeasure":
        """A measure from arrays of one shape (n,), with its prefix sums."""
        try:
            a, b, m = (np.ravel(np.asarray(x, dtype=float)) for x in (alpha, beta, mass))
        except NOT_NUMBERS:
            raise DataError(
                "A measure of relays needs numbers below 1.8e308: thresholds α, β and masses."
            ) from None
        if not a.size == b.size == m.size > 0:
            raise DataError(f"Relay arrays differ in length or are empty: {a.size}, {b.size}, {m.size}.")
        if not (np.isfinite(a).all() and np.isfinite(b).all() and np.isfinite(m).all()):
            raise DataError("A relay has a threshold or a mass that is not finite.")
        if max(np.abs(a).max(), np.abs(b).max(), np.abs(m).max()) > _LARGEST:
            raise DataError(f"A relay has a threshold or a mass that is too large (over {_LARGEST:g}).")
        if np.any(a < b):
            raise DataError("A relay has α < β: it must switch up above where it switches down.")
        alphas, rows = np.unique(a, return_inverse=True)
        betas, columns = np.unique(b, return_inverse=True)
        grid = np.zeros((alphas.size + 1, betas.size + 1))
        np.add.at(grid, (rows + 1, columns), 2 * m)
        sums = np.cumsum(np.cumsum(grid, axis=0)[:, ::-1], axis=1)[:, ::-1]
        return cls(a, b, m, alphas, betas, np.ascontiguousarray(sums))

    @classmethod
    def zero(cls, lower: float, upper: float) -> "RelayMeasure":
        """A measure with zero output over [lower, upper]: one relay without mass, to follow the memory alone."""
        return cls.from_arrays([upper], [lower], [0.0])

    @property
    def lower(self) -> float:
        """Negative saturation: the smallest β."""
        return float(self._betas[0])

    @property
    def upper(self) -> float:
        """Positive saturation: the largest α."""
        return float(self._alphas[-1])

    @property
    def y_lower(self) -> float:
        """Output with all relays at −1."""
        return -float(self.mass.sum())

    @property
    def steps(self) -> Array:
        """Inputs at which F jumps: the thresholds. F is constant between them."""
        return np.union1d(self._alphas, self._betas)

    @cached_property
    def keyed(self) -> KeyedEverett:
        """For the loop: an input's keys are the offset of its row of prefix sums, and its column."""
        alphas, betas = self._alphas.tolist(), self._betas.tolist()
        params = (alphas, betas, self._sums.ravel().tolist(), self._sums.shape[1])
        return KeyedEverett(_between, params, _place, self._places, _COMPILED)

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β): twice the mass of the relays that a rise from β to α switches."""
        alphas, betas, sums, width = self.keyed.params
        return sums[bisect_right(alphas, alpha) * width + bisect_left(betas, beta)]

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays."""
        rows = np.searchsorted(self._alphas, alpha, side="right")
        return self._sums[rows, np.searchsorted(self._betas, beta, side="left")]

    def _places(self, u: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """``_place`` for arrays (n,)."""
        rows = np.searchsorted(self._alphas, u, "right")
        return rows * self._sums.shape[1], np.searchsorted(self._betas, u, "left")

    def from_diagonal(self, centre: float, u: Array) -> Array:
        """Signed output change from B_ℓ to each input (n,): twice the mass that switches."""
        return np.where(u >= centre, self._mass_switched_on(centre, u), -self._mass_switched_off(centre, u))

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Twice the mass that a rise from ℓ to u switches on."""
        return float(self._mass_switched_on(centre, np.array(u)))

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Twice the mass that a fall from ℓ to u switches off."""
        return float(self._mass_switched_off(centre, np.array(u)))

    def _mass_switched_on(self, centre: float, u: Array) -> Array:
        off = (self.alpha > centre) & (self.alpha + self.beta >= 2 * centre)
        return _mass_up_to(self.alpha[off], self.mass[off], u)

    def _mass_switched_off(self, centre: float, u: Array) -> Array:
        on = (self.alpha <= centre) | (self.alpha + self.beta < 2 * centre)
        return _mass_up_to(-self.beta[on], self.mass[on], -u)


def _mass_up_to(thresholds: Array, mass: Array, u: Array) -> Array:
    """Twice the mass at thresholds ≤ u, for each u."""
    order = np.argsort(thresholds, kind="stable")
    sums = np.concatenate([[0.0], np.cumsum(2 * mass[order])])
    return sums[np.searchsorted(thresholds[order], u, side="right")]


def _place(params: Any, u: float) -> tuple[int, int]:
    alphas, betas, _, width = params
    return bisect_right(alphas, u) * width, bisect_left(betas, u)


def _between(params: Any, a: int, b: int) -> float:
    return params[2][a + b]


def _above(params: Any, u: float, rank: Any) -> int:
    return rank(params[0], u) * params[3]


def _below(params: Any, u: float, rank: Any) -> int:
    return rank(params[1], u)


_COMPILED = CompiledKeys(_above, _below, ((0, "right"), (1, "left")))

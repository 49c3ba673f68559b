"""A finite, signed measure of relays as a hysteresis: y = Σ mass_k γ_k (3.1), by prefix sums.

Convention: a relay (α, β) is +1 for u ≥ α, −1 for u ≤ β, and remembers in between. In the diagonal
state B_ℓ relays with α + β < 2ℓ are +1, and so are those with α ≤ ℓ; the others are −1.
"""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.errors import DataError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RelayMeasure:
    """Relays at (α_k, β_k), α_k ≥ β_k, with signed mass; F(α, β) = 2 Σ mass over α_k ≤ α, β_k ≥ β."""

    alpha: Array
    beta: Array
    mass: Array
    _alphas: list[float]
    _betas: list[float]
    _sums: list[list[float]]

    @classmethod
    def from_arrays(cls, alpha: ArrayLike, beta: ArrayLike, mass: ArrayLike) -> "RelayMeasure":
        """Build the prefix sums; arrays of one shape (n,)."""
        a, b, m = (np.ravel(np.asarray(x, dtype=float)) for x in (alpha, beta, mass))
        if not a.size == b.size == m.size > 0:
            raise DataError(f"Relay arrays differ in length or are empty: {a.size}, {b.size}, {m.size}.")
        if not (np.isfinite(a).all() and np.isfinite(b).all() and np.isfinite(m).all()):
            raise DataError("A relay has a threshold or a mass that is not finite.")
        if np.any(a < b):
            raise DataError("A relay has α < β: it must switch up above where it switches down.")
        alphas, rows = np.unique(a, return_inverse=True)
        betas, columns = np.unique(b, return_inverse=True)
        grid = np.zeros((alphas.size + 1, betas.size + 1))
        np.add.at(grid, (rows + 1, columns), 2 * m)
        sums = np.cumsum(np.cumsum(grid, axis=0)[:, ::-1], axis=1)[:, ::-1]
        return cls(a, b, m, alphas.tolist(), betas.tolist(), sums.tolist())

    @property
    def lower(self) -> float:
        """Negative saturation: the smallest β."""
        return self._betas[0]

    @property
    def upper(self) -> float:
        """Positive saturation: the largest α."""
        return self._alphas[-1]

    @property
    def y_lower(self) -> float:
        """All relays at −1."""
        return -float(self.mass.sum())

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β): twice the mass of the relays a rise from β to α switches."""
        return self._sums[bisect_right(self._alphas, alpha)][bisect_left(self._betas, beta)]

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β), arrays."""
        rows = np.searchsorted(self._alphas, alpha, side="right")
        return np.asarray(self._sums)[rows, np.searchsorted(self._betas, beta, side="left")]

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Twice the mass switched on by a rise from ℓ to u."""
        off = (self.alpha > centre) & (self.alpha + self.beta >= 2 * centre)
        return 2 * float(self.mass[off & (self.alpha <= u)].sum())

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Twice the mass switched off by a fall from ℓ to u."""
        on = (self.alpha <= centre) | (self.alpha + self.beta < 2 * centre)
        return 2 * float(self.mass[on & (self.beta >= u)].sum())

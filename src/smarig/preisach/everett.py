"""What the Preisach operator needs to know of a hysteresis: its Everett function and range.

    F(α, β) = y(α, α) − y(α, β),   u₋ ≤ β ≤ α ≤ u₊

F is the output change of a monotone sweep between β and α (thesis §3.4, theory.md §1): the measure ν
of the triangle with corner (α, β), reversible part included. Surfaces, tables and relay measures
provide it; the operator never integrates μ. The diagonal states B_ℓ = {α = 2ℓ − β} (Def. 3.1, §8.3)
have a boundary of slope −1, along which F must be integrated: ``Diagonal`` does that for smooth and
piecewise models.
"""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class Everett(Protocol):
    """A hysteresis as the operator sees it. Outputs and inputs in the model's own units."""

    @property
    def lower(self) -> float:
        """Negative saturation u₋."""
        ...

    @property
    def upper(self) -> float:
        """Positive saturation u₊."""
        ...

    @property
    def y_lower(self) -> float:
        """Output at negative saturation."""
        ...

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) for scalars with β ≤ α."""
        ...

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.float64]:
        """F(α, β) for arrays, which broadcast."""
        ...

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Output change from B_ℓ (ℓ = centre) when the input rises from ℓ to u."""
        ...

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Output change, as a positive drop for ν ≥ 0, from B_ℓ when the input falls from ℓ to u."""
        ...


class Differentiable(Protocol):
    """A FOD surface with first derivatives, vectorised; ``kinks`` are where they jump."""

    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def kinks(self) -> NDArray[np.float64]: ...
    def strip_alpha(self, alpha: NDArray[np.float64], beta: NDArray[np.float64]) -> NDArray[np.float64]:
        """∂F/∂α (α, β): the strip a rising input sweeps per unit."""
        ...

    def strip_beta(self, alpha: NDArray[np.float64], beta: NDArray[np.float64]) -> NDArray[np.float64]:
        """∂y/∂β (α, β): the strip a falling input sweeps per unit."""
        ...


def rise_integral(surface: Differentiable, centre: float, u: float) -> float:
    """∫_ℓ^u ∂_αF(α, max(2ℓ − α, u₋)) dα: output change rising from B_ℓ."""
    mirror = _breaks(surface, centre, centre, u, 2 * centre - surface.lower)

    def strip(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface.strip_alpha(alpha, np.maximum(2 * centre - alpha, surface.lower))

    return _integrate(strip, mirror)


def fall_integral(surface: Differentiable, centre: float, u: float) -> float:
    """∫_u^ℓ ∂_βy(min(2ℓ − β, u₊), β) dβ: output change falling from B_ℓ (theory.md §1, ψ)."""
    mirror = _breaks(surface, centre, u, centre, 2 * centre - surface.upper)

    def strip(beta: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface.strip_beta(np.minimum(2 * centre - beta, surface.upper), beta)

    return _integrate(strip, mirror)


def _breaks(surface: Differentiable, centre: float, a: float, b: float, clip: float) -> NDArray[np.float64]:
    """Panel edges in [a, b]: kinks, mirrored kinks, the clip point, and a smooth-panel width limit."""
    width = (surface.upper - surface.lower) / 32
    even = np.linspace(a, b, max(2, int(np.ceil((b - a) / width)) + 1))
    edges = np.concatenate([even, surface.kinks, 2 * centre - surface.kinks, [clip]])
    return np.unique(edges[(edges >= a) & (edges <= b)])


def _integrate(f, edges: NDArray[np.float64]) -> float:
    """Gauss–Legendre over panels; exact to rounding for the surfaces of §5.4 at these widths."""
    if edges.size < 2:
        return 0.0
    half = np.diff(edges)[:, None] / 2
    middle = ((edges[1:] + edges[:-1]) / 2)[:, None]
    return float(np.sum(f(middle + half * _NODES) * _WEIGHTS * half))

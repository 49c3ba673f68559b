"""What the Preisach operator needs to know of a hysteresis: its Everett function and range.

    F(α, β) = y(α, α) − y(α, β),   u₋ ≤ β ≤ α ≤ u₊

F is the output change of a monotone sweep between β and α (thesis §3.4, theory.md §1): the measure ν
of the triangle with corner (α, β), reversible part included. Surfaces, tables and relay measures
provide it; the operator never integrates μ. The diagonal states B_ℓ = {α = 2ℓ − β} (Def. 3.1, §8.3)
have a boundary of slope −1, along which F must be integrated: ``DiagonalIntegrals`` does that for smooth
and piecewise models.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_BLOCK = 2048  # inputs integrated at once: bounds memory


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


def from_diagonal(hysteresis: Everett, centre: float, u: ArrayLike) -> NDArray[np.float64]:
    """Output change (signed) from B_ℓ, ℓ = centre, by one monotone move to each input u (n,).

    By the hysteresis's own array method ``from_diagonal`` where it has one, else input by input.
    """
    inputs = np.asarray(u, dtype=float)
    own = getattr(hysteresis, "from_diagonal", None)
    if own is not None:
        return own(centre, inputs)
    rise, fall = hysteresis.rise_from_diagonal, hysteresis.fall_from_diagonal
    return np.array([rise(centre, v) if v >= centre else -fall(centre, v) for v in inputs.tolist()])


class DiagonalIntegrals:
    """Moves from B_ℓ by quadrature, for a ``Differentiable`` to inherit: exact to rounding, kink by kink."""

    def from_diagonal(self: Differentiable, centre: float, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Output change (signed) to each input (n,): rises and falls, each whatever the others are."""
        change = np.empty(u.shape)
        up = u >= centre
        change[up] = _cumulative(_rising(self, centre), u[up])
        change[~up] = -_cumulative(_falling(self, centre), -u[~up])
        return change

    def rise_from_diagonal(self: Differentiable, centre: float, u: float) -> float:
        """∫_ℓ^u ∂_αF(α, max(2ℓ − α, u₋)) dα: output change rising from B_ℓ."""
        return float(_cumulative(_rising(self, centre), np.array([u], dtype=float))[0])

    def fall_from_diagonal(self: Differentiable, centre: float, u: float) -> float:
        """∫_u^ℓ ∂_βy(min(2ℓ − β, u₊), β) dβ: output change falling from B_ℓ (theory.md §1, ψ)."""
        return float(_cumulative(_falling(self, centre), np.array([-u], dtype=float))[0])


Strip = Callable[[NDArray[np.float64]], NDArray[np.float64]]


class _StripIntegral(NamedTuple):
    """A strip, the panel edges (n + 1,) along it, and its integral up to each edge (n + 1,)."""

    strip: Strip
    edges: NDArray[np.float64]
    up_to_edge: NDArray[np.float64]


@lru_cache(maxsize=8)  # a twin asks for the same diagonal state at every tick of its initialisation
def _rising(surface: Differentiable, centre: float) -> _StripIntegral:
    def strip(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface.strip_alpha(alpha, np.maximum(2 * centre - alpha, surface.lower))

    return _strip_integral(strip, _panels(surface, centre, centre, surface.upper, 2 * centre - surface.lower))


@lru_cache(maxsize=8)
def _falling(surface: Differentiable, centre: float) -> _StripIntegral:
    """In the variable −β, so that a fall runs upwards like a rise."""

    def strip(minus_beta: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface.strip_beta(np.minimum(2 * centre + minus_beta, surface.upper), -minus_beta)

    panels = _panels(surface, centre, surface.lower, centre, 2 * centre - surface.upper)
    return _strip_integral(strip, -panels[::-1])


def _strip_integral(strip: Strip, edges: NDArray[np.float64]) -> _StripIntegral:
    whole = _gauss(strip, edges[:-1], edges[1:])
    return _StripIntegral(strip, edges, np.concatenate([[0.0], np.cumsum(whole)]))


def _panels(surface: Differentiable, centre: float, a: float, b: float, clip: float) -> NDArray[np.float64]:
    """Panel edges over [a, b]: kinks, mirrored kinks, the clip point, and a smooth-panel width limit.

    They do not depend on how far the input goes, so an output does not depend on what else is asked.
    """
    width = (surface.upper - surface.lower) / 32
    even = np.linspace(a, b, max(2, int(np.ceil((b - a) / width)) + 1))
    edges = np.concatenate([even, surface.kinks, 2 * centre - surface.kinks, [clip]])
    return np.unique(edges[(edges >= a) & (edges <= b)])


def _cumulative(strip_integral: _StripIntegral, u: NDArray[np.float64]) -> NDArray[np.float64]:
    """∫ from edges[0] to each u (n,): whole panels by their sums, the last one by its own Gauss–Legendre.

    Exact to rounding for the surfaces of §5.4 at these widths.
    """
    strip, edges, up_to_edge = strip_integral
    panel = np.clip(np.searchsorted(edges, u, side="left") - 1, 0, max(edges.size - 2, 0))
    blocks = np.array_split(np.arange(u.size), u.size // _BLOCK + 1)
    return np.concatenate([up_to_edge[panel[k]] + _gauss(strip, edges[panel[k]], u[k]) for k in blocks])


def _gauss(strip: Strip, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    half = (b - a)[:, None] / 2
    return np.sum(strip((a + b)[:, None] / 2 + half * _NODES) * _WEIGHTS * half, axis=1)

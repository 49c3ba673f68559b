"""The interface of a hysteresis to the Preisach operator: its Everett function and range.

    F(α, β) = y(α, α) − y(α, β),   u₋ ≤ β ≤ α ≤ u₊

F is the output change of a monotone sweep between β and α (thesis §3.4, theory.md §1). It equals the measure ν of the
triangle with corner (α, β), reversible part included. Surfaces, tables and relay measures provide it; the operator
never integrates μ. The diagonal states B_ℓ = {α = 2ℓ − β} (Def. 3.1, §8.3) have a boundary of slope −1, along which F
must be integrated. ``DiagonalIntegrals`` does that for smooth and piecewise models.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_BLOCK = 2048  # inputs integrated at once; limits the memory used


class Everett(Protocol):
    """A hysteresis as the operator uses it. Outputs and inputs are in the model's own units."""

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

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays, broadcast."""
        ...

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Output change from B_ℓ (ℓ = centre) when the input rises from ℓ to u."""
        ...

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Output change from B_ℓ when the input falls from ℓ to u, as a drop that is positive for ν ≥ 0."""
        ...


class Differentiable(Protocol):
    """A FOD surface with first derivatives, vectorised. They jump at ``kinks``."""

    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def kinks(self) -> Array: ...
    def strip_alpha(self, alpha: Array, beta: Array) -> Array:
        """∂F/∂α (α, β): the strip that a rising input sweeps per unit."""
        ...

    def strip_beta(self, alpha: Array, beta: Array) -> Array:
        """∂y/∂β (α, β): the strip that a falling input sweeps per unit."""
        ...


def from_diagonal(hysteresis: Everett, centre: float, u: ArrayLike) -> Array:
    """Signed output change from B_ℓ, ℓ = centre, for one monotone move to each input u (n,).

    It uses the array method ``from_diagonal`` of the hysteresis if there is one, otherwise one input at a time.
    """
    inputs = np.asarray(u, dtype=float)
    own = getattr(hysteresis, "from_diagonal", None)
    if own is not None:
        return own(centre, inputs)
    rise, fall = hysteresis.rise_from_diagonal, hysteresis.fall_from_diagonal
    return np.array([rise(centre, v) if v >= centre else -fall(centre, v) for v in inputs.tolist()])


class DiagonalIntegrals:
    """Mixin for a ``Differentiable``: output changes from B_ℓ by quadrature between kinks, exact to rounding."""

    def from_diagonal(self: Differentiable, centre: float, u: Array) -> Array:
        """Signed output change to each input (n,), each independent of the others."""
        change = np.empty(u.shape)
        up = u >= centre
        if up.any():
            change[up] = _cumulative(_rising(self, centre), u[up])
        if not up.all():
            change[~up] = -_cumulative(_falling(self, centre), -u[~up])
        return change

    def rise_from_diagonal(self: Differentiable, centre: float, u: float) -> float:
        """∫_ℓ^u ∂_αF(α, max(2ℓ − α, u₋)) dα: output change when rising from B_ℓ."""
        return float(_cumulative(_rising(self, centre), np.array([u], dtype=float))[0])

    def fall_from_diagonal(self: Differentiable, centre: float, u: float) -> float:
        """∫_u^ℓ ∂_βy(min(2ℓ − β, u₊), β) dβ: output change when falling from B_ℓ (theory.md §1, ψ)."""
        return float(_cumulative(_falling(self, centre), np.array([-u], dtype=float))[0])


Strip = Callable[[Array], Array]


class _StripIntegral(NamedTuple):
    """A strip, its panel edges (n + 1,), and its integral up to each edge (n + 1,)."""

    strip: Strip
    edges: Array
    up_to_edge: Array


@lru_cache(maxsize=8)  # a twin uses the same diagonal state in every tick of its initialisation
def _rising(surface: Differentiable, centre: float) -> _StripIntegral:
    def strip(alpha: Array) -> Array:
        return surface.strip_alpha(alpha, np.maximum(2 * centre - alpha, surface.lower))

    return _strip_integral(strip, _panels(surface, centre, centre, surface.upper, 2 * centre - surface.lower))


@lru_cache(maxsize=8)
def _falling(surface: Differentiable, centre: float) -> _StripIntegral:
    """The strip in the variable −β, so that a fall is integrated upwards like a rise."""

    def strip(minus_beta: Array) -> Array:
        return surface.strip_beta(np.minimum(2 * centre + minus_beta, surface.upper), -minus_beta)

    panels = _panels(surface, centre, surface.lower, centre, 2 * centre - surface.upper)
    return _strip_integral(strip, -panels[::-1])


def _strip_integral(strip: Strip, edges: Array) -> _StripIntegral:
    whole = _gauss(strip, edges[:-1], edges[1:])
    return _StripIntegral(strip, edges, np.concatenate([[0.0], np.cumsum(whole)]))


def _panels(surface: Differentiable, centre: float, a: float, b: float, clip: float) -> Array:
    """Panel edges over [a, b]: kinks, mirrored kinks, the clip point, and a width limit for smooth panels.

    They do not depend on the input, so an output does not depend on the other inputs of a call.
    """
    width = (surface.upper - surface.lower) / 32
    even = np.linspace(a, b, max(2, int(np.ceil((b - a) / width)) + 1))
    edges = np.concatenate([even, surface.kinks, 2 * centre - surface.kinks, [clip]])
    return np.unique(edges[(edges >= a) & (edges <= b)])


def _cumulative(strip_integral: _StripIntegral, u: Array) -> Array:
    """∫ from edges[0] to each u (n,): sums of whole panels, and Gauss–Legendre quadrature on the last panel.

    At these widths it is exact to rounding for the surfaces of §5.4.
    """
    strip, edges, up_to_edge = strip_integral
    panel = np.clip(np.searchsorted(edges, u, side="left") - 1, 0, max(edges.size - 2, 0))
    blocks = [slice(begin, begin + _BLOCK) for begin in range(0, u.size, _BLOCK)]
    return np.concatenate([up_to_edge[panel[k]] + _gauss(strip, edges[panel[k]], u[k]) for k in blocks])


def _gauss(strip: Strip, a: Array, b: Array) -> Array:
    half = (b - a)[:, None] / 2
    return np.sum(strip((a + b)[:, None] / 2 + half * _NODES) * _WEIGHTS * half, axis=1)

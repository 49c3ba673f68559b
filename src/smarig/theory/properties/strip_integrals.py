"""Strip integrals H, V, k and K of §4.1, as output changes, reversible part included.

    H(λ, ξ) = 2∬_{λ≤α≤λ+ξ} μ + ∫_λ^{λ+ξ} g = F(λ + ξ, u₋) − F(λ, u₋)         rise along the major loop
    V(λ, ξ) = 2∬_{λ≤β≤λ+ξ} μ + ∫_λ^{λ+ξ} g = F(u₊, λ) − F(u₊, λ + ξ)         fall along the major loop
    k = max(H, V),     K(ξ) = max_λ k(λ, ξ)

(The thesis prints them once without the 2 and always without g: theory.md §8, errata 1 and 8.) K is the largest output
change of a monotone input change ξ only for ν ≥ 0. For signed ν a sweep that covers part of a strip can give more.
``bound`` is K of |ν|, and ``sweep_changes.largest_change`` is the true value. Relays on the strip's edges count as a
sweep would switch them.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach import Everett
from smarig.theory.properties.triangle_grid import TriangleGrid
from smarig.theory.properties.variation import uncertainty, variation

_GRID_POINTS = 2048
_PEAKS, _GOLDEN_STEPS = 16, 60  # 0.618^60 = 3e-13 of an interval; values then differ by rounding
_GOLDEN = (math.sqrt(5) - 1) / 2


def H(hysteresis: Everett, lam: ArrayLike, xi: ArrayLike) -> Array:
    """Horizontal strip: output change of a rise from λ to λ + ξ, directly from negative saturation.

    >>> from smarig.preisach import thesis_surface
    >>> s = thesis_surface("two_c")
    >>> bool(abs(H(s, s.lower, s.upper - s.lower) - (s.y_upper - s.y_lower)) < 1e-12)
    True
    """
    low, high = _strip(hysteresis, lam, xi)
    return hysteresis.swept(high, hysteresis.lower) - hysteresis.swept(low, hysteresis.lower)


def V(hysteresis: Everett, lam: ArrayLike, xi: ArrayLike) -> Array:
    """Vertical strip: output change of a fall from λ + ξ to λ from saturation; a drop is positive."""
    low, high = _strip(hysteresis, lam, xi)
    return hysteresis.swept(hysteresis.upper, low) - hysteresis.swept(hysteresis.upper, high)


def k(hysteresis: Everett, lam: ArrayLike, xi: ArrayLike) -> Array:
    """k(λ, ξ) = max(H, V); continuous for μ ∈ M_PC (Lemma 4.1)."""
    return np.maximum(H(hysteresis, lam, xi), V(hysteresis, lam, xi))


def K(hysteresis: Everett, xi: float) -> float:
    """K(ξ) = max over λ of k(λ, ξ): exact for tables and relays, to rounding for others.

    H and V of a table are linear in λ between its levels and those minus ξ, so the maximum is at one of them. For
    others the local maxima of a fine grid are refined by golden section; a peak narrower than the grid is not found.
    """
    plane = TriangleGrid.of(hysteresis)
    lam = candidates(plane, xi)
    if plane.kind in ("table", "relays"):
        return float(k(hysteresis, lam, xi).max())
    last = max(hysteresis.upper - xi, hysteresis.lower)
    lam = np.unique(np.concatenate([lam, np.linspace(hysteresis.lower, last, _GRID_POINTS + 1)]))
    return max(_refined_maximum(lambda x, f=f: f(hysteresis, x, xi), lam) for f in (H, V))


def _refined_maximum(f: Callable[[Array], Array], grid: Array) -> float:
    """The largest value of f near the local maxima of a grid, by golden section of all of them at once."""
    values = f(grid)
    padded = np.concatenate([[-np.inf], values, [-np.inf]])
    peaks = np.flatnonzero((values >= padded[:-2]) & (values >= padded[2:]))
    peaks = peaks[np.argsort(values[peaks])[-_PEAKS:]]
    low, high = grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, grid.size - 1)]
    best = float(values.max())
    for _ in range(_GOLDEN_STEPS):
        near, far = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_near, at_far = f(near), f(far)
        best = max(best, float(at_near.max()), float(at_far.max()))
        left = at_near >= at_far
        low, high = np.where(left, low, near), np.where(left, far, high)
    return best


def bound(hysteresis: Everett, xi: float) -> float:
    """2∬|μ| + ∫|g| over the widest strip: no monotone input change ξ changes the output by more.

    It is proved for surfaces, tables and relays. It is NaN for anything else, because only samples are known.
    """
    plane = TriangleGrid.of(hysteresis)
    _check(hysteresis.lower, hysteresis.upper, xi)
    if plane.kind == "sampled":
        return float("nan")
    return K(variation(plane), xi) + uncertainty(plane)


def candidates(plane: TriangleGrid, xi: float) -> Array:
    """All λ at which a strip of width ξ starts or ends on a level; for relays also points between them."""
    lower, upper = float(plane.levels[0]), float(plane.levels[-1])
    _check(lower, upper, xi)
    last = max(upper - xi, lower)
    lam = np.unique(np.clip(np.concatenate([plane.levels, plane.levels - xi]), lower, last))
    if plane.kind == "relays":
        lam = np.unique(np.concatenate([lam, (lam[1:] + lam[:-1]) / 2]))
    return lam


def _strip(hysteresis: Everett, lam: ArrayLike, xi: ArrayLike) -> tuple[Array, Array]:
    low, width = np.asarray(lam, dtype=float), np.asarray(xi, dtype=float)
    lower, upper = hysteresis.lower, hysteresis.upper
    _check(lower, upper, float(width.min()))
    slack = 1e-12 * (upper - lower)
    if low.min() < lower - slack or (low + width).max() > upper + slack:
        raise UsageError(f"A strip λ … λ + ξ must lie inside the input range [{lower:g}, {upper:g}].")
    return np.maximum(low, lower), np.minimum(low + width, upper)


def _check(lower: float, upper: float, xi: float) -> None:
    if not 0.0 <= xi <= (upper - lower) * (1 + 1e-12):
        raise UsageError(
            f"An input change ξ = {xi:g} must lie between 0 and the input range {upper - lower:g}."
        )

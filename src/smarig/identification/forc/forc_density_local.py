"""Weighted local polynomials at many places at once: value, mixed derivative, and their noise.

Around each place (α₀, β₀) the polynomial that minimises Σ w_i (y_i − p(α_i, β_i))² is found from its normal
equations. Places and points are sorted into square cells at least as wide as the reach of the window. Then one
matrix product per cell, (weights) × (monomials), gives the moments of all its places. Coordinates are scaled to
grid steps.

Windows of a local regression: the weight of a measured point by its distance from the place of the fit, in grid
steps.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

WindowWeights = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True)
class RegressionWindow:
    """A family of weights w(Δα, Δβ; s), with the smoothing factor s in grid steps.

    ``weights(targets, points, s)`` takes places in grid steps, (t, 2) and (u, 2), and factors (t,), and returns (t,
    u). It is zero if the distance of a coordinate in ``frame`` (2, 2) exceeds s. ``one_step`` windows mix the axes
    and need the same step for both.
    """

    weights: WindowWeights
    frame: Array
    one_step: bool


def _tricube(targets: Array, points: Array, s: Array) -> Array:
    """(1 − d³)³ within the ellipse d² = (Δα² + Δβ²)/s² ≤ 1 (Cleveland 1979; Harrison & Feinberg 2008)."""
    scaled = targets / s[:, None]
    # d² = |t|²/s² + |p|²/s² − 2 t·p/s²: one matrix product instead of differences of every pair.
    left = np.column_stack([np.sum(scaled**2, axis=1), 1 / s**2, -2 * scaled / s[:, None]])
    right = np.stack([np.ones(len(points)), np.sum(points**2, axis=1), points[:, 0], points[:, 1]])
    square = left @ right
    np.clip(square, 0.0, 1.0, out=square)
    cube = np.sqrt(square)
    cube *= square
    rest = np.subtract(1.0, cube, out=cube)
    np.multiply(rest, rest, out=square)
    square *= rest
    return square


_EGLI = np.array([[0.5, 0.5], [-0.5, 0.5]])  # (α, β) @ _EGLI = (α − β)/2, (α + β)/2


def _rounded_box(targets: Array, points: Array, s: Array) -> Array:
    """Product of one-dimensional weights in (Δα − Δβ)/2 and (Δα + Δβ)/2 (Egli 2013, eq. 6)."""
    doubled = 2 * _EGLI
    t, p = targets @ doubled, points @ doubled
    weights = _twice_edge(t[:, 0], p[:, 0], s)
    weights *= _twice_edge(t[:, 1], p[:, 1], s)
    weights *= 0.25
    return weights


def _twice_edge(targets: Array, points: Array, s: Array) -> Array:
    """Twice the weight at distances |x|, given doubled: 1 up to s − 1, 0 beyond s, two parabolas between.

    With e = 2s − 1 − 2|x| within ±1, both parabolas are (1 + e(2 − |e|))/2.
    """
    e = np.subtract(targets[:, None], points)
    np.abs(e, out=e)
    np.subtract((2 * s - 1)[:, None], e, out=e)
    np.clip(e, -1.0, 1.0, out=e)
    rest = np.abs(e)
    np.subtract(2.0, rest, out=rest)
    e *= rest
    e += 1.0
    return e


WINDOWS = {
    "loess": RegressionWindow(_tricube, np.eye(2), one_step=False),
    "variforc": RegressionWindow(_rounded_box, _EGLI, one_step=True),
}


Indices = NDArray[np.int64]
_CELL = 9.0  # steps: with places as dense as points, about eighty places share the arithmetic
_BLOCK = 96  # places at a time, so that their weights fit the cache
_COLLINEAR = 1e-9  # 1 − R² of a monomial on those before it


@dataclass(frozen=True, eq=False)
class LocalFits:
    """The results of the local polynomials per place (t,); NaN where ``singular``.

    ``value`` is p(α₀, β₀) and ``mixed`` ∂²p/∂α∂β there, per square step. ``value_gain``, ``mixed_gain``: standard
    deviation of each for noise of deviation 1. ``leverage``: ∂value/∂y of a point at the place.
    """

    value: Array
    mixed: Array
    value_gain: Array
    mixed_gain: Array
    leverage: Array

    @property
    def singular(self) -> NDArray[np.bool_]:
        """Mask of places whose neighbourhood does not determine the polynomial."""
        return np.isnan(self.mixed)


def local_fits(
    places: Array,
    points: Array,
    y: Array,
    s: Array,
    window: RegressionWindow,
    degree: int = 2,
    without: tuple[Array, Array] | None = None,
) -> LocalFits:
    """Fit at ``places`` (t, 2) to ``points`` (n, 2) with values ``y`` (n,) and factors ``s`` (t,), in steps.

    ``without`` = labels of places (t,) and of points (n,): a place is fitted to points with other labels only.
    """
    basis = _Basis.of(degree)
    unit = float(s.max())
    products = basis.orders.shape[1]
    moments = np.empty((products + basis.terms, len(places)))
    squares = np.empty((products, len(places)))
    offsets = np.empty((len(places), 2))
    for mine, theirs in neighbourhoods(places @ window.frame, points @ window.frame, s):
        middle = places[mine].mean(axis=0)
        near = (points[theirs] - middle) / unit
        columns = basis.monomials(near)
        columns = np.concatenate([columns, columns[: basis.terms] * y[theirs]]).T.copy()
        for start in range(0, mine.size, _BLOCK):
            block = mine[start : start + _BLOCK]
            offsets[block] = local = (places[block] - middle) / unit
            weights = window.weights(local * unit, near * unit, s[block])
            if without is not None:
                weights[without[0][block][:, None] == without[1][theirs]] = 0.0
            moments[:, block] = (weights @ columns).T
            weights *= weights
            squares[:, block] = (weights @ columns[:, :products]).T
    return _solved(basis, moments, squares, offsets, unit)


@dataclass(frozen=True, eq=False)
class _Basis:
    """Monomials u^p v^q by rising order; the first ``terms`` span the polynomial, all of them its products."""

    degree: int
    orders: NDArray[np.int64]  # (2, m): p and q
    terms: int
    products: NDArray[np.int64]  # (terms, terms): index of the product of two terms

    @classmethod
    def of(cls, degree: int) -> "_Basis":
        orders = [(n - q, q) for n in range(2 * degree + 1) for q in range(n + 1)]
        terms = (degree + 1) * (degree + 2) // 2
        index = {pair: k for k, pair in enumerate(orders)}
        products = [[index[p + r, q + t] for r, t in orders[:terms]] for p, q in orders[:terms]]
        return cls(degree, np.array(orders).T, terms, np.array(products))

    def monomials(self, at: Array) -> Array:
        """(m, n) values at places (n, 2)."""
        u, v = (np.vander(x, 2 * self.degree + 1, increasing=True).T for x in at.T)
        return u[self.orders[0]] * v[self.orders[1]]

    def value_and_mixed(self, at: Array) -> tuple[Array, Array]:
        """The terms (terms, t) and their ∂²/∂u∂v at places (t, 2)."""
        u, v = (np.vander(x, self.degree + 1, increasing=True).T for x in at.T)
        p, q = self.orders[:, : self.terms]
        slopes = (p * q)[:, None] * u[np.maximum(p - 1, 0)] * v[np.maximum(q - 1, 0)]
        return u[p] * v[q], slopes


def neighbourhoods(places: Array, points: Array, s: Array) -> Iterator[tuple[Indices, Indices]]:
    """For each occupied square cell, the indices of its places and of all points within reach ``s`` (t,) of any."""
    side = _CELL * np.sqrt(max(1.0, len(points) / len(places)))
    origin = points.min(axis=0)
    cell, wanted = (np.floor((x - origin) / side).astype(np.int64) for x in (points, places))
    rings = int(np.ceil(s.max() / side))
    width = max(int(cell[:, 1].max()), int(wanted[:, 1].max())) + 2 * rings + 1
    keys, wanted_keys = (x[:, 0] * width + x[:, 1] for x in (cell, wanted))
    order = np.argsort(keys, kind="stable")
    keys, sorted_points = keys[order], points[order]
    by_cell = np.argsort(wanted_keys, kind="stable")
    for mine in np.split(by_cell, np.flatnonzero(np.diff(wanted_keys[by_cell])) + 1):
        rows = wanted_keys[mine[0]] + width * np.arange(-rings, rings + 1)
        begins, ends = np.searchsorted(keys, rows - rings), np.searchsorted(keys, rows + rings, side="right")
        near = np.concatenate([np.arange(b, e) for b, e in zip(begins, ends)])
        reach = s[mine].max()
        low, high = places[mine].min(axis=0) - reach, places[mine].max(axis=0) + reach
        within = sorted_points[near]
        yield mine, order[near[np.all((low < within) & (within < high), axis=1)]]


def _solved(basis: _Basis, moments: Array, squares: Array, offsets: Array, unit: float) -> LocalFits:
    normal, spread = moments[basis.products], squares[basis.products]
    right = moments[len(squares) :]
    value, mixed = basis.value_and_mixed(offsets)
    factor, sound = _cholesky(normal)
    coefficients, to_value, to_mixed = (_solve(factor, b) for b in (right, value, mixed))

    def gain(functional: Array) -> Array:
        return np.sqrt(np.maximum(np.einsum("pt,pqt,qt->t", functional, spread, functional), 0.0))

    def where(x: Array) -> Array:
        return np.where(sound, x, np.nan)

    return LocalFits(
        value=where(np.einsum("pt,pt->t", value, coefficients)),
        mixed=where(np.einsum("pt,pt->t", mixed, coefficients)) / unit**2,
        value_gain=where(gain(to_value)),
        mixed_gain=where(gain(to_mixed)) / unit**2,
        leverage=where(np.einsum("pt,pt->t", value, to_value)),
    )


def _cholesky(normal: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Lower factors (p, p, t) of the matrices, and the mask of those without collinear columns.

    NumPy's would raise for all places where one matrix is singular.
    """
    factor = np.zeros_like(normal)
    sound = np.ones(normal.shape[2], dtype=bool)
    for k in range(normal.shape[0]):
        column = normal[k:, k] - np.einsum("pjt,jt->pt", factor[k:, :k], factor[k, :k])
        good = column[0] > _COLLINEAR * normal[k, k]
        sound &= good
        factor[k:, k] = column / np.sqrt(np.where(good, column[0], 1.0))
    return factor, sound


def _solve(factor: Array, right: Array) -> Array:
    """Solutions (p, t) of L Lᵀ x = right."""
    x = right.copy()
    n = len(x)
    for k in range(n):
        x[k] = (x[k] - np.einsum("jt,jt->t", factor[k, :k], x[:k])) / _nonzero(factor[k, k])
    for k in reversed(range(n)):
        x[k] = (x[k] - np.einsum("jt,jt->t", factor[k + 1 :, k], x[k + 1 :])) / _nonzero(factor[k, k])
    return x


def _nonzero(x: Array) -> Array:
    return np.where(x == 0, 1.0, x)

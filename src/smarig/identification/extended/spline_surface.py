"""An Everett function of unknown shape: smooth, linear in its weights, with hyperparameters from the evidence.

    F(α, β) = Σ_{i<j} c_ij [B_j(α) B_i(β) − B_i(α) B_j(β)]

with cubic B-splines. It is antisymmetric, so F(α, α) = 0, and every rising or falling move w → w′ changes the
output by F(w′, w). The weights have a Gaussian prior with independent second differences. Smoothness and noise
follow from restricted maximum likelihood (Patterson & Thompson, Biometrika 58:545, 1971).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize_scalar

from smarig.core import Array, DataError
from smarig.identification.extended.extremum_chains import ExtremumChains, Places
from smarig.preisach import FodTable

_PROPER = 1e-4  # a small ridge makes the prior proper
_SPLINES = 24  # enough that the prior, not the basis, determines the smoothness
_LEVELS = 121


@dataclass(frozen=True, eq=False)
class SplineBasis:
    """n cubic B-splines on [low, high] and the whitening of their weights: c = W z, z ~ N(0, τ²)."""

    knots: Array
    pairs: tuple[Places, Places]
    whitening: Array

    @classmethod
    def on(cls, low: float, high: float, n: int) -> "SplineBasis":
        """Uniform knots and the smoothness prior of ``smoothness_whitening``."""
        knots = np.concatenate([[low] * 3, np.linspace(low, high, n - 2), [high] * 3])
        return cls(knots, np.triu_indices(n, 1), smoothness_whitening(n))

    def rows(self, to: Array, from_: Array) -> Array:
        """Rows (m, weights) of F(to, from_) in the whitened weights."""
        i, j = self.pairs
        a, b = self._splines(to), self._splines(from_)
        return (a[:, j] * b[:, i] - a[:, i] * b[:, j]) @ self.whitening

    def _splines(self, w: Array) -> Array:
        inside = np.clip(w, self.knots[0], self.knots[-1])
        return BSpline.design_matrix(inside, self.knots, 3).toarray()


def smoothness_whitening(n: int) -> Array:
    """W with W Wᵀ = (DᵀD + ε)⁻¹, D the second differences of c along both axes (c = 0 on the diagonal)."""
    i, j = np.triu_indices(n, 1)
    place = np.full((n, n), -1)
    place[i, j] = np.arange(i.size)
    D = []
    for a in range(n):
        for b in range(a, n):
            for cells in (((a, b), (a, b + 1), (a, b + 2)), ((a, b), (a + 1, b), (a + 2, b))):
                if cells[2][0] <= cells[2][1] < n:
                    row = np.zeros(i.size + 1)
                    row[[place[c] for c in cells]] = (1.0, -2.0, 1.0)
                    D.append(row[:-1])  # terms on the diagonal are zero: index −1 is dropped
    precision = np.transpose(np.array(D)) @ np.array(D) + _PROPER * np.eye(i.size)
    return np.asarray(np.linalg.inv(np.linalg.cholesky(precision)).T, dtype=float)


@dataclass(frozen=True, eq=False)
class SplineSurface:
    """The likeliest first-order surface of a record, and its uncertainty.

    ``values`` (levels, levels) on ``nodes``. ``errors`` (rows of the lower triangle, m): one standard deviation of
    each of m independent errors of the surface. ``sigma``: noise of one point.
    """

    nodes: Array
    values: Array
    errors: Array
    sigma: float
    unit: str

    @property
    def table(self) -> FodTable:
        """The likeliest surface."""
        return FodTable(self.nodes, self.values, self.unit)

    def draws(self, n: int, seed: int = 0) -> list[FodTable]:
        """n surfaces drawn from the posterior."""
        noise = self.errors @ np.random.default_rng(seed).standard_normal((self.errors.shape[1], n))
        where = np.tril_indices(self.nodes.size)
        tables = []
        for error in noise.T:
            values = self.values.copy()
            values[where] += error
            tables.append(FodTable(self.nodes, values, self.unit))
        return tables


def first_order_surface(record: ExtremumChains, points: Places) -> SplineSurface:
    """The smooth surface through some points of a record; DataError with fewer than 20 points."""
    if points.size < 20:
        raise DataError(
            f"{points.size} points on first-order curves do not determine a surface. Measure at least 20."
        )
    margin = 1e-6 * (record.upper - record.lower)
    basis = SplineBasis.on(record.lower - margin, record.upper + margin, _SPLINES)
    u, y, origin = np.append(record.u, record.lower), record.y[points], record.origin
    A = basis.rows(record.u, u[origin])
    for k in np.flatnonzero(origin >= 0):
        A[k] += A[origin[k]]
    centre, level = A[points].mean(axis=0), float(y.mean())
    rows, rest = A[points] - centre, y - level
    L, V = np.linalg.eigh(rows.T @ rows)
    L, b = np.maximum(L, 0.0), V.T @ (rows.T @ rest)
    free = y.size - 1

    def variance(ratio: float) -> float:
        return max(float(rest @ rest - np.sum(b * b / (L + ratio))), 1e-300) / free

    def deviance(log_ratio: float) -> float:
        ratio = np.exp(log_ratio)
        return np.sum(np.log1p(L / ratio)) + free * np.log(variance(ratio))

    best: Any = minimize_scalar(deviance, bounds=(-22.0, 5.0), method="bounded", options={"xatol": 1e-3})
    ratio = float(np.exp(best.x))
    weights, sigma = V @ (b / (L + ratio)), variance(ratio) ** 0.5
    modes = V * (sigma / np.sqrt(L + ratio))
    y_lower = level - float(centre @ weights)
    v = np.linspace(record.lower, record.upper, _LEVELS)
    i, j = np.tril_indices(_LEVELS)
    ascending = basis.rows(v, np.full(_LEVELS, record.lower))
    triangle = ascending[i] - basis.rows(v[i], v[j])
    values = np.full((_LEVELS, _LEVELS), np.nan)
    values[i, j] = y_lower + triangle @ weights
    return SplineSurface(v, values, np.asarray(triangle @ modes), sigma, record.unit)

"""A verified lower bound of the loop area over all loops of an analytic surface (5.5).

The triangle is cut into boxes. In a box of loops (M, m) ∈ [u_i, u_i+1] × [u_j, u_j+1] the smallest loop is
(u_i, u_j+1), and A grows from it by strip moments,

    A(M, m) = A(u_i, u_j+1) + ∫ ∂A/∂M + ∫ (−∂A/∂m)
    ∂A/∂M = 2∫_m^M μ(M, β)(M − β) dβ,    −∂A/∂m = 2∫_m^M μ(α, m)(α − m) dα,

each bounded below by interval arithmetic on μ, cell by cell. At a minimum inside the triangle the strip moments vanish,
so the bound approaches A with the square of the cell size. If no cell of the triangle under a box can be negative,
A ≥ 0 holds without computing A. This decides the diagonal, where A → 0 with the cube of the loop size, and the tails,
where A is below rounding. No sampling is used.

Bounds of the density μ of an analytic surface (5.5) over boxes, by interval arithmetic on its closed form.

μ lies between these bounds everywhere in a box; they are not samples.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach import FodSurface, FodTable, Interval, shift_bounds, sigmoid
from smarig.theory.energy.moments import areas_on

_EPS = float(np.finfo(float).eps)


def density_bounds(surface: FodSurface, a0: Array, a1: Array, b0: Array, b1: Array) -> Interval:
    """Bounds of 2μ over boxes [a0, a1] × [b0, b1] (output/K²), by interval arithmetic on its closed form

    2μ = c · a · x₄ s(1 − s) · [x₂(1 − a) + x₄ f′ (1 − 2s)],   a = σ(x₂(α + x₃)),   s = σ(x₄(β + f(α))).

    a and s(1 − s) are positive, so the bracket alone determines the sign, even where s(1 − s) underflows. Where terms
    of the bracket cancel, its bounds are widened by the rounding error.
    """
    x2, x3, x4 = surface.x[:3]
    f, df = shift_bounds(surface, Interval(a0, a1))
    a = Interval.hull(sigmoid(x2 * (a0 + x3)), sigmoid(x2 * (a1 + x3)))
    z = Interval.hull(x4 * (b0 + f.low), x4 * (b1 + f.high))
    bell0, bell1 = _bell(z.low), _bell(z.high)
    bell = Interval(
        np.minimum(bell0, bell1), np.where((z.low < 0) & (z.high > 0), 0.25, np.maximum(bell0, bell1))
    )
    tilt = Interval(-np.tanh(0.5 * z.high), -np.tanh(0.5 * z.low))  # 1 − 2s
    drift = df.times(x4) * tilt
    growth = Interval(1 - a.high, 1 - a.low).times(x2)
    slack = 4 * _EPS * (np.abs(growth.high) + drift.size)
    bracket = growth + drift + Interval(-slack, slack)
    return (a * bell * bracket).times(surface.amplitude * x4)


def _bell(z: Array) -> Array:
    """s(1 − s) without cancellation in the tails."""
    return 0.25 / np.cosh(np.minimum(0.5 * np.abs(z), 300.0)) ** 2


@dataclass(frozen=True, eq=False)
class DensityCells:
    """The triangle in n cells per axis of width ``h``: ``levels`` (n + 1,), ``low`` ≤ 2μ in cell (α i, β j), (n, n)."""

    levels: Array
    low: Array

    @classmethod
    def of(cls, surface: FodSurface, n: int) -> "DensityCells":
        """Bounds of the density of a surface in every cell on and below the diagonal."""
        levels = np.linspace(surface.lower, surface.upper, n + 1)
        low = np.zeros((n, n))
        i, j = np.tril_indices(n)
        low[i, j] = density_bounds(surface, levels[i], levels[i + 1], levels[j], levels[j + 1]).low
        return cls(levels, low)

    @property
    def h(self) -> float:
        """Width of a cell."""
        return float(self.levels[1] - self.levels[0])

    def across(self, near: Array, far: Array) -> Array:
        """Least 2∫_m^M μ(M, β) lever dβ over M in cell i, m in cell j, shape (n, n); zero above the diagonal.

        ``near`` and ``far`` (n, n) bound ∫ lever over one whole β cell, 0 ≤ near ≤ far.
        """
        whole, part = self._cellwise(near, far)
        return np.tril(
            np.flip(np.cumsum(np.flip(whole, 1), 1), 1) - whole + part + self._diagonal_part(part)[:, None]
        )

    def along(self, near: Array, far: Array) -> Array:
        """Least 2∫_m^M μ(α, m) lever dα over M in cell i, m in cell j, shape (n, n); zero above the diagonal."""
        whole, part = self._cellwise(near, far)
        return np.tril(np.cumsum(whole, 0) - whole + part + self._diagonal_part(part)[None, :])

    def has_no_negative_cell(self) -> NDArray[np.bool_]:
        """Whether no cell of the triangle under the largest loop of a box (i, j) can be negative."""
        negative = np.tril(self.low < 0)
        return np.cumsum(np.cumsum(negative, axis=0)[:, ::-1], axis=1)[:, ::-1] == 0

    def _cellwise(self, near: Array, far: Array) -> tuple[Array, Array]:
        """Contribution of a cell that the strip crosses entirely, and of one in which it may end."""
        return np.tril(np.minimum(self.low * near, self.low * far), -1), np.minimum(self.low, 0.0) * far

    @staticmethod
    def _diagonal_part(part: Array) -> Array:
        """Contribution of the triangle on the diagonal, which every strip touches."""
        return np.diag(part)


class AreaBound(NamedTuple):
    """Result for one subdivision: every loop area is at least ``low``; the smallest on the nodes is ``area``."""

    low: float
    area: float
    at: tuple[float, float]


def area_bound(surface: FodSurface, cells: int, rounding: float) -> AreaBound:
    """Lower bound of min A, and the smallest A on the nodes, from ``cells`` equal cells per axis.

    ``rounding`` is the possible error of an area on a node. It is subtracted wherever such an area is used.
    """
    cut = DensityCells.of(surface, cells)
    areas = areas_on(surface, cut.levels)
    i, j = np.tril_indices(cells, -1)
    below = areas[i, j + 1] - rounding + _growth(cut)[i, j]
    below = np.where(cut.has_no_negative_cell()[i, j], np.maximum(below, 0.0), below)
    inside_one_cell = np.minimum(np.diag(cut.low), 0.0) * cut.h**3 / 6
    i, j = np.tril_indices(cells + 1, -1)
    worst = int(np.argmin(areas[i, j]))
    at = (float(cut.levels[i[worst]]), float(cut.levels[j[worst]]))
    return AreaBound(float(min(below.min(), inside_one_cell.min())), float(areas[i, j][worst]), at)


def _growth(cut: DensityCells) -> Array:
    """Least growth of A inside each box from its smallest loop, shape (n, n)."""
    gap = cut.levels[:-1, None] - cut.levels[:-1]
    near, far = cut.h * np.maximum(gap - cut.h / 2, 0.0), cut.h * np.maximum(gap + cut.h / 2, 0.0)
    rates = np.minimum(cut.across(near, far), 0.0) + np.minimum(cut.along(near, far), 0.0)
    return cut.h * rates


def negative_small_loop(surface: FodSurface, points: int = 257) -> tuple[float, tuple[float, float]] | None:
    """A loop at the diagonal proved to have A < 0, because μ < 0 in all of it: (upper bound of A, (M, m)).

    Where μ(u, u) < 0, every small enough loop about u has A ≤ 2 max μ · (M − m)³/6 < 0, even if that is below
    rounding. None if μ(u, u) ≥ 0 at all ``points`` of the diagonal that are evaluated.
    """
    u = np.linspace(surface.lower, surface.upper, points)
    worst = float(u[np.argmin(density_bounds(surface, u, u, u, u).high)])
    reach = float(u[1] - u[0])
    for _ in range(60):
        low, high = max(worst - reach / 2, surface.lower), min(worst + reach / 2, surface.upper)
        ends = np.array([low]), np.array([high])
        most = float(density_bounds(surface, *ends, *ends).high[0])
        if most < 0:
            return most * (high - low) ** 3 / 6, (high, low)
        reach /= 2
    return None


def least_area(table: FodTable) -> tuple[float, tuple[float, float]]:
    """min A over all loops m < M of a table, and its loop (M, m). It is zero if no loop is negative.

    The degenerate loop M = m is included, so the minimum is never positive.
    """
    u = table.nodes
    width = np.diff(u)
    density = _densities(table)
    areas = areas_on(table, u)
    best, at = 0.0, (float(u[1]), float(u[0]))
    middle = (u[1:] + u[:-1]) / 2
    for i in range(1, width.size):
        for j in range(i):
            between = slice(j + 1, i)
            row, column = density[i, between] * width[between], density[between, j] * width[between]
            cell = AreaPolynomial(
                float(areas[i, j + 1]),
                (float(row @ (u[i] - middle[between])), float(row.sum() / 2)),
                (float(column @ (middle[between] - u[j + 1])), float(column.sum() / 2)),
                float(density[i, j]),
                float(u[i] - u[j + 1]),
            )
            area, s, t = cell.minimum(float(width[i]), float(width[j]))
            if area < best:
                best, at = area, (float(u[i] + s), float(u[j + 1] - t))
    return best, at


def _densities(table: FodTable) -> Array:
    """c = 2μ of every rectangle (α cell, β cell), zero on and above the diagonal cells."""
    u = table.nodes
    grown = table.swept(np.maximum(u[:, None], u), u)
    second = grown[1:, :-1] - grown[:-1, :-1] - grown[1:, 1:] + grown[:-1, 1:]
    return np.tril(second / np.outer(np.diff(u), np.diff(u)), -1)


class AreaPolynomial:
    """A(s, t) = area + a₁s + a₂s² + b₁t + b₂t² + c s t (h + (s + t)/2) on [0, w] × [0, v]."""

    def __init__(
        self, area: float, a: tuple[float, float], b: tuple[float, float], c: float, h: float
    ) -> None:
        self.area, self.a, self.b, self.c, self.h = area, a, b, c, h

    def __call__(self, s: float, t: float) -> float:
        across, along = (self.a[0] + self.a[1] * s) * s, (self.b[0] + self.b[1] * t) * t
        return self.area + across + along + self.c * s * t * (self.h + (s + t) / 2)

    def minimum(self, w: float, v: float) -> tuple[float, float, float]:
        """Least value on the cell, with its s and t."""
        points = [(0.0, 0.0), (w, 0.0), (0.0, v), (w, v)]
        points += [(s, t) for t in (0.0, v) if (s := self._stationary_s(t)) is not None]
        points += [(s, t) for s in (0.0, w) if (t := self._stationary_t(s)) is not None]
        points += [(s, t) for t in self._interior_t() if (s := self._stationary_s(t)) is not None]
        return min((self(s, t), s, t) for s, t in points if 0.0 <= s <= w and 0.0 <= t <= v)

    def _stationary_s(self, t: float) -> float | None:
        """The root s of ∂A/∂s = 0, which is linear in s."""
        slope = 2 * self.a[1] + self.c * t
        return None if slope == 0.0 else -(self.a[0] + self.c * t * (self.h + t / 2)) / slope

    def _stationary_t(self, s: float) -> float | None:
        slope = 2 * self.b[1] + self.c * s
        return None if slope == 0.0 else -(self.b[0] + self.c * s * (self.h + s / 2)) / slope

    def _interior_t(self) -> list[float]:
        """t where also ∂A/∂t = 0, with s = N/D from ∂A/∂s = 0: roots of a quartic."""
        (a1, a2), (b1, b2), c, h = self.a, self.b, self.c, self.h
        t = Polynomial([0.0, 1.0])
        n, d = -(a1 + c * t * (h + t / 2)), 2 * a2 + c * t
        quartic = (b1 + 2 * b2 * t) * d**2 + c * n * d * (h + t) + c / 2 * n**2
        roots = quartic.trim().roots()
        near_real = np.abs(roots.imag) <= 1e-7 * (1 + np.abs(roots.real))
        return roots.real[near_real].tolist()

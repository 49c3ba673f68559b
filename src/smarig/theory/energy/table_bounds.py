"""The exact minimum of the loop area over a FOD table: a polynomial in each cell, minimised cell by cell.

A bilinear table has a constant density 2μ = c on every rectangle and none on the cells cut by the diagonal.
For a loop with its corner in the rectangle (i, j), s = M − u_i and t = u_{j+1} − m,

    A = A(u_i, u_{j+1}) + a₁s + a₂s² + b₁t + b₂t² + c s t (h + (s + t)/2),    h = u_i − u_{j+1},

so its minimum is at a corner, on an edge (where A is a parabola) or at a root of a quartic. Knows FodTable.
"""

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.theory.energy.moments import areas_on

Array = NDArray[np.float64]


def least_area(table: FodTable) -> tuple[float, tuple[float, float]]:
    """min A over all loops m < M of a table, and the loop (M, m); zero if no loop is negative.

    The degenerate loop M = m counts, so the minimum is never positive.
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
        """Least value on the cell, and s, t there."""
        points = [(0.0, 0.0), (w, 0.0), (0.0, v), (w, v)]
        points += [(s, t) for t in (0.0, v) if (s := self._stationary_s(t)) is not None]
        points += [(s, t) for s in (0.0, w) if (t := self._stationary_t(s)) is not None]
        points += [(s, t) for t in self._interior_t() if (s := self._stationary_s(t)) is not None]
        return min((self(s, t), s, t) for s, t in points if 0.0 <= s <= w and 0.0 <= t <= v)

    def _stationary_s(self, t: float) -> float | None:
        """∂A/∂s = 0 is linear in s."""
        slope = 2 * self.a[1] + self.c * t
        return None if slope == 0.0 else -(self.a[0] + self.c * t * (self.h + t / 2)) / slope

    def _stationary_t(self, s: float) -> float | None:
        slope = 2 * self.b[1] + self.c * s
        return None if slope == 0.0 else -(self.b[0] + self.c * s * (self.h + s / 2)) / slope

    def _interior_t(self) -> list[float]:
        """t where ∂A/∂t = 0 too, with s = N/D from ∂A/∂s = 0: a quartic."""
        (a1, a2), (b1, b2), c, h = self.a, self.b, self.c, self.h
        t = Polynomial([0.0, 1.0])
        n, d = -(a1 + c * t * (h + t / 2)), 2 * a2 + c * t
        quartic = (b1 + 2 * b2 * t) * d**2 + c * n * d * (h + t) + c / 2 * n**2
        roots = quartic.trim().roots()
        near_real = np.abs(roots.imag) <= 1e-7 * (1 + np.abs(roots.real))
        return roots.real[near_real].tolist()

"""Bounds of the density μ of an analytic surface (5.5) over boxes, by interval arithmetic on its closed form.

μ lies between these bounds everywhere in a box; they are not samples.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach import FodSurface, Interval, shift_bounds, sigmoid

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

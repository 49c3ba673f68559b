"""A table of FOD data as a hysteresis: bilinear on the triangle, exact at its nodes (thesis §3.4).

Rectangles are bilinear; on the cells cut by the diagonal α = β the surface is linear. No fit, no
differentiation: this is the interpolation the thesis mentions and does not use. Knows no noise.
"""

from bisect import bisect_right
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.errors import DataError
from smarig.preisach.everett import fall_integral, rise_integral

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FodTable:
    """y(u_i, u_j) for j ≤ i on one partition u (n,), strictly increasing; NaN above the diagonal.

    The row u_0 is negative saturation; the output there is y[0, 0], and a table whose rows end
    differently at u_0 (curves that do not merge, §5.4.1) is made to merge by its mean, as the thesis does.
    """

    nodes: Array
    values: Array
    unit: str = ""
    _grid: list[float] = field(init=False, repr=False, compare=False)
    _rows: list[list[float]] = field(init=False, repr=False, compare=False)
    _drops: list[list[float]] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _check(self.nodes, self.values)
        object.__setattr__(self, "_grid", self.nodes.tolist())
        object.__setattr__(self, "_rows", self.values.tolist())
        drops = np.diag(self.values)[:, None] - self.values  # F at the nodes
        object.__setattr__(self, "_drops", drops.tolist())

    @classmethod
    def from_arrays(cls, alpha: ArrayLike, beta: ArrayLike, y: ArrayLike, unit: str = "") -> "FodTable":
        """From y[i, j] at (α_i, β_j); both axes must be the same partition or α its upper part."""
        a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
        values = np.asarray(y, dtype=float)
        if values.shape != (a.size, b.size):
            raise DataError(
                f"FOD table has shape {values.shape}, expected ({a.size}, {b.size}) for its axes."
            )
        if a.size < b.size and np.array_equal(a, b[b.size - a.size :]):
            return cls(b, _merged(np.vstack([np.full((b.size - a.size, b.size), np.nan), values])), unit)
        if not np.array_equal(a, b):
            raise DataError("FOD table axes differ: α and β must share one partition.")
        return cls(b, _merged(values), unit)

    @property
    def lower(self) -> float:
        """Negative saturation u₋."""
        return self._grid[0]

    @property
    def upper(self) -> float:
        """Positive saturation u₊."""
        return self._grid[-1]

    @property
    def y_lower(self) -> float:
        """Output at negative saturation."""
        return self._rows[0][0]

    @property
    def kinks(self) -> Array:
        """Where derivatives jump: the partition."""
        return self.nodes

    def y(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """y(α, β), vectorised."""
        return np.vectorize(self._value, otypes=[float])(alpha, beta)

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) = y(α, α) − y(α, β): bilinear in its own nodes, linear on the diagonal cells."""
        i, s = self._cell(alpha)
        j, t = self._cell(beta)
        low, high = self._drops[i], self._drops[i + 1]
        if j >= i:
            return (s - t) * high[i]
        near = low[j] + t * (low[j + 1] - low[j])
        far = high[j] + t * (high[j + 1] - high[j])
        return near + s * (far - near)

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β), arrays."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        drops, last = np.asarray(self._drops), self.nodes.size - 2
        i = np.clip(np.searchsorted(self.nodes, a, side="right") - 1, 0, last)
        j = np.clip(np.searchsorted(self.nodes, b, side="right") - 1, 0, last)
        width = np.diff(self.nodes)
        s, t = (a - self.nodes[i]) / width[i], (b - self.nodes[j]) / width[j]
        near = drops[i, j] + t * (drops[i, j + 1] - drops[i, j])
        far = drops[i + 1, j] + t * (drops[i + 1, j + 1] - drops[i + 1, j])
        return np.where(j >= i, (s - t) * drops[i + 1, i], near + s * (far - near))

    def _cell(self, u: float) -> tuple[int, float]:
        grid = self._grid
        k = bisect_right(grid, u, 1, len(grid) - 1) - 1
        return k, (u - grid[k]) / (grid[k + 1] - grid[k])

    def _value(self, alpha: float, beta: float) -> float:
        i, s = self._cell(alpha)
        j, t = self._cell(beta)
        low, high = self._rows[i], self._rows[i + 1]
        if j >= i:  # the diagonal cell: linear on the triangle (i,i), (i+1,i), (i+1,i+1)
            return low[i] + s * (high[i] - low[i]) + (t if j == i else s) * (high[i + 1] - high[i])
        near = low[j] + t * (low[j + 1] - low[j])
        far = high[j] + t * (high[j + 1] - high[j])
        return near + s * (far - near)

    def strip_alpha(self, alpha: Array, beta: Array) -> Array:
        """∂F/∂α, constant in α inside a cell."""
        return np.vectorize(self._strip_alpha, otypes=[float])(alpha, beta)

    def strip_beta(self, alpha: Array, beta: Array) -> Array:
        """∂y/∂β, constant in β inside a cell."""
        return np.vectorize(self._strip_beta, otypes=[float])(alpha, beta)

    def _strip_alpha(self, alpha: float, beta: float) -> float:
        i, _ = self._cell(alpha)
        j, t = self._cell(beta)
        width = self._grid[i + 1] - self._grid[i]
        low, high = self._rows[i], self._rows[i + 1]
        diagonal = high[i + 1] - low[i]
        if j >= i:
            return (diagonal - (high[i] - low[i])) / width
        slope = (high[j] - low[j]) * (1 - t) + (high[j + 1] - low[j + 1]) * t
        return (diagonal - slope) / width

    def _strip_beta(self, alpha: float, beta: float) -> float:
        i, s = self._cell(alpha)
        j, _ = self._cell(beta)
        j = min(j, i)
        width = self._grid[j + 1] - self._grid[j]
        low, high = self._rows[i], self._rows[i + 1]
        far = high[j + 1] - high[j]
        return far / width if j == i else ((1 - s) * (low[j + 1] - low[j]) + s * far) / width

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Output change rising from B_ℓ, exact per crossed cell."""
        return rise_integral(self, centre, u)

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Output change falling from B_ℓ, exact per crossed cell."""
        return fall_integral(self, centre, u)


def _check(nodes: Array, values: Array) -> None:
    if nodes.size < 2 or np.any(np.diff(nodes) <= 0):
        raise DataError("FOD table: the partition must be at least two strictly increasing inputs.")
    missing = np.argwhere(~np.isfinite(values) & np.tri(nodes.size, dtype=bool))
    if missing.size:
        i, j = missing[0]
        raise DataError(
            f"FOD table: no value at α = {nodes[i]:g}, β = {nodes[j]:g}; every β ≤ α is needed "
            "(measure the missing curve, or fit a surface instead)."
        )


def _merged(values: Array) -> Array:
    """Let all curves end at one negative saturation output (their mean, §5.5)."""
    merged = values.copy()
    ends = values[~np.isnan(values[:, 0]), 0]
    merged[:, 0] = ends.mean() if ends.size else np.nan
    return merged

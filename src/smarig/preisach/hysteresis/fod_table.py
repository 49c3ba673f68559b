"""A table of FOD data as a hysteresis: bilinear on the triangle, exact at its nodes (thesis §3.4).

The table is bilinear on rectangles and linear on the cells cut by the diagonal α = β. It needs no fit and no
differentiation. The thesis mentions this interpolation but does not use it.
"""

from bisect import bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import NOT_NUMBERS, Array, DataError
from smarig.preisach.everett import DiagonalIntegrals
from smarig.preisach.kernel import CompiledKeys, KeyedEverett

Cells = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class FodTable(DiagonalIntegrals):
    """y(u_i, u_j) for j ≤ i on one strictly increasing partition u (n,); NaN above the diagonal.

    The row u_0 is negative saturation, with output y[0, 0]. If the curves of a table end at different outputs at u_0
    (they do not merge, §5.4.1), their mean replaces these outputs, as in the thesis.
    """

    nodes: Array
    values: Array
    unit: str = ""
    _filled: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _check(self.nodes, self.values)
        # Values above the diagonal are only ever multiplied by zero; a finite number there prevents NaN.
        object.__setattr__(self, "_filled", np.where(np.tri(self.nodes.size, dtype=bool), self.values, 0.0))

    @classmethod
    def from_arrays(cls, alpha: ArrayLike, beta: ArrayLike, y: ArrayLike, unit: str = "") -> "FodTable":
        """A table from y[i, j] at (α_i, β_j). Both axes are the same partition, or α is its upper part."""
        try:
            a, b, values = (np.asarray(x, dtype=float) for x in (alpha, beta, y))
        except NOT_NUMBERS:
            raise DataError("FOD table: inputs α, β and outputs y must be numbers below 1.8e308.") from None
        if a.ndim != 1 or b.ndim != 1 or min(a.size, b.size) < 2:
            raise DataError("FOD table: each axis must be one row of at least two inputs.")
        if values.shape != (a.size, b.size):
            raise DataError(
                f"FOD table has shape {values.shape}, expected ({a.size}, {b.size}) for its axes."
            )
        if a.size < b.size and np.array_equal(a, b[b.size - a.size :]):
            return cls(b, _merged(np.vstack([np.full((b.size - a.size, b.size), np.nan), values])), unit)
        if not np.array_equal(a, b):
            raise DataError("FOD table axes differ: α and β must share one partition.")
        return cls(b, _merged(values), unit)

    @cached_property
    def _inner(self) -> Array:
        return self.nodes[1:-1]

    @property
    def lower(self) -> float:
        """Negative saturation u₋."""
        return float(self.nodes[0])

    @property
    def upper(self) -> float:
        """Positive saturation u₊."""
        return float(self.nodes[-1])

    @property
    def y_lower(self) -> float:
        """Output at negative saturation."""
        return float(self.values[0, 0])

    @property
    def kinks(self) -> Array:
        """Inputs at which derivatives jump: the partition."""
        return self.nodes

    @cached_property
    def keyed(self) -> KeyedEverett:
        """For the loop: an input's key is the number of its cell plus its position in the cell, 0 … n − 1."""
        drops = self.drops
        nodes = self.nodes.tolist()
        return KeyedEverett(
            _between,
            (nodes, nodes[1:-1], drops.ravel().tolist(), len(drops)),
            _place,
            self._places,
            _COMPILED,
        )

    @property
    def drops(self) -> Array:
        """F at the nodes (n + 1, n + 1), with an unused last cell."""
        drops = np.zeros((self.nodes.size + 1,) * 2)
        drops[:-1, :-1] = np.diag(self._filled)[:, None] - self._filled
        return drops

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) = y(α, α) − y(α, β): bilinear between its nodes, linear on the diagonal cells."""
        k, low, high = self.keyed, self.lower, self.upper
        a, _ = k.place(k.params, min(max(alpha, low), high))
        b, _ = k.place(k.params, min(max(beta, low), high))
        return _between(k.params, a, b)

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays."""
        i, s, j, t = self._cells(alpha, beta)
        drops = np.diag(self._filled)[:, None] - self._filled
        near = drops[i, j] + t * (drops[i, j + 1] - drops[i, j])
        far = drops[i + 1, j] + t * (drops[i + 1, j + 1] - drops[i + 1, j])
        return np.where(j >= i, (s - t) * drops[i + 1, i], near + s * (far - near))

    def y(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """y(α, β), vectorised."""
        i, s, j, t = self._cells(alpha, beta)
        rows = self._filled
        near = rows[i, j] + t * (rows[i, j + 1] - rows[i, j])
        far = rows[i + 1, j] + t * (rows[i + 1, j + 1] - rows[i + 1, j])
        # the diagonal cell is linear on the triangle (i,i), (i+1,i), (i+1,i+1)
        rise, fall = rows[i + 1, i] - rows[i, i], rows[i + 1, i + 1] - rows[i + 1, i]
        on_diagonal = rows[i, i] + s * rise + np.where(j == i, t, s) * fall
        return np.where(j >= i, on_diagonal, near + s * (far - near))

    def strip_alpha(self, alpha: Array, beta: Array) -> Array:
        """∂F/∂α, constant in α inside a cell."""
        i, _, j, t = self._cells(alpha, beta)
        rows, width = self._filled, np.diff(self.nodes)[i]
        diagonal = rows[i + 1, i + 1] - rows[i, i]
        slope = (rows[i + 1, j] - rows[i, j]) * (1 - t) + (rows[i + 1, j + 1] - rows[i, j + 1]) * t
        return (diagonal - np.where(j >= i, rows[i + 1, i] - rows[i, i], slope)) / width

    def strip_beta(self, alpha: Array, beta: Array) -> Array:
        """∂y/∂β, constant in β inside a cell."""
        i, s, j, _ = self._cells(alpha, beta)
        j = np.minimum(j, i)
        rows, width = self._filled, np.diff(self.nodes)[j]
        far, near = rows[i + 1, j + 1] - rows[i + 1, j], rows[i, j + 1] - rows[i, j]
        return np.where(j == i, far, (1 - s) * near + s * far) / width

    def _cells(self, alpha: ArrayLike, beta: ArrayLike) -> tuple[Cells, Array, Cells, Array]:
        """Cell and position in it, 0 … 1, of α and of β (broadcast). Inputs beyond saturation are saturated."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        return *self._cell(a), *self._cell(b)

    def _cell(self, u: Array) -> tuple[Cells, Array]:
        nodes = self.nodes
        k = np.searchsorted(self._inner, u, "right")
        return k, (np.clip(u, nodes[0], nodes[-1]) - nodes[k]) / (nodes[k + 1] - nodes[k])

    def _places(self, u: Array) -> tuple[Array, Array]:
        """``_place`` for arrays (n,)."""
        k, part = self._cell(u)
        place = k + part
        return place, place


def _place(params: Any, u: float) -> tuple[float, float]:
    nodes, inner, _, _ = params
    k = bisect_right(inner, u)
    place = k + (u - nodes[k]) / (nodes[k + 1] - nodes[k])
    return place, place


def _compiled_place(params: Any, u: float, rank: Any) -> float:
    nodes, inner, _, _ = params
    k = rank(inner, u)
    return k + (u - nodes[k]) / (nodes[k + 1] - nodes[k])


def _between(params: Any, a: float, b: float) -> float:
    _, _, drops, width = params
    i, j = int(a), int(b)
    s, t = a - i, b - j
    high = (i + 1) * width
    if j >= i:
        return (s - t) * drops[high + i]
    k, m = i * width + j, high + j
    near = drops[k] + t * (drops[k + 1] - drops[k])
    far = drops[m] + t * (drops[m + 1] - drops[m])
    return near + s * (far - near)


def _check(nodes: Array, values: Array) -> None:
    if nodes.ndim != 1 or nodes.size < 2 or not np.isfinite(nodes).all() or np.any(np.diff(nodes) <= 0):
        raise DataError("FOD table: the partition must be at least two strictly increasing inputs.")
    missing = np.argwhere(~np.isfinite(values) & np.tri(nodes.size, dtype=bool))
    if missing.size:
        i, j = missing[0]
        raise DataError(
            f"FOD table: no value at α = {nodes[i]:g}, β = {nodes[j]:g}; every β ≤ α is needed. "
            "Measure the missing curve, or fit a surface."
        )


def _merged(values: Array) -> Array:
    """Make all curves end at one output in negative saturation, their mean (§5.5)."""
    merged = values.copy()
    ends = values[~np.isnan(values[:, 0]), 0]
    merged[:, 0] = ends.mean() if ends.size else np.nan
    return merged


_COMPILED = CompiledKeys(_compiled_place, _compiled_place, ((1, "right"),))

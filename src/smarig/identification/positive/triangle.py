"""The Preisach triangle, cut into cells along one partition: the unknowns of the ``positive`` identification.

The unknowns are the FOD surface at the nodes, y(u_i, u_j) for i ≥ j ≥ 1, row by row, and last the output y₋ of
negative saturation, where all curves merge. Between nodes y is bilinear, on diagonal cells linear, as in
``FodTable``. So the density is constant on each cell, cells on the diagonal are reversible, and the mass of a cell
is a difference of neighbouring unknowns. Everything here is a sparse matrix from the unknowns to a measurable
quantity. Inputs are scaled to [0, 1].
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix, vstack

from smarig.core import Array, DataError
from smarig.preisach import FodTable

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Triangle:
    """Cells (i, j), i ≥ j, between ``nodes`` (N + 1,): cell k spans α in [u_i, u_i+1] and β in [u_j, u_j+1]."""

    nodes: Array
    place: Array | None = None
    i: Integers = field(init=False, repr=False)
    j: Integers = field(init=False, repr=False)
    _unknown: Integers = field(init=False, repr=False)
    _cell: Integers = field(init=False, repr=False)
    _x: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.nodes.size < 4 or np.any(np.diff(self.nodes) <= 0):
            raise DataError("A triangle of cells needs at least four strictly increasing nodes.")
        n = self.nodes.size - 1
        i, j = (index.astype(np.int64) for index in np.tril_indices(n))
        cell, unknown = np.full((n, n), -1), np.full((n + 1, n + 1), -1)
        cell[i, j] = unknown[i + 1, j + 1] = np.arange(i.size)
        unknown[:, 0] = i.size
        span = self.nodes[-1] - self.nodes[0]
        values = {
            "i": i,
            "j": j,
            "_cell": cell,
            "_unknown": unknown,
            "_x": (self.nodes - self.nodes[0]) / span,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def cells(self) -> int:
        """Number of cells, including the diagonal."""
        return self.i.size

    @property
    def unknowns(self) -> int:
        """Number of unknowns: one per cell, and y₋."""
        return self.i.size + 1

    @property
    def _scaled_nodes(self) -> Array:
        return self._x if self.place is None else self.place

    @property
    def areas(self) -> Array:
        """Measure of each cell in scaled inputs: area, or length on the diagonal, (cells,)."""
        w = np.diff(self._scaled_nodes)
        return np.where(self.i == self.j, w[self.i], w[self.i] * w[self.j])

    def scaled(self, u: ArrayLike) -> Array:
        """Inputs on the scale with the range [0, 1], clipped to it."""
        lower, upper = self.nodes[0], self.nodes[-1]
        return np.clip((np.asarray(u, dtype=float) - lower) / (upper - lower), 0.0, 1.0)

    # --- measurable quantities, as rows over the unknowns -------------------------------------------------

    def values(self, alpha: ArrayLike, beta: ArrayLike) -> csr_matrix:
        """y(α, β), (m, unknowns)."""
        i, j, s, t = self._located(alpha, beta)
        on = i == j
        rows = _SparseRows(self.unknowns, i.size)
        for di, dj, weight in (
            (0, 0, np.where(on, 1 - s, (1 - s) * (1 - t))),
            (1, 0, np.where(on, s - t, s * (1 - t))),
            (0, 1, np.where(on, 0.0, (1 - s) * t)),
            (1, 1, np.where(on, t, s * t)),
        ):
            rows.add(self._unknown[i + di, np.minimum(j + dj, i + di)], weight)
        return rows.matrix()

    def falling_slope(self, alpha: ArrayLike, beta: ArrayLike) -> csr_matrix:
        """∂y/∂β per scaled input, (m, unknowns)."""
        i, j, s, _ = self._located(alpha, beta)
        width = np.diff(self._x)[j]
        s = np.where(i == j, 1.0, s) / width
        rest = np.where(i == j, 0.0, 1 / width - s)
        rows = _SparseRows(self.unknowns, i.size)
        for di, dj, weight in ((0, 0, -rest), (0, 1, rest), (1, 0, -s), (1, 1, s)):
            rows.add(self._unknown[i + di, np.minimum(j + dj, i + di)], weight)
        return rows.matrix()

    def rising_slope(self, alpha: ArrayLike, beta: ArrayLike) -> csr_matrix:
        """∂F/∂α per scaled input, F(α, β) = y(α, α) − y(α, β), (m, unknowns)."""
        i, j, _, t = self._located(alpha, beta)
        width, on = np.diff(self._x)[i], i == j
        near, far = np.where(on, 1.0, 1 - t) / width, np.where(on, 0.0, t) / width
        rows = _SparseRows(self.unknowns, i.size)
        rows.add(self._unknown[i + 1, i + 1], 1 / width)
        rows.add(self._unknown[i, i], -1 / width)
        for di, dj, weight in ((1, 0, -near), (0, 0, near), (1, 1, -far), (0, 1, far)):
            rows.add(self._unknown[i + di, np.minimum(j + dj, i + di)], weight)
        return rows.matrix()

    def _located(self, alpha: ArrayLike, beta: ArrayLike) -> tuple[Integers, Integers, Array, Array]:
        a, b = np.broadcast_arrays(self.scaled(alpha), self.scaled(beta))
        last = self._x.size - 2
        i = np.clip(np.searchsorted(self._x, a, side="right") - 1, 0, last)
        j = np.minimum(np.clip(np.searchsorted(self._x, b, side="right") - 1, 0, last), i)
        width = np.diff(self._x)
        return i, j, (a - self._x[i]) / width[i], (b - self._x[j]) / width[j]

    # --- mass, smoothness, and table --------------------------------------------------

    @cached_property
    def masses(self) -> csr_matrix:
        """(cells, unknowns): maps the unknowns to ν of each cell, an output change."""
        i, j = self.i, self.j
        inner = np.where(i == j, 0.0, 1.0)  # on the diagonal ν is F(u_i+1, u_i) alone
        rows = _SparseRows(self.unknowns, i.size)
        for di, dj, sign in (
            (1, 1, 1.0 + 0 * inner),
            (1, 0, -1.0 + 0 * inner),
            (0, 1, -inner),
            (0, 0, inner),
        ):
            rows.add(self._unknown[i + di, np.minimum(j + dj, i + di)], sign)
        return rows.matrix()

    def _second_differences(self) -> csr_matrix:
        """Second differences of ρ = 2μ and of g over the cells, times the root of the area of each."""
        i, j, cell = self.i, self.j, self._cell
        n, width = self._scaled_nodes.size - 1, np.diff(self._scaled_nodes)
        middle = (self._scaled_nodes[1:] + self._scaled_nodes[:-1]) / 2
        root = np.sqrt(width[i] * width[j])
        differences = []
        for di, dj, at, allowed in (
            (1, 0, i, (i - 1 > j) & (i + 1 < n)),
            (0, 1, j, (j >= 1) & (j + 1 < i)),
            (1, 1, i, (i == j) & (i >= 1) & (i + 1 < n)),
        ):
            p, q, k = i[allowed], j[allowed], at[allowed]
            before, after = middle[k] - middle[k - 1], middle[k + 1] - middle[k]
            weight = np.sqrt(width[k]) if di == dj else root[allowed]
            rows = _SparseRows(self.cells, p.size)
            rows.add(cell[p - di, q - dj], 2 / (before * (before + after)) * weight)
            rows.add(cell[p, q], -2 / (before * after) * weight)
            rows.add(cell[p + di, q + dj], 2 / (after * (before + after)) * weight)
            differences.append(rows.matrix())
        allowed = (i + 1 < n) & (j + 1 < i)
        p, q = i[allowed], j[allowed]
        twist = np.sqrt(2 / ((middle[p + 1] - middle[p]) * (middle[q + 1] - middle[q])))
        rows = _SparseRows(self.cells, p.size)
        for di, dj, sign in ((0, 0, 1), (1, 0, -1), (0, 1, -1), (1, 1, 1)):
            rows.add(cell[p + di, q + dj], sign * twist)
        return csr_matrix(vstack([*differences, rows.matrix()]).multiply(1 / self.areas))

    @cached_property
    def roughness(self) -> csr_matrix:
        """∬ (ρ_αα² + 2ρ_αβ² + ρ_ββ²) + ∫ g″² as a quadratic form of the unknowns, scaled inputs."""
        matrix = self._second_differences() @ self.masses
        return csr_matrix(matrix.T @ matrix)

    @cached_property
    def roughness_of_masses(self) -> csr_matrix:
        """The same as a quadratic form of the masses, (cells, cells)."""
        matrix = self._second_differences()
        return csr_matrix(matrix.T @ matrix)

    def table(self, masses: Array, y_lower: float, unit: str = "") -> FodTable:
        """The hysteresis with these cell masses (cells,): y(u_i, u_j) = y₋ + Σ of the cells below."""
        n = self._x.size - 1
        grid = np.zeros((n + 1, n + 1))
        grid[self.i + 1, self.j + 1] = masses
        values = y_lower + np.cumsum(np.cumsum(grid, axis=0), axis=1)
        return FodTable(self.nodes, np.where(np.tri(n + 1, dtype=bool), values, np.nan), unit)


class _SparseRows:
    """Collects one column and one weight per row at a time; weights of the same place are added."""

    def __init__(self, columns: int, rows: int) -> None:
        self._shape = (rows, columns)
        self._columns: list[Integers] = []
        self._weights: list[Array] = []

    def add(self, columns: Integers, weights: Array) -> None:
        self._columns.append(columns)
        self._weights.append(np.asarray(weights, dtype=float))

    def matrix(self) -> csr_matrix:
        where = np.tile(np.arange(self._shape[0]), len(self._columns))
        data = (np.concatenate(self._weights), (where, np.concatenate(self._columns)))
        matrix = csr_matrix(data, shape=self._shape)
        matrix.eliminate_zeros()
        return matrix

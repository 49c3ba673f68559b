"""Many fits of a non-negative measure to the same readings: least squares with a smooth prior, over masses ≥ 0.

    minimise  ‖Xx − y‖²/m + λ (roughness) + ε ‖θ‖²      over masses ≥ 0

x holds the masses of the cells, y₋, and free unknowns; θ are the unknowns of the triangle, sums of masses, and the free
ones. It is the programme of ``quadratic_programme``. With masses as unknowns, the constraints are bounds, so fits with
similar active constraints (a block of readings left out, other gains) start from each other.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, eye_array

from smarig.core import Array
from smarig.identification.positive.interior_point import NewtonSystem, solve
from smarig.identification.positive.observations import Observations
from smarig.identification.positive.quadratic_programme import RIDGE, solve_by_pivoting
from smarig.identification.positive.triangle import Triangle

Mask = NDArray[np.bool_]
ACCURACY = 1e-5  # of the interior point, sufficient for comparisons
ZERO = 1e-8  # of the output's range: a smaller mass counts as zero


@dataclass(frozen=True, eq=False)
class CellRows:
    """Readings (m,) as sums over the cells of a triangle and y₋: what all fits under the same inputs share."""

    observations: Observations
    triangle: Triangle

    @cached_property
    def of_unknowns(self) -> csr_matrix:
        """Rows over the unknowns of the triangle, (m, unknowns)."""
        rows = self.observations.matrix(self.triangle)
        return csr_matrix(rows[:, : self.triangle.unknowns])

    @property
    def of_masses(self) -> Array:
        """Rows over the masses and y₋, (m, cells + 1)."""
        return _rows_of_masses(self)

    @cached_property
    def squares(self) -> csr_matrix:
        """Squares of the rows over the unknowns of the triangle, transposed, (unknowns, m)."""
        return csr_matrix(self.of_unknowns.power(2).T)

    @cached_property
    def roughness(self) -> csr_matrix:
        """The roughness as a quadratic form of the masses, (cells, cells)."""
        return self.triangle.roughness_of_masses

    @cached_property
    def roughness_diagonal(self) -> Array:
        """Diagonal (unknowns,) of the roughness as a quadratic form of the triangle's unknowns."""
        return np.asarray(self.triangle.roughness.diagonal(), dtype=float)


@lru_cache(maxsize=4)  # dense: a search keeps many hypotheses
def _rows_of_masses(cells: CellRows) -> Array:
    return np.asarray(cells.of_unknowns @ unknowns_of_masses(cells.triangle.nodes.size - 1), dtype=float)


@lru_cache(maxsize=4)
def unknowns_of_masses(intervals: int) -> Array:
    """The unknowns of a triangle as sums of the masses of its cells and y₋, (cells + 1, cells + 1)."""
    i, j = np.tril_indices(intervals)
    found = np.ones((i.size + 1, i.size + 1))
    found[:-1, :-1] = (i[:, None] >= i) & (j[:, None] >= j)
    found[-1, :-1] = 0.0
    return found


@lru_cache(maxsize=4)
def _sum_of_squares(intervals: int) -> Array:
    """‖θ‖² as a quadratic form of masses and y₋."""
    sums = unknowns_of_masses(intervals)
    return sums.T @ sums


@dataclass(frozen=True, eq=False)
class MassProgramme:
    """Rows (m, cells + 1 + k): those of ``cells`` times ``factor`` (m,), then ``columns`` (m, k) of free unknowns.

    ``y`` (m,) are the outputs in units of their range. Factor, columns and outputs contain the weights.
    """

    cells: CellRows
    factor: Array
    columns: Array
    y: Array
    _solved: dict[tuple[float, bytes], Array] = field(default_factory=dict, init=False, repr=False)
    _normals: dict[bytes, tuple[Array, Array]] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def rows(self) -> Array:
        """X, weighted."""
        return np.hstack([self.factor[:, None] * self.cells.of_masses, self.columns])

    def solved(self, smoothing: float, mask: Mask | None = None, *, start: Array | None = None) -> Array:
        """The fit x to the readings of a mask (None: all); ``start``: that of a similar programme."""
        used = np.ones(self.y.size, dtype=bool) if mask is None else mask
        key = smoothing, used.tobytes()
        if key not in self._solved:
            self._solved[key] = self._solution(smoothing, used, *self._normal(used), start)
        return self._solved[key]

    def solved_without(self, smoothing: float, mask: Mask, left_out: Mask) -> Array:
        """The fit x to the readings of a mask but those left out, which are some of them."""
        (XX, Xy), (less_XX, less_Xy) = self._normal(mask), self._normal(left_out)
        start = self.solved(smoothing, mask)
        return self._solution(smoothing, mask & ~left_out, XX - less_XX, Xy - less_Xy, start)

    def _normal(self, used: Mask) -> tuple[Array, Array]:
        """XᵀX and Xᵀy over the readings of a mask, cached: every λ uses the same folds."""
        key = used.tobytes()
        if key not in self._normals:
            rows = self.rows[used]
            self._normals[key] = rows.T @ rows, rows.T @ self.y[used]
        return self._normals[key]

    def _solution(self, smoothing: float, used: Mask, XX: Array, Xy: Array, start: Array | None) -> Array:
        triangle, count = self.cells.triangle, int(used.sum())
        n, bounded, ridge = triangle.unknowns, triangle.cells, self._ridge(smoothing, used)
        H, g = XX / count, Xy / count
        roughness = self.cells.roughness.tocoo()
        H[roughness.row, roughness.col] += smoothing * roughness.data
        H[:n, :n] += ridge * _sum_of_squares(triangle.nodes.size - 1)
        free = np.arange(n, g.size)
        H[free, free] += ridge
        positive = None if start is None or start.size <= bounded else start[:bounded] > 0
        found = solve_by_pivoting(H, g, bounded, positive)
        return _by_interior_point(H, g, bounded) if found is None else found

    def _ridge(self, smoothing: float, used: Mask) -> float:
        """ε: ``RIDGE`` of the largest diagonal element of the quadratic form of θ."""
        of_cells = self.cells.squares @ np.where(used, self.factor**2, 0.0) / used.sum()
        of_columns = np.sum(self.columns[used] ** 2, axis=0) / used.sum()
        return RIDGE * max(
            float(np.max(of_cells + smoothing * self.cells.roughness_diagonal)),
            float(of_columns.max(initial=0.0)),
        )


def _by_interior_point(H: Array, g: Array, bounded: int) -> Array:
    """The same solution where the exchange of active constraints fails."""
    D, dense = csr_matrix(eye_array(bounded, g.size)), csr_matrix(H)
    x = solve(NewtonSystem(dense, D, g.size - bounded), dense, g, accuracy=ACCURACY).x
    near = solve_by_pivoting(H, g, bounded, x[:bounded] > ZERO)
    return x if near is None else near

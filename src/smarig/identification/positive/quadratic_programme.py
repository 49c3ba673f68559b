"""Observations on a triangle of cells as one quadratic programme: rows, outputs, smoothness, solver.

    minimise  ‖Xθ − y‖²/m + λ θᵀR θ     over D θ ≥ 0      (D θ: the masses of the cells)

Outputs are scaled by their range, so that λ means the same for millimetres and for magnetic moments.

A small dense programme is solved exactly by an exchange of its active constraints,

    minimise ½ xᵀH x − gᵀx   subject to  x_i ≥ 0 for the bounded i,      H positive definite,

by block principal pivoting (Portugal, Júdice & Vicente 1994; Kim & Park 2011): the unknowns that are not at their bound
follow from linear equations; all that violate a condition of optimality change sides at once, or only the last of them
if that does not help. From the active constraints of a similar problem it takes a few small factorisations.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_matrix, eye_array

from smarig.core import Array
from smarig.identification.positive.interior_point import NewtonSystem, Solution, Solve, solve
from smarig.identification.positive.observations import Observations
from smarig.identification.positive.triangle import Triangle

Mask = NDArray[np.bool_]
RIDGE = 1e-13  # regularises directions that neither data nor smoothness determine
_BLOCK = 2000


@dataclass(frozen=True, eq=False)
class MeasureProblem:
    """``rows`` X (m, n) over the triangle's unknowns and the free offsets, scaled outputs ``y`` (m,)."""

    triangle: Triangle
    rows: csr_matrix
    y: Array
    offsets: int
    _normals: dict[bytes, tuple[csr_matrix, Array]] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(
        cls, triangle: Triangle, observations: Observations, scale: float, zero: float
    ) -> "MeasureProblem":
        """Outputs as (y − zero)/scale; a point with an offset of its own keeps its zero."""
        rows = observations.matrix(triangle)
        carried = np.asarray(rows[:, : triangle.unknowns].sum(axis=1)).ravel()  # 1 if y₋ contributes
        return cls(triangle, rows, (observations.y - zero * carried) / scale, observations.offsets)

    @cached_property
    def _roughness(self) -> csr_matrix:
        return _padded(self.triangle.roughness, self.offsets, self.offsets)

    @cached_property
    def _newton(self) -> NewtonSystem:
        pattern = csr_matrix(abs(self.rows).T @ abs(self.rows) + abs(self._roughness))
        return NewtonSystem(pattern, _padded(self.triangle.masses, 0, self.offsets), 1 + self.offsets)

    def _system(self, smoothing: float, mask: Mask | None) -> tuple[csr_matrix, Array]:
        normal, g = self._normal(mask)
        H = normal + smoothing * self._roughness
        return csr_matrix(H + RIDGE * float(H.diagonal().max()) * self._eye), g

    def _normal(self, mask: Mask | None) -> tuple[csr_matrix, Array]:
        """XᵀX/m and Xᵀy/m, cached: every λ uses the same folds."""
        key = b"" if mask is None else mask.tobytes()
        if key not in self._normals:
            rows, y = (self.rows, self.y) if mask is None else (self.rows[mask], self.y[mask])
            self._normals[key] = csr_matrix(rows.T @ rows) / y.size, rows.T @ y / y.size
        return self._normals[key]

    @cached_property
    def _eye(self) -> csr_matrix:
        return csr_matrix(eye_array(self.triangle.unknowns + self.offsets))

    def solved(self, smoothing: float, mask: Mask | None = None, accuracy: float = 1e-9) -> Solution:
        """The non-negative fit to all rows, or to those of a mask."""
        return solve(self._newton, *self._system(smoothing, mask), accuracy=accuracy)

    def solve_unconstrained(self, smoothing: float, mask: Mask | None = None) -> Array:
        """The unknowns (n,) of the same fit when masses may have any sign."""
        H, g = self._system(smoothing, mask)
        inverse = self._newton.factor(self._newton.packed(H), np.zeros(self.triangle.cells))
        return inverse(g)


def quadratic_forms(inverse: Solve, rows: csr_matrix, n: int) -> Array:
    """x M⁻¹ xᵀ for each row x, (k,); missing last columns of rows count as zero."""
    found = [np.empty(0)]
    for at in range(0, rows.get_shape()[0], _BLOCK):
        some = dense_columns(rows[at : at + _BLOCK], n)
        found.append(np.einsum("ij,ij->j", some, inverse(some)))
    return np.maximum(np.concatenate(found), 0.0)


def dense_columns(rows: csr_matrix, n: int) -> Array:
    """Rows as dense columns of n entries, (n, k)."""
    return np.vstack([rows.toarray().T, np.zeros((n - rows.get_shape()[1], rows.get_shape()[0]))])


def _padded(matrix: csr_matrix, rows: int, dense_columns: int) -> csr_matrix:
    coo = matrix.tocoo()
    shape = tuple(np.add(matrix.get_shape(), (rows, dense_columns)))
    return csr_matrix((coo.data, (coo.row, coo.col)), shape=shape)


MOST_EXCHANGES = 30
MAX_FAILURES = 3  # exchanges of all at once that may fail to reduce the violations
LEAST_VALUE, LEAST_MULTIPLIER = 1e-12, 1e-9  # for outputs of order 1: smaller violations are rounding


def solve_by_pivoting(H: Array, g: Array, bounded: int, positive: Mask | None = None) -> Array | None:
    """Minimise ½ xᵀHx − gᵀx with the first ``bounded`` unknowns ≥ 0; None if rounding or cycling prevents it.

    ``positive`` (bounded,) is a guess of the bounded unknowns that are not zero; None: all.

    >>> solve_by_pivoting(np.eye(3), np.array([1.0, -1.0, -2.0]), 2).tolist()
    [1.0, 0.0, -2.0]
    """
    free = np.arange(g.size) >= bounded
    inner = np.ones(g.size, dtype=bool)
    inner[:bounded] = True if positive is None else positive
    fewest, tries_left = g.size + 1, MAX_FAILURES
    for _ in range(MOST_EXCHANGES):
        at = np.flatnonzero(inner)
        x = np.zeros(g.size)
        try:
            factors = cho_factor(H[np.ix_(at, at)], lower=True, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return None
        x[at] = cho_solve(factors, g[at], check_finite=False)
        multiplier = H @ x - g
        violated = ~free & np.where(inner, x < -LEAST_VALUE, multiplier < -LEAST_MULTIPLIER)
        count = int(violated.sum())
        if not count:
            return x
        if count < fewest:
            fewest, tries_left = count, MAX_FAILURES
        elif tries_left:
            tries_left -= 1
        else:
            violated[: np.flatnonzero(violated)[-1]] = False
        inner = inner ^ violated
    return None

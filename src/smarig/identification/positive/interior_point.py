"""Least squares with a smooth prior under masses ≥ 0: a convex quadratic programme, solved to rounding.

    minimise ½ xᵀH x − gᵀx   subject to  D x ≥ 0,      H positive definite, D sparse

by Mehrotra's primal–dual interior point method (Mehrotra 1992; Nocedal & Wright, ch. 16): each step solves (H + Dᵀ
diag(z/s) D) dx = …, whose pattern is constant, so it is laid out once. On a triangle of cells the pattern is a band
with one full border (y₋ and free offsets), for which LAPACK's banded Cholesky is cheap. Data that couple distant
cells need the dense one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, cho_solve_banded, cholesky_banded
from scipy.sparse import csc_matrix, csr_matrix

from smarig.core import Array

Solve = Callable[[Array], Array]
MOST_STEPS = 60
_BACK = 0.995  # of the way to the boundary
_FIRST = 1e-2, 1e-4  # initial s and z, for unknowns of order 1: fewest steps over a wide range of λ


@dataclass(frozen=True, eq=False)
class Solution:
    """x (n,), the constrained quantities s = D x > 0 (k,), and their multipliers z (k,).

    ``inverse`` applies (H + Dᵀ diag(z/s) D)⁻¹, the curvature on the active constraints.
    """

    x: Array
    s: Array
    z: Array
    inverse: Solve
    steps: int


class NewtonSystem:
    """Cholesky factors of H + Dᵀ diag(w) D for many H of one pattern and many w, with a layout computed once.

    ``border``: number of the last unknowns that lie outside the band.
    """

    def __init__(self, pattern: csr_matrix, D: csr_matrix, border: int) -> None:
        n = D.get_shape()[1]
        self.D, self._n, self._inner = D, n, n - border
        both = csc_matrix(abs(pattern) + abs(D).T @ abs(D))
        rows, columns = both.nonzero()
        low = (rows >= columns) & (rows < self._inner)
        self._width = int((rows - columns)[low].max(initial=0)) + 1
        self.banded = self._width < self._inner / 4
        layout = self._layout(D)
        self._slots = np.flatnonzero(np.diff(layout.indptr))
        self._of_weights = csr_matrix(layout[self._slots])

    def _place(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
        """The place of an entry of the lower triangle: in the band, or below it in the rows of the border."""
        inner = self._inner
        if not self.banded:
            return columns * self._n + rows
        band = (rows - columns) * inner + columns
        return np.where(rows < inner, band, self._width * inner + (rows - inner) * self._n + columns)

    @property
    def _size(self) -> int:
        if not self.banded:
            return self._n * self._n
        return self._width * self._inner + (self._n - self._inner) * self._n

    def _layout(self, D: csr_matrix) -> csr_matrix:
        """The linear map from w (k,) to the stored entries of Dᵀ diag(w) D."""
        counts = np.diff(D.indptr)
        slots, cells, weights = [], [], []
        for a in range(int(counts.max(initial=0))):
            for b in range(int(counts.max(initial=0))):
                k = np.flatnonzero((counts > a) & (counts > b))
                p, q = D.indptr[k] + a, D.indptr[k] + b
                low = D.indices[p] >= D.indices[q]
                k, p, q = k[low], p[low], q[low]
                slots.append(self._place(D.indices[p].astype(np.int64), D.indices[q].astype(np.int64)))
                cells.append(k)
                weights.append(D.data[p] * D.data[q])
        entries = (np.concatenate(weights), (np.concatenate(slots), np.concatenate(cells)))
        return csr_matrix(entries, shape=(self._size, D.get_shape()[0]))

    def packed(self, H: csr_matrix) -> Array:
        """The stored entries of a symmetric H."""
        coo = H.tocoo()
        low = coo.row >= coo.col
        kept = np.zeros(self._size)
        np.add.at(
            kept, self._place(coo.row[low].astype(np.int64), coo.col[low].astype(np.int64)), coo.data[low]
        )
        return kept

    def factor(self, kept: Array, w: Array) -> Solve:
        """The solver of (H + Dᵀ diag(w) D) x = b, for one b (n,) or several (n, m); LinAlgError if singular."""
        entries = kept.copy()
        entries[self._slots] += self._of_weights @ w
        if not self.banded:
            lower = entries.reshape(self._n, self._n).T  # in LAPACK's order: no copy
            dense = cho_factor(lower, lower=True, overwrite_a=True, check_finite=False)
            return lambda b: cho_solve(dense, b, check_finite=False)
        inner = self._inner
        band = cholesky_banded(
            entries[: self._width * inner].reshape(self._width, inner), lower=True, check_finite=False
        )
        below = entries[self._width * inner :].reshape(-1, self._n)
        side, corner = below[:, :inner].T, below[:, inner:]
        corner = np.tril(corner) + np.tril(corner, -1).T
        reach = cho_solve_banded((band, True), side, check_finite=False)
        schur = cho_factor(corner - side.T @ reach, lower=True, check_finite=False)

        def solve(b: Array) -> Array:
            last = cho_solve(schur, b[inner:] - reach.T @ b[:inner], check_finite=False)
            first = cho_solve_banded((band, True), b[:inner], check_finite=False) - reach @ last
            return np.concatenate([first, last])

        return solve


def solve(newton: NewtonSystem, H: csr_matrix, g: Array, *, accuracy: float = 1e-9) -> Solution:
    """Minimise ½ xᵀHx − gᵀx with D x ≥ 0 until the duality gap is ``accuracy`` of the objective's scale."""
    D, kept = newton.D, newton.packed(H)
    DT = csr_matrix(D.T)
    x, (s, z) = np.zeros(g.size), (np.full(D.get_shape()[0], first) for first in _FIRST)
    solver = newton.factor(kept, z / s)
    for step in range(1, MOST_STEPS + 1):
        dual, primal = H @ x - g - DT @ z, D @ x - s
        gap = float(s @ z)
        scale = 1e-3 * abs(float(g @ x)) + 1e-12
        if gap < accuracy * scale and np.abs(primal).max() < accuracy and np.abs(dual).max() < accuracy:
            return Solution(x, s, z, solver, step)
        try:
            solver = solver if step == 1 else newton.factor(kept, z / s)
        except LinAlgError:  # rounding permits no further step
            return Solution(x, s, z, solver, step)
        direction = _direction(solver=solver, D=D, DT=DT, s=s, z=z, dual=dual, primal=primal)
        reach = _longest(s, direction[1]), _longest(z, direction[2])
        after = float((s + reach[0] * direction[1]) @ (z + reach[1] * direction[2]))
        centred = direction[1] * direction[2] - (after / gap) ** 3 * gap / s.size
        dx, ds, dz = _direction(
            solver=solver, D=D, DT=DT, s=s, z=z, dual=dual, primal=primal, correction=centred
        )
        length = min(_longest(s, ds), _longest(z, dz))
        x, s, z = x + length * dx, s + length * ds, z + length * dz
    return Solution(x, s, z, solver, MOST_STEPS)


def _direction(
    solver: Solve,
    D: csr_matrix,
    DT: csr_matrix,
    s: Array,
    z: Array,
    dual: Array,
    primal: Array,
    correction: Array | float = 0.0,
) -> tuple[Array, Array, Array]:
    """Newton step (dx, ds, dz) towards s·z = −correction."""
    wanted = s * z + correction
    dx = solver(-dual - DT @ ((wanted + z * primal) / s))
    ds = D @ dx + primal
    return dx, ds, -(wanted + z * ds) / s


def _longest(v: Array, dv: Array) -> float:
    """The longest step, at most 1, that keeps v positive."""
    shrinking = dv < 0
    return min(1.0, _BACK * float(np.min(-v[shrinking] / dv[shrinking], initial=np.inf)))

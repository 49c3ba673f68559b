"""What a relay density on a grid predicts at readings of an input: areas of the region of relays that are up.

The region is a signed sum of triangles T(α, β) = {β ≤ down, up ≤ α} from the memory of the input. A cell off the
diagonal adds clip((α − a)/h) · clip((b + h − β)/h), one on it (p − q)₊², a reversible part clip((v − e)/h). All are
continuous in the input, so small false reversals do little harm.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

Rows = NDArray[np.int64]
CELLS = 24
DEPTH = 12  # reversals kept of a memory: noise nests loops without end
CORRELATION = 1.0  # cells over which a density is smooth


@dataclass(frozen=True)
class MemoryGrid:
    """A triangular grid of relays on the unit interval, and reversible cells on its diagonal."""

    cells: int = CELLS

    @cached_property
    def edges(self) -> Array:
        """Lower edges (cells,)."""
        return np.arange(self.cells) / self.cells

    @cached_property
    def pairs(self) -> tuple[Rows, Rows]:
        """(up, down) cells of the relays off the diagonal."""
        return np.tril_indices(self.cells, -1)

    @cached_property
    def correlation(self) -> tuple[Array, Array]:
        """Of relays off the diagonal, and of cells along it: Gaussian over ``CORRELATION`` cells."""
        i, j = self.pairs
        k = np.arange(self.cells)
        square = (i[:, None] - i) ** 2 + (j[:, None] - j) ** 2
        pairs, along = (np.exp(-d / (2 * CORRELATION**2)) for d in (square, (k[:, None] - k) ** 2))
        return pairs, along

    def features(self, v: Array, rows: Rows, *, up: bool) -> Array:
        """(rows, relays): the share of each cell that is up at ``rows`` of an input (n,) in [0, 1], relays first."""
        v = np.clip(v, 0.0, 1.0)
        reading, alpha, beta, sign = _triangles(v, rows, up)
        p = np.clip((alpha[:, None] - self.edges) * self.cells, 0, 1)
        q = np.clip((beta[:, None] - self.edges) * self.cells, 0, 1)
        starts = np.flatnonzero(np.r_[True, np.diff(reading) > 0])
        own, outside = p * sign[:, None], 1 - q
        plane = np.array([own[a:b].T @ outside[a:b] for a, b in pairwise([*starts.tolist(), reading.size])])
        diagonal = np.add.reduceat(np.maximum(p - q, 0) ** 2 * sign[:, None], starts, axis=0)
        reversible = np.clip((v[rows][:, None] - self.edges) * self.cells, 0, 1)
        return np.hstack([plane[:, *self.pairs], diagonal, reversible])

    def covariance(self, features: Array, density: Array) -> Array:
        """F diag(w) C diag(w) Fᵀ of features (n, k) with a density (k,)."""
        white = np.hstack([a @ root for a, root in zip(self._parted(features * density), self._roots)])
        return white @ white.T

    def predicted(self, left: Array, right: Array, density: Array, dual: Array) -> Array:
        """F diag(w) C diag(w) F'ᵀ α of features (n, k) and (m, k) with a density (k,) and α (m,)."""
        plane, line = self.correlation
        parts = self._parted(density * (right.T @ dual))
        return left @ (density * np.concatenate([c @ a for a, c in zip(parts, (plane, line, line))]))

    def _parted(self, a: Array) -> list[Array]:
        """Of relays off the diagonal, of those on it, and of reversible cells (…, k)."""
        relays = len(self.pairs[0])
        return np.split(a, [relays, relays + self.cells], axis=-1)

    @cached_property
    def _roots(self) -> tuple[Array, Array, Array]:
        """L of the correlations L Lᵀ of the three parts."""
        plane, line = self.correlation
        root = np.asarray(np.linalg.cholesky(line), dtype=float)
        return np.asarray(np.linalg.cholesky(plane), dtype=float), root, root


def _triangles(v: Array, rows: Rows, up: bool) -> tuple[Rows, Array, Array, Array]:
    """(reading, α, β, sign) of the triangles whose signed sum is the region of relays that are up at each row."""
    wanted = np.zeros(v.size, dtype=bool)
    wanted[rows] = True
    step = np.diff(v)
    visited = wanted.copy()
    visited[0] = True
    visited[1:-1] |= step[:-1] * step[1:] <= 0
    stack = [0.0, 1.0] if up else [0.0]
    rising, now = not up, 1.0 if up else 0.0
    found: list[tuple[int, float, float, float]] = []
    number = 0
    for k in np.flatnonzero(visited).tolist():
        x = float(v[k])
        stack, rising = _moved(stack, rising, now, x)
        now = x
        if wanted[k]:
            found += [(number, *t) for t in _region(stack, rising, now)]
            number += 1
    table = np.array(found)
    return table[:, 0].astype(np.int64), table[:, 1], table[:, 2], table[:, 3]


def _moved(stack: list[float], rising: bool, now: float, x: float) -> tuple[list[float], bool]:
    """The reversals (low, high, low …) after a move to x, with those wiped out that it passes."""
    if x > now:
        if not rising:
            stack.append(now)
            rising = True
        while len(stack) >= 3 and x >= stack[-2]:
            del stack[-2:]
    elif x < now:
        if rising:
            stack.append(now)
            rising = False
        while len(stack) >= 3 and x <= stack[-2]:
            del stack[-2:]
        if x <= 0.0 or len(stack) % 2:
            return [0.0], True
    return stack, rising


def _region(stack: list[float], rising: bool, now: float) -> list[tuple[float, float, float]]:
    s = stack[: DEPTH + len(stack) % 2] if len(stack) > DEPTH else stack
    found: list[tuple[float, float, float]] = []
    for i in range(1, len(s) - (0 if rising else 1), 2):
        found += [(s[i], s[i - 1], 1.0), (s[i], s[i + 1] if i + 1 < len(s) else now, -1.0)]
    if rising:
        return [*found, (now, s[-1], 1.0)]
    return [*found, (s[-1], s[-2], 1.0), (s[-1], now, -1.0)]

"""Lower bounds of what a strip does to an energy, over all strips of a surface at once.

Moving M sweeps a strip of the Preisach plane; an energy changes by 2∫ μ · lever along it, the lever being a
distance to an axis or to the diagonal. The triangle is cut into equal cells, μ is bounded in each
(``density_bounds``), and the bounds are summed from the diagonal on. Knows cells, not energies.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.theory.energy.density_bounds import density_bounds

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DensityCells:
    """The triangle in n cells per axis of width ``h``: ``levels`` (n + 1,), ``low`` ≤ 2μ in cell (α i, β j), (n, n)."""

    levels: Array
    low: Array

    @classmethod
    def of(cls, surface: FodSurface, n: int) -> "DensityCells":
        """Bound the density of a surface in every cell on and below the diagonal."""
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
        """A cell the strip crosses entirely, and one it may end in."""
        return np.tril(np.minimum(self.low * near, self.low * far), -1), np.minimum(self.low, 0.0) * far

    @staticmethod
    def _diagonal_part(part: Array) -> Array:
        """The triangle on the diagonal, which every strip touches."""
        return np.diag(part)

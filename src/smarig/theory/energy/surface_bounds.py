"""A verified lower bound of the loop area over every loop of an analytic surface (5.5).

The triangle is cut into boxes. In a box of loops (M, m) ∈ [u_i, u_i+1] × [u_j, u_j+1] the smallest loop is
(u_i, u_j+1), and A grows from it by strip moments,

    A(M, m) = A(u_i, u_j+1) + ∫ ∂A/∂M + ∫ (−∂A/∂m)
    ∂A/∂M = 2∫_m^M μ(M, β)(M − β) dβ,    −∂A/∂m = 2∫_m^M μ(α, m)(α − m) dα,

each bounded below by interval arithmetic on μ, cell by cell. At a minimum inside the triangle the strip
moments vanish, so the bound closes in on A with the square of the cell. Where no cell of the triangle under
a box can be negative, A ≥ 0 holds without looking at A: that settles the diagonal, where A → 0 like the cube
of the loop, and the tails, where A is below rounding. Refuses to sample.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.theory.energy.density_bounds import density_bounds
from smarig.theory.energy.moments import areas_on
from smarig.theory.energy.strip_moments import DensityCells

Array = NDArray[np.float64]


class AreaBound(NamedTuple):
    """What one cut of the triangle shows: no loop's area is below ``low``; the smallest on its nodes is ``area``."""

    low: float
    area: float
    at: tuple[float, float]


def area_bound(surface: FodSurface, cells: int, rounding: float) -> AreaBound:
    """Lower bound of min A, and the smallest A on the nodes, from ``cells`` equal cells per axis.

    ``rounding`` is what an area on a node may be wrong by; it is taken off wherever such an area is used.
    """
    cut = DensityCells.of(surface, cells)
    areas = areas_on(surface, cut.levels)
    i, j = np.tril_indices(cells, -1)
    below = areas[i, j + 1] - rounding + _growth(cut)[i, j]
    below = np.where(cut.has_no_negative_cell()[i, j], np.maximum(below, 0.0), below)
    inside_one_cell = np.minimum(np.diag(cut.low), 0.0) * cut.h**3 / 6
    i, j = np.tril_indices(cells + 1, -1)
    worst = int(np.argmin(areas[i, j]))
    at = (float(cut.levels[i[worst]]), float(cut.levels[j[worst]]))
    return AreaBound(float(min(below.min(), inside_one_cell.min())), float(areas[i, j][worst]), at)


def _growth(cut: DensityCells) -> Array:
    """Least growth of A inside each box, from its smallest loop, shape (n, n)."""
    gap = cut.levels[:-1, None] - cut.levels[:-1]
    near, far = cut.h * np.maximum(gap - cut.h / 2, 0.0), cut.h * np.maximum(gap + cut.h / 2, 0.0)
    rates = np.minimum(cut.across(near, far), 0.0) + np.minimum(cut.along(near, far), 0.0)
    return cut.h * rates


def negative_small_loop(surface: FodSurface, points: int = 257) -> tuple[float, tuple[float, float]] | None:
    """A loop proved to have A < 0 because μ < 0 in all of it, at the diagonal: (upper bound of A, (M, m)).

    Where μ(u, u) < 0 every small enough loop about u has A ≤ 2 max μ · (M − m)³/6 < 0, however far below
    rounding that is. None when μ(u, u) ≥ 0 at all ``points`` of the diagonal looked at.
    """
    u = np.linspace(surface.lower, surface.upper, points)
    worst = float(u[np.argmin(density_bounds(surface, u, u, u, u).high)])
    reach = float(u[1] - u[0])
    for _ in range(60):
        low, high = max(worst - reach / 2, surface.lower), min(worst + reach / 2, surface.upper)
        ends = np.array([low]), np.array([high])
        most = float(density_bounds(surface, *ends, *ends).high[0])
        if most < 0:
            return most * (high - low) ** 3 / 6, (high, low)
        reach /= 2
    return None

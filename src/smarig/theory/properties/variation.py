"""|ν|, the largest effect of a signed measure, and a bound on the difference between a surface's ν and its grid's.

For tables and relays the total variation is exact. For surfaces each cell gets 2∬|μ| + ∫|g|: exact where the enclosure
of μ has one sign, and an upper bound elsewhere. ``uncertainty`` bounds |ν(Ω) − ν_h(Ω)| for every region Ω that a sweep
can cover, where ν_h is ν spread evenly over each cell. Only cells that the edge of Ω crosses count, so the bound
decreases with the square of the cell size.
"""

from functools import singledispatch

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, FodTable, Interval, Mirrored, RelayMeasure
from smarig.theory.properties import enclosure
from smarig.theory.properties.triangle_grid import TriangleGrid, masses, table_of


def variation(plane: TriangleGrid) -> Everett:
    """|ν| as a hysteresis: relays of |mass|, or a table of 2∬|μ| + ∫|g| cell by cell."""
    return _variation(plane.hysteresis, plane)


@singledispatch
def _variation(hysteresis: Everett, plane: TriangleGrid) -> Everett:
    del hysteresis
    return table_of(plane.levels, variation_masses(plane, plane.levels))


@_variation.register
def _variation_of_relays(hysteresis: RelayMeasure, plane: TriangleGrid) -> Everett:
    del plane
    return RelayMeasure.from_arrays(hysteresis.alpha, hysteresis.beta, np.abs(hysteresis.mass))


@_variation.register
def _variation_of_mirrored(hysteresis: Mirrored, plane: TriangleGrid) -> Everett:
    del hysteresis
    if plane.kind == "relays":
        return Mirrored(variation(plane.mirrored()))
    return table_of(plane.levels, variation_masses(plane, plane.levels))


def variation_masses(plane: TriangleGrid, levels: Array) -> Array:
    """|ν| of the cells of any lattice, (n − 1, n − 1), as in ``masses``; NaN for a sampled plane."""
    return _variation_masses(plane.hysteresis, plane, levels)


@singledispatch
def _variation_masses(hysteresis: Everett, plane: TriangleGrid, levels: Array) -> Array:
    del hysteresis, plane
    return np.where(np.tri(levels.size - 1, dtype=bool), np.nan, 0.0)


@_variation_masses.register
def _masses_of_mirrored(hysteresis: Mirrored, plane: TriangleGrid, levels: Array) -> Array:
    del hysteresis
    return variation_masses(plane.mirrored(), -levels[::-1])[::-1, ::-1].T


@_variation_masses.register
def _masses_of_relays(hysteresis: RelayMeasure, plane: TriangleGrid, levels: Array) -> Array:
    del hysteresis
    return masses(variation(plane), levels)


@_variation_masses.register
def _masses_of_table(hysteresis: FodTable, plane: TriangleGrid, levels: Array) -> Array:
    del plane
    nodes = hysteresis.nodes
    return masses(table_of(nodes, np.abs(masses(hysteresis, nodes))), levels)


def uncertainty(plane: TriangleGrid) -> float:
    """E with |ν(Ω) − ν_h(Ω)| ≤ E for all regions Ω of sweeps; 0 for tables and relays, NaN if unknown.

    The edge of Ω is a falling staircase. It crosses a chain of cells, each next to, above or left of the last, and at
    most two whole rows (or columns) including their diagonal cells.
    """
    return _uncertainty(plane.hysteresis, plane)


@singledispatch
def _uncertainty(hysteresis: Everett, plane: TriangleGrid) -> float:
    del hysteresis
    return float("nan") if plane.kind == "sampled" else 0.0


@_uncertainty.register
def _uncertainty_of_mirrored(hysteresis: Mirrored, plane: TriangleGrid) -> float:
    del hysteresis
    return uncertainty(plane.mirrored())


@_uncertainty.register
def _uncertainty_of_surface(hysteresis: FodSurface, plane: TriangleGrid) -> float:
    mu, area = _densities(hysteresis, plane.levels)
    cell_uncertainty = np.tril(mu.width * area / 2, k=-1)  # ½∬|2μ − mean| ≤ area · (range of 2μ)/4
    u = plane.levels
    w = np.diff(u)
    g = enclosure.reversible(hysteresis, Interval(u[:-1], u[1:]))
    on_diagonal = 2 * w**2 * np.diag(mu.size) + w * g.width / 4
    rows = np.maximum(cell_uncertainty.sum(axis=1), cell_uncertainty.sum(axis=0)) + on_diagonal
    return _heaviest_chain(cell_uncertainty) + 2 * float(rows.max())


@_variation_masses.register
def _masses_of_surface(hysteresis: FodSurface, plane: TriangleGrid, levels: Array) -> Array:
    del plane
    cells = np.sign(hysteresis.y_upper - hysteresis.y_lower) * masses(hysteresis, levels)
    mu, area = _densities(hysteresis, levels)
    one_sign = (mu.low >= 0) | (mu.high <= 0)
    off_diagonal = np.where(one_sign, np.abs(cells), 2 * area * mu.size)
    # On the diagonal F = 2∬μ + ∫g over half a cell, with g of one sign.
    positive = mu.low >= 0 if hysteresis.y_upper >= hysteresis.y_lower else mu.high <= 0
    on_diagonal = np.where(positive, cells, cells + 2 * area * mu.size)
    return np.tril(off_diagonal, k=-1) + np.diag(np.diag(on_diagonal))


def _densities(surface: FodSurface, levels: Array) -> tuple[Interval, Array]:
    """Enclosures of μ on the cells of a lattice, clipped to the range, and the areas of the cells."""
    u = np.clip(levels, surface.lower, surface.upper)
    alpha, beta = (
        Interval(*(np.broadcast_to(x, (u.size - 1,) * 2) for x in ends))
        for ends in ((u[:-1, None], u[1:, None]), (u[:-1], u[1:]))
    )
    w = np.diff(u)
    return enclosure.density(surface, alpha, beta), w[:, None] * w


def _heaviest_chain(cells: Array) -> float:
    """Largest sum along a chain of cells that goes up and to the left, one step at a time."""
    best = np.zeros(cells.shape[1])
    for row in cells:
        upto = np.cumsum(row)
        best = np.maximum.accumulate((best + upto)[::-1])[::-1] - upto + row
    return float(best.max())

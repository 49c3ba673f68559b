"""The triangle P_r of a hysteresis, cut along levels, and its measure ν on the cells of any lattice.

    ν = 2μ dα dβ + g(β) δ(α − β),     F(α, β) = ν(triangle with corner (α, β))        (theory.md §1)

A table spreads the mass of a cell evenly, and that of a diagonal cell along α = β. Relays are atoms. A surface has a
density. The kind of a hysteresis determines which results are exact.
"""

from dataclasses import dataclass
from functools import singledispatch
from typing import Literal

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, FodTable, Mirrored, RelayMeasure, mirror_image

MeasureKind = Literal["surface", "table", "relays", "sampled"]
LEVELS = 128


@dataclass(frozen=True, eq=False)
class TriangleGrid:
    """A hysteresis with the levels (n,) along which its triangle is cut, increasing from u₋ to u₊.

    ``table`` and ``relays``: its own partition or thresholds, so nothing is lost between levels. ``surface``: an even
    grid, with enclosures between levels. ``sampled`` (any other ``Everett``): an even grid with the kinks; nothing is
    known between levels.
    """

    hysteresis: Everett
    levels: Array
    kind: MeasureKind

    @classmethod
    def of(cls, hysteresis: Everett, levels: int = LEVELS) -> "TriangleGrid":
        """Cut the triangle of any hysteresis; ``levels`` is the number of cells per side where it can be chosen."""
        return _cut(hysteresis, levels)

    def mirrored(self) -> "TriangleGrid":
        """The plane of the mirror image (u, y) → (−u, −y), in which falls become rises."""
        return TriangleGrid(mirror_image(self.hysteresis), -self.levels[::-1], self.kind)

    @property
    def span(self) -> float:
        """u₊ − u₋."""
        return float(self.levels[-1] - self.levels[0])

    @property
    def height(self) -> float:
        """|y₊ − y₋|, or the largest |F| where that is zero: the scale of outputs."""
        a, b = self.levels[:, None], np.minimum(self.levels, self.levels[:, None])
        return float(np.abs(self.hysteresis.swept(a, b)).max()) or 1.0


@singledispatch
def _cut(hysteresis: Everett, levels: int) -> TriangleGrid:
    kinks = np.asarray(getattr(hysteresis, "kinks", ()), dtype=float)
    some = kinks[:: max(1, kinks.size // levels)]
    lines = np.concatenate([_even(hysteresis, levels), some])
    return TriangleGrid(hysteresis, np.unique(np.clip(lines, hysteresis.lower, hysteresis.upper)), "sampled")


@_cut.register
def _cut_mirrored(hysteresis: Mirrored, levels: int) -> TriangleGrid:
    return _cut(hysteresis.image, levels).mirrored()


@_cut.register
def _cut_table(hysteresis: FodTable, levels: int) -> TriangleGrid:
    del levels
    return TriangleGrid(hysteresis, hysteresis.nodes, "table")


@_cut.register
def _cut_relays(hysteresis: RelayMeasure, levels: int) -> TriangleGrid:
    del levels
    return TriangleGrid(hysteresis, np.unique(np.concatenate([hysteresis.alpha, hysteresis.beta])), "relays")


@_cut.register
def _cut_surface(hysteresis: FodSurface, levels: int) -> TriangleGrid:
    return TriangleGrid(hysteresis, _even(hysteresis, levels), "surface")


def _even(hysteresis: Everett, levels: int) -> Array:
    return np.linspace(hysteresis.lower, hysteresis.upper, levels + 1)


@singledispatch
def masses(hysteresis: Everett, levels: Array) -> Array:
    """ν of the cells of a lattice, (n − 1, n − 1): row i is α in [u_i, u_{i+1}], column j ≤ i is β; else 0.

    It uses inclusion and exclusion of F. Diagonal cells (j = i) contain the reversible part. Relays are counted one by
    one; a relay on a level belongs to the cell above it. Levels beyond the range contain nothing.
    """
    u = np.clip(levels, hysteresis.lower, hysteresis.upper)
    F = hysteresis.swept(u[:, None], np.minimum(u, u[:, None]))
    return np.tril(F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:])


@masses.register
def _masses_of_mirrored(hysteresis: Mirrored, levels: Array) -> Array:
    return masses(hysteresis.image, -levels[::-1])[::-1, ::-1].T


@masses.register
def _masses_of_relays(hysteresis: RelayMeasure, levels: Array) -> Array:
    cells = np.zeros((levels.size - 1, levels.size - 1))
    row, column = (
        np.clip(np.searchsorted(levels, x, side="right") - 1, 0, levels.size - 2)
        for x in (hysteresis.alpha, hysteresis.beta)
    )
    np.add.at(cells, (row, column), 2 * hysteresis.mass)
    return cells


def table_of(levels: Array, cells: Array, unit: str = "") -> FodTable:
    """The table with these masses ν (n − 1, n − 1) of cells in the lower triangle, and output 0 at u₋."""
    n = levels.size
    F = np.zeros((n, n))
    F[1:, :-1] = np.cumsum(np.cumsum(cells, axis=0)[:, ::-1], axis=1)[:, ::-1]
    return FodTable(levels, np.where(np.tri(n, dtype=bool), F[:, :1] - F, np.nan), unit)

"""Random measures on a small lattice, as a table, as relays, and relay by relay, for the tests of chapters 3
and 4.

A ``Lattice`` has levels and the mass ν of each cell. Its reference relays are made from the masses alone, as
in definition (3.1); the code under test only builds the subjects.
"""

from dataclasses import dataclass
from itertools import product
from random import Random

import numpy as np
from hypothesis import Phase, find, settings
from hypothesis import strategies as st

from preisach.relay_reference import Relays
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.relay_measure import RelayMeasure

Y_LOWER = -0.75


@dataclass(frozen=True, eq=False)
class Lattice:
    """Levels (n + 1,) and the mass ν (n, n) of cells, row α, column β ≤ α; diagonal cells are reversible."""

    levels: np.ndarray
    nu: np.ndarray

    def __repr__(self) -> str:
        return f"Lattice(np.array({self.levels.tolist()}), np.array({self.nu.tolist()}))"

    @property
    def span(self) -> float:
        return float(self.levels[-1] - self.levels[0])

    @property
    def scale(self) -> float:
        return float(np.abs(self.nu).sum()) or 1.0

    def table(self) -> FodTable:
        """y(α_i, β_j): what is on after a fall from α_i to β_j, by summing cells."""
        n = self.levels.size
        y = np.full((n, n), np.nan)
        for i, j in product(range(n), range(n)):
            if j <= i:
                y[i, j] = Y_LOWER + self.nu[:i, :j].sum()
        return FodTable.from_arrays(self.levels, self.levels, y)

    def measure(self) -> RelayMeasure:
        """One relay a cell: at its corner (α_{i+1}, β_j), or, reversible, on the diagonal in its middle."""
        i, j = np.nonzero(np.tri(self.nu.shape[0]))
        u = self.levels
        middle = (u[i + 1] + u[i]) / 2
        alpha, beta = np.where(i == j, middle, u[i + 1]), np.where(i == j, middle, u[j])
        return RelayMeasure.from_arrays([*alpha, u[-1]], [*beta, u[0]], [*self.nu[i, j] / 2, 0.0])

    def relays(self, parts: int = 1) -> Relays:
        """Relays that are exact on the levels and on ``parts`` even points of each cell, all off."""
        rows = []
        u = self.levels
        for i, j in product(*map(range, self.nu.shape)):
            a, b = np.linspace(u[i], u[i + 1], parts + 1), np.linspace(u[j], u[j + 1], parts + 1)
            if i == j:
                rows += [(a[p + 1], a[p], self.nu[i, j] / parts) for p in range(parts)]
            elif j < i:
                rows += [
                    (a[p + 1], b[q], self.nu[i, j] / parts**2) for p in range(parts) for q in range(parts)
                ]
        alpha, beta, nu = (np.array(column) for column in zip(*rows))
        return Relays(alpha, beta, nu, np.zeros(alpha.size, dtype=bool), u[0])

    def points(self, parts: int = 1) -> np.ndarray:
        """The levels with ``parts`` even points in each cell."""
        fine = [np.linspace(a, b, parts + 1)[:-1] for a, b in zip(self.levels[:-1], self.levels[1:])]
        return np.concatenate([*fine, self.levels[-1:]])


def lattices(*, signed: bool = True, reversible: bool = True, sizes=(3, 6), even: bool = False):
    """Lattices of 3 to 6 cells a side; masses in eighths, so that sums are exact."""

    @st.composite
    def build(draw):
        n = draw(st.integers(*sizes))
        steps = [1] * n if even else draw(st.lists(st.integers(1, 4), min_size=n, max_size=n))
        masses = st.integers(-8 if signed else 0, 8)
        filled = draw(st.lists(masses, min_size=n * n, max_size=n * n))
        nu = np.tril(np.array(filled, dtype=float).reshape(n, n) / 8, k=0 if reversible else -1)
        return Lattice(np.concatenate([[0.0], np.cumsum(steps)]) - draw(st.integers(0, 6)), nu)

    return build()


def histories(lattice: Lattice, parts: int = 1, longest: int = 10):
    """Inputs on the points of a lattice."""
    points = lattice.points(parts).tolist()
    return st.lists(st.sampled_from(points), min_size=1, max_size=longest)


@st.composite
def driven(draw, parts: int = 2, longest: int = 10, **kind):
    """A lattice and a history on its points."""
    lattice = draw(lattices(**kind))
    return lattice, draw(histories(lattice, parts, longest))


def counterexample(strategy, violated):
    """An example of the strategy that violates a law; NoSuchExample when the law cannot be broken."""
    generate_only = settings(max_examples=500, database=None, phases=[Phase.generate])
    return find(strategy, violated, settings=generate_only, random=Random(1))

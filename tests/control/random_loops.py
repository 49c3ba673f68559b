"""Random wires with hysteresis in an integral loop, simulated tick by tick by definition, for the tests of convergence.

Nothing of the package is used but the operator and the controller under test.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from smarig.preisach import FodTable, Preisach

RANGE, STROKE, EVEN = 100.0, 10.0, 0.25
FLATTEST = EVEN * STROKE / (1.5 * RANGE)  # slope of the even reversible part of a table


def random_table(rng: np.random.Generator) -> FodTable:
    """A positive measure on a random partition of [0, 100], output 0 to 10, a quarter of it spread evenly."""
    n = int(rng.integers(4, 9))
    u = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, n))])
    u *= RANGE / u[-1]
    cells, w = np.tri(n) * rng.gamma(rng.choice([0.3, 1.0, 3.0]), 1.0, (n, n)), np.diff(u)
    if rng.random() < 0.3:
        cells *= 1 - np.eye(n)  # no reversible part but the even one
    even = np.tri(n, k=-1) * np.outer(w, w) / RANGE + np.diag(w)
    nu = STROKE * ((1 - EVEN) * cells / cells.sum() + EVEN * even / even.sum())
    y = np.full((n + 1, n + 1), np.nan)
    for i in range(n + 1):
        for j in range(i + 1):
            y[i, j] = nu[:i, :j].sum()  # on after a fall from u_i to u_j
    return FodTable.from_arrays(u, u, y)


def steepest_major_branch(table: FodTable) -> float:
    """λ for ν ≥ 0: the steepest piece of the rising and of the falling branch of the major loop."""
    u, y = table.nodes, table.values
    rising = np.diff(np.diag(y)) / np.diff(u)
    return float(max(rising.max(), (np.diff(y[-1]) / np.diff(u)).max()))


@dataclass(frozen=True)
class Loop:
    """A wire: its table, time constant and dead time in ticks of 1 s, its past inputs, and the set-point."""

    table: FodTable
    tau: float
    delay: int
    past: tuple[float, ...]
    setpoint: float

    def run(
        self,
        step: Callable[[float], float],
        ticks: int,
        *,
        source: float | None = None,
        count: float = 0.0,
    ) -> np.ndarray:
        """Outputs (ticks,) with the source of the last tick from ``step(error)``; at rest first unless ``source``."""
        operator = Preisach(self.table, "negative")
        for u in self.past:
            operator.step(u)
        wire = self.past[-1]
        line = [wire if source is None else source] * (self.delay + 1)
        decay = math.exp(-1 / self.tau)
        y = np.empty(ticks)
        for k in range(ticks):
            wire = line[0] + (wire - line[0]) * decay
            y[k] = operator.step(wire)
            read = count * round(y[k] / count) if count else y[k]
            line = [*line[1:], step(self.setpoint - read)]
        return y


def random_loops(seed: int, size: int) -> Iterator[tuple[Loop, np.random.Generator]]:
    """Wires with τ of 2 to 40 ticks, dead times of 0 to 20, and set-points over the whole range."""
    for k in range(size):
        rng = np.random.default_rng([seed, k])
        past = tuple(rng.uniform(0.0, RANGE, int(rng.integers(1, 7))).tolist())
        setpoint = float(rng.uniform(0.01, 0.99)) * STROKE
        yield (
            Loop(random_table(rng), float(rng.uniform(2, 40)), int(rng.integers(0, 21)), past, setpoint),
            rng,
        )

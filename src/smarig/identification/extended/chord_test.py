"""Tests of comparable minor loops against noise: congruency, and equality of their vertical chords.

Loops between the same two inputs, driven after different histories:

congruent (classical Preisach, §3.3.2) y_j(branch, u) = shape(branch, u) + level_j equal vertical chords (nonlinear,
§3.5) y_j(down, u) − y_j(up, u) = chord(u)

The first implies the second. The squared residuals over σ² follow χ² if the property holds (F if σ is estimated).
If neither holds, the data show feedback, accommodation or drift.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from smarig.core import Array, DataError, chi2_tail, f_tail
from smarig.identification.noise_floor import NoiseFloor
from smarig.record import Run
from smarig.replay import memory_histories

ChordVerdict = Literal["Preisach", "non-linear Preisach", "neither"]


@dataclass(frozen=True, eq=False)
class MinorLoop:
    """One minor loop between two inputs: outputs on its falling and rising branch at inputs u (q,), inside."""

    ends: tuple[float, float]
    u: Array
    down: Array
    up: Array


@dataclass(frozen=True)
class ChordTest:
    """p-values of congruency and of equal chords, the rms residual of each, the number of loops, and the verdict."""

    p_congruent: float
    p_chords: float
    rms_congruent: float
    rms_chords: float
    loops: int
    alpha: float

    @property
    def verdict(self) -> ChordVerdict:
        """The simplest model that is not rejected at level alpha."""
        if self.p_congruent >= self.alpha:
            return "Preisach"
        return "non-linear Preisach" if self.p_chords >= self.alpha else "neither"


def equal_chords(runs: Sequence[Run], noise: NoiseFloor, *, alpha: float = 0.01) -> ChordTest:
    """Run both tests over all sets of comparable loops in the runs; ``noise`` as given by ``noise_floor``.

    Raises DataError if no two loops share their ends and an input between, or if the noise is unknown.
    """
    return compare_loops(loops(runs), noise, alpha=alpha)


def compare_loops(found: Iterable[MinorLoop], noise: NoiseFloor, *, alpha: float = 0.01) -> ChordTest:
    """Run both tests on loops; loops with equal ends are compared at their common inputs."""
    if not noise.value:
        raise DataError("The noise of a settled point is unknown. Repeat some memory states first.")
    sets: dict[tuple[float, float], list[MinorLoop]] = defaultdict(list)
    for loop in found:
        sets[loop.ends].append(loop)
    shape, chord = _ResidualSquares(), _ResidualSquares()
    used = 0
    for group in sets.values():
        common = sorted(set.intersection(*(set(loop.u.tolist()) for loop in group)))
        if len(group) < 2 or not common:
            continue
        down, up = (np.array([_at(loop, b, common) for loop in group]) for b in ("down", "up"))
        both = np.hstack([down, up])
        shape.add(both - both.mean(axis=1, keepdims=True), both.shape[1] - 1)
        chord.add((down - up) / np.sqrt(2), len(common))
        used += len(group)
    if not used:
        raise DataError(
            "No two minor loops have the same end inputs and a measured input in common between them. Run the "
            "congruency protocol."
        )
    return ChordTest(shape.p_value(noise), chord.p_value(noise), shape.rms, chord.rms, used, alpha)


def loops(runs: Sequence[Run]) -> list[MinorLoop]:
    """Every branch of the runs that the next branch retraces to its start or beyond; each branch is used once."""
    _, _, records = memory_histories(runs)
    return [loop for r in records for loop in _loops(r.inputs, r.outputs)]


def _loops(u: Array, y: Array) -> list[MinorLoop]:
    u, y = u[(moved := np.append(True, np.diff(u) != 0))], y[moved]
    turns = np.concatenate([[0], np.flatnonzero(np.diff(np.sign(np.diff(u))) != 0) + 1, [u.size - 1]])
    found = []
    k = 0
    while k + 2 < turns.size:
        a, b, c = turns[k : k + 3]
        if abs(u[c] - u[b]) < abs(u[a] - u[b]):  # the input turned before the loop closed
            k += 1
            continue
        first = dict(zip(u[a + 1 : b].tolist(), y[a + 1 : b].tolist()))
        second = dict(zip(u[b + 1 : c].tolist(), y[b + 1 : c].tolist()))
        common = sorted(first.keys() & second.keys())
        one, two = (np.array([branch[v] for v in common]) for branch in (first, second))
        falling, rising = (one, two) if u[b] < u[a] else (two, one)
        low, high = sorted((float(u[a]), float(u[b])))
        found.append(MinorLoop((low, high), np.array(common), falling, rising))
        k += 2
    return found


def _at(loop: MinorLoop, branch: Literal["down", "up"], inputs: list[float]) -> Array:
    values = loop.down if branch == "down" else loop.up
    return values[np.searchsorted(loop.u, inputs)]


class _ResidualSquares:
    """Squared residuals of rows (one per loop) from their mean, and their degrees of freedom."""

    def __init__(self) -> None:
        self.sum, self.freedom = 0.0, 0

    def add(self, rows: Array, each: int) -> None:
        self.sum += float(np.sum((rows - rows.mean(axis=0)) ** 2))
        self.freedom += each * (rows.shape[0] - 1)

    @property
    def rms(self) -> float:
        return (self.sum / self.freedom) ** 0.5

    def p_value(self, noise: NoiseFloor) -> float:
        ratio = self.sum / (noise.value or np.nan) ** 2
        if noise.n_pairs:
            return f_tail(ratio / self.freedom, self.freedom, noise.n_pairs)
        return chi2_tail(ratio, self.freedom)

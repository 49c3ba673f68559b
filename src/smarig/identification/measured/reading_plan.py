"""The readings of records with a measured input that a fit uses, and the blocks that are held out together.

All hypotheses about the same records are compared on the same readings and blocks. A block is an excursion of the
input, out and back. In a record with fewer than four, branches are cut into segments.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.measurement import InputRecord, StartingState, reversals, spread_rows, starting_state

Integers = NDArray[np.int64]
MOST_READINGS = 600
FEWEST_PER_BRANCH = 6
FEWEST_BLOCKS = 4
SEGMENTS = 10  # of a branch, if there are too few excursions
FOLDS = 5


@dataclass(frozen=True, eq=False)
class ReadingPlan:
    """Readings (m,) of records: ``rows`` of each record, and of each reading its ``record`` and its ``block``.

    ``starts`` is the state at the start of each record; that of a record that continues another is its final state.
    ``segmented``: no record has enough excursions, so blocks are segments of branches, and a fit without one must
    interpolate.
    """

    records: tuple[InputRecord, ...]
    rows: tuple[Integers, ...]
    starts: tuple[StartingState, ...]
    record: Integers
    block: Integers
    segmented: bool = False

    def __len__(self) -> int:
        return self.record.size

    def of(self, values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """Values (n,) or (n, k) of each record at the readings, (m,) or (m, k)."""
        return np.concatenate([v[rows] for v, rows in zip(values, self.rows)])

    @property
    def y(self) -> Array:
        """Measured outputs (m,)."""
        return self.of([r.y for r in self.records])

    def where(self, mask: NDArray[np.bool_]) -> "ReadingPlan":
        """The readings of a mask (m,). Raises DataError if none remains."""
        if not mask.any():
            raise DataError("The selection leaves no reading of the runs. Select more points.")
        ends = np.cumsum([r.size for r in self.rows])[:-1]
        rows = tuple(r[own] for r, own in zip(self.rows, np.split(mask, ends)))
        return replace(self, rows=rows, record=self.record[mask], block=self.block[mask])

    def folds(self, within: NDArray[np.bool_]) -> list[NDArray[np.bool_]]:
        """Masks (m,) of readings to hold out together: the blocks within a mask, dealt in turn."""
        names = np.unique(self.block[within])
        count = min(FOLDS, names.size)
        return [within & np.isin(self.block, names[k::count]) for k in range(count)]


def reading_plan(records: Sequence[InputRecord], most: int = MOST_READINGS) -> ReadingPlan:
    """Readings spread over all branches, half by row and half by output. Raises DataError if none remains."""
    low, high = min(float(r.u.min()) for r in records), max(float(r.u.max()) for r in records)
    turns = [reversals(r.u, r.noise) for r in records]
    branches = sum(len(t) - 1 for t in turns)
    per_branch = max(most // max(branches, 1), FEWEST_PER_BRANCH)
    rows, starts = [], []
    for k, (record, ends) in enumerate(zip(records, turns)):
        start = starting_state(record.initial, record.u, (low, high), turns=ends, outputs=record.y)
        if k and record.continues:
            start = StartingState(start.state)
        starts.append(start)
        if record.readings is not None:
            rows.append(record.readings[record.readings >= start.first])
            continue
        own = [spread_rows(record.y, a, b, per_branch) for a, b in pairwise(ends) if a >= start.first]
        rows.append(np.unique(np.concatenate([*own, np.empty(0, dtype=np.int64)])).astype(np.int64))
    if not sum(r.size for r in rows):
        raise DataError("The runs have no branch with a known start. A fit needs a reversal of the input.")
    number = np.concatenate([np.full(r.size, k) for k, r in enumerate(rows)]).astype(np.int64)
    blocks, segmented = _blocks(rows, turns)
    return ReadingPlan(tuple(records), tuple(rows), tuple(starts), number, blocks, segmented)


def _blocks(rows: Sequence[Integers], turns: Sequence[list[int]]) -> tuple[Integers, bool]:
    """The block of each reading, numbered through all records, and whether the blocks of all are segments."""
    branch = [np.searchsorted(t, r, side="left") - 1 for r, t in zip(rows, turns)]
    whole = [np.unique(b // 2).size >= FEWEST_BLOCKS for b in branch]
    return _numbered([b // 2 if w else _segments(b) for b, w in zip(branch, whole)]), not any(whole)


def _segments(branch: Integers) -> Integers:
    """Each branch cut into segments of equally many readings."""
    found = np.zeros(branch.size, dtype=np.int64)
    for number in np.unique(branch):
        at = np.flatnonzero(branch == number)
        found[at] = number * SEGMENTS + np.arange(at.size) * SEGMENTS // at.size
    return found


def _numbered(parts: Sequence[Integers]) -> Integers:
    found, before = [], 0
    for part in parts:
        found.append(part + before)
        before += int(part.max(initial=-1)) + 1
    return np.concatenate(found).astype(np.int64)

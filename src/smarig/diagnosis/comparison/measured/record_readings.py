"""The readings of one record: its rows, branches, blocks, and the plain variables at each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from smarig.core import Array
from smarig.diagnosis.comparison.measured.wire_records import WireRecord
from smarig.measurement import InputRecord, starting_state

Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]
TRAIN_READINGS, HELD_OUT_READINGS, FEWEST_READINGS = 240, 120, 20
FEWEST_BLOCKS = 10
BLOCK_READINGS = 6
SMOOTH_ROWS = 50  # records of fewer rows are not smoothed


def smooth(u: Array, rows: float) -> Array:
    """The input smoothed over a number of rows; a short record as it is."""
    return gaussian_filter1d(u, rows) if u.size > SMOOTH_ROWS else u


@dataclass(frozen=True, eq=False)
class RecordReadings:
    """The readings of one record, with its turns and the path of its input."""

    record: InputRecord
    rows: Rows
    turns: Rows
    path: Array
    branch: Rows
    train_branches: int
    held_branches: int
    first: Mask

    @classmethod
    def of(cls, wire: WireRecord, turns: Rows, wires: Sequence[WireRecord]) -> "RecordReadings":
        """The readings of one of several records, given its turns."""
        record = wire.record
        path = np.r_[0.0, np.cumsum(np.abs(np.diff(smooth(record.u, 2.0))))]
        low = min(float(w.record.u.min()) for w in wires)
        high = max(float(w.record.u.max()) for w in wires)
        state = starting_state(record.initial, record.u, (low, high), turns=turns.tolist(), outputs=record.y)
        ruler = path / (path[-1] or 1.0) + np.arange(len(record)) / len(record)
        possible = wire.read & (np.arange(len(record)) >= state.first)
        rows = np.union1d(
            _spread(ruler, possible & ~wire.held_out, TRAIN_READINGS, [w.read & ~w.held_out for w in wires]),
            _spread(ruler, possible & wire.held_out, HELD_OUT_READINGS, [w.read & w.held_out for w in wires]),
        ).astype(np.int64)
        branch = np.clip(np.searchsorted(turns, rows, side="right") - 1, 0, len(turns) - 2)
        first = (branch == 0) & state.assumed
        own, held = (np.unique(branch[wire.held_out[rows] == h]).size for h in (False, True))
        return cls(record, rows, turns, path, branch, own, held, first)

    @property
    def cycles(self) -> float:
        """Excursions of the record."""
        return (len(self.turns) - 1) / 2

    def blocks(self, branches: int) -> Rows:
        """The block of each reading (m,), given the number of training branches of all records."""
        if branches >= 2 * FEWEST_BLOCKS:
            joined = int(np.ceil(BLOCK_READINGS * self.cycles / self.rows.size))  # of small excursions
            found = self.branch // (2 * joined)
        elif branches >= FEWEST_BLOCKS:
            found = self.branch
        else:
            cut = int(np.ceil(FEWEST_BLOCKS / max(branches, 1)))
            begin, end = self.path[self.turns[self.branch]], self.path[self.turns[self.branch + 1]]
            share = (self.path[self.rows] - begin) / np.maximum(end - begin, 1e-9)
            found = self.branch * cut + np.clip((share * cut).astype(int), 0, cut - 1)
        return np.unique(found, return_inverse=True)[1]

    def variables(self, number: float, cycles: float) -> dict[str, Array]:
        """The plain variables at the readings, by name."""
        r, rows, turns, branch = self.record, self.rows, self.turns, self.branch
        t = r.elapsed
        rate = np.abs(np.diff(r.u[turns])) / np.maximum(np.diff(t[turns]), 1e-9)
        clock = np.maximum.accumulate(t + 1e-9 * np.arange(t.size))
        local = np.abs(np.gradient(smooth(r.u, 3.0), clock))
        usual = float(np.median(local[local > 0])) if (local > 0).any() else 1.0
        step = float(np.median(np.diff(t))) + 1e-9
        found = {
            "level": r.u[rows],
            "direction": np.sign(np.diff(r.u[turns]))[branch],
            "cycle": cycles + branch / 2,
            "history": r.u[turns[branch]],
            "run": np.full(rows.size, number),
            "rate": np.log10(rate[branch] + 1e-3 * rate.max()),
            "speed": np.log10(np.clip(local[rows], 0.03 * usual, 30 * usual)),
            "time": t[rows],
            "time_since_reversal": np.log10(t[rows] - t[turns[branch]] + step),
        }
        if "stress" in r.conditions:
            found["stress"] = r.condition("stress")[rows]
        return found


def _spread(ruler: Array, mask: Mask, most: int, all_masks: Sequence[Mask]) -> Rows:
    """Rows of a mask, spread evenly over a ruler (n,), as many as the record's share of all rows."""
    at = np.flatnonzero(mask)
    if not at.size:
        return at
    count = max(int(most * at.size / sum(int(m.sum()) for m in all_masks)), FEWEST_READINGS)
    own = np.cumsum(np.diff(ruler[at], prepend=ruler[at[0]]).clip(0))
    return at[np.unique(np.searchsorted(own, np.linspace(0, own[-1], count)).clip(0, at.size - 1))]

"""The readings of a comparison: outputs, blocks, and the plain variables at each.

A block is an excursion of the input, out and back; of records with few excursions a branch, or a segment of one. Blocks
of segments are extrapolated within a loop, so they do not count as excursions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.diagnosis.comparison.measured.record_readings import FEWEST_READINGS, RecordReadings, smooth
from smarig.diagnosis.comparison.measured.wire_records import WireRecord
from smarig.measurement import InputRecord
from smarig.preisach import turning_points

Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]
TURN_SHARE = 0.08  # of the input's range: a smaller turn ends no excursion
BLOCK_PATH = 0.15  # of the input's range: path over which errors within a block are alike


@dataclass(frozen=True, eq=False)
class ReadingProblem:
    """m readings of ``records`` at ``rows``; ``y`` (m,) has a range of one and rises with the input.

    ``block`` (m,) numbers the blocks of training and held-out readings, ``train`` (m,) marks the former. ``variables``
    are plain variables (m,) by name. ``first`` (m,): readings on a first branch whose initial state is assumed.
    ``offset``, ``scale`` (signed) turn y into outputs. ``excursions`` are those of the training readings, and
    ``held_excursions`` those of the others. ``unseen`` are readings of m that no fit sees, by blocks to be predicted.
    ``suspected`` are names of effects that findings of the import would match.
    """

    records: tuple[InputRecord, ...]
    rows: tuple[Rows, ...]
    starts_up: tuple[bool | None, ...]
    record: Rows
    train: Mask
    block: Rows
    y: Array
    variables: Mapping[str, Array]
    path: Array
    first: Mask
    offset: float
    scale: float
    span: float
    excursions: int
    held_excursions: int
    unseen: tuple[Rows, ...] = ()
    suspected: frozenset[str] = frozenset()

    def with_unseen(self) -> "ReadingProblem":
        """With the held-out blocks as further blocks to predict; the fits do not see them."""
        held = np.unique(self.block[~self.train])
        blocks = [np.flatnonzero((self.block == b) & ~self.train) for b in held]
        return replace(self, unseen=tuple(b for b in blocks if b.size > 2))

    @property
    def counts(self) -> Array:
        """Number of readings of each block (B,)."""
        return np.array([b.size for b in (*self.blocks, *self.unseen)], dtype=float)

    @property
    def independent(self) -> int:
        """Excursions that are predicted."""
        return self.excursions + (self.held_excursions if self.unseen else 0)

    @property
    def clock(self) -> bool:
        """Whether all records have a clock."""
        return all(r.clock for r in self.records)

    @property
    def rounding(self) -> float:
        """Standard deviation of the rounding of a reading, of a range of one."""
        return float(np.sqrt(np.mean([r.rounding**2 for r in self.records]))) / abs(self.scale)

    @cached_property
    def blocks(self) -> tuple[Rows, ...]:
        """Positions, among the training readings, of each training block."""
        own = self.block[self.train]
        return tuple(np.flatnonzero(own == b) for b in np.unique(own))

    @cached_property
    def always(self) -> list[Array]:
        """Covariances (m, m) of every hypothesis: a smooth reversible part, and the first branches."""
        smooth = smooth_kernel(self.variables["level"], 0.3)
        if not self.first.any() or self.first.all():
            return [smooth]
        same = self.record[:, None] == self.record
        return [smooth, smooth * same * self.first[:, None] * self.first]

    @cached_property
    def within_block(self) -> Array:
        """Covariance (m, m) of a model's errors within a block."""
        apart = np.abs(self.path[:, None] - self.path) / (BLOCK_PATH * self.span)
        return (self.block[:, None] == self.block) * np.exp(-apart)


def smooth_kernel(z: Array, length: float) -> Array:
    """exp(−Δ²/2) of a variable (m,), over a length as a share of its range."""
    x = (z - z.min()) / (float(np.ptp(z)) or 1.0)
    return np.exp(-0.5 * ((x[:, None] - x) / length) ** 2)


def rough_kernel(z: Array, length: float) -> Array:
    """(1 + √3 Δ) exp(−√3 Δ) of a variable (m,), over a length as a share of its range: functions with one derivative,
    which may be slow waves as well as beats.
    """
    x = np.sqrt(3.0) * (z - z.min()) / ((float(np.ptp(z)) or 1.0) * length)
    apart = np.abs(x[:, None] - x)
    return (1 + apart) * np.exp(-apart)


def reading_problem(wires: Sequence[WireRecord]) -> ReadingProblem:
    """The readings of records. Raises DataError without a training reading."""
    records = [w.record for w in wires]
    known = [~w.held_out for w in wires]
    u = np.concatenate([r.u[k] for r, k in zip(records, known)])
    y = np.concatenate([r.y[k] for r, k in zip(records, known)])
    if u.size < FEWEST_READINGS or not np.ptp(u) or not np.ptp(y):
        raise DataError("The training runs hold too few readings, or their input or output never changes.")
    span, ends = float(np.ptp(u)), np.quantile(u, [0.2, 0.8])
    sign = 1.0 if y[u >= ends[1]].mean() >= y[u <= ends[0]].mean() else -1.0
    turns = [np.array(turning_points(smooth(r.u, 1.0), TURN_SHARE * span)) for r in records]
    parts = [RecordReadings.of(w, t, wires) for w, t in zip(wires, turns)]
    branches = sum(p.train_branches for p in parts)
    block, before, cycles = [], 0, 0.0
    variables: dict[str, list[Array]] = {}
    for number, part in enumerate(parts):
        own = part.blocks(branches)
        block.append(own + before)
        before += int(own.max(initial=-1)) + 1
        for name, z in part.variables(float(number), cycles).items():
            variables.setdefault(name, []).append(z)
        cycles += part.cycles
    train = np.concatenate([~w.held_out[p.rows] for w, p in zip(wires, parts)])
    number = np.concatenate([np.full(p.rows.size, k) for k, p in enumerate(parts)])
    scale, offset = sign * float(np.ptp(y)), float(np.median(y))
    out = np.concatenate([w.record.y[p.rows] for w, p in zip(wires, parts)])
    stressed = len(variables.get("stress", ())) == len(parts)
    return ReadingProblem(
        records=tuple(records),
        rows=tuple(p.rows for p in parts),
        starts_up=tuple({"positive": True, "negative": False}.get(r.initial or "") for r in records),
        record=number,
        train=train,
        block=_whole_blocks(np.concatenate(block), number, train),
        y=(out - offset) / scale,
        variables={k: np.concatenate(v) for k, v in variables.items() if k != "stress" or stressed},
        path=np.concatenate([p.path[p.rows] for p in parts]),
        first=np.concatenate([p.first for p in parts]),
        offset=offset,
        scale=scale,
        span=span,
        excursions=sum(p.train_branches // 2 for p in parts),
        held_excursions=sum(p.held_branches // 2 for p in parts),
    )


def _whole_blocks(block: Rows, record: Rows, train: Mask) -> Rows:
    """Blocks parted into training and held-out readings; one of fewer than three joins its neighbour in the record."""
    key = 2 * block + ~train
    _, found = np.unique(key + 2 * (block.max() + 1) * (~train), return_inverse=True)
    for b in range(int(found.max()) + 1):
        at = np.flatnonzero(found == b)
        if not 0 < at.size < 3:
            continue
        for near in (at[0] - 1, at[-1] + 1):
            if 0 <= near < found.size and record[near] == record[at[0]] and train[near] == train[at[0]]:
                found[at] = found[near]
                break
    return np.unique(found, return_inverse=True)[1]

"""The readings of a thermal record as a problem for a comparison: blocks, errors within a block, plain variables.

A transient is what follows a step or a turn of the drive. A block is a transient, or a part of one where there are few;
such parts share the transient, so they do not count as independent.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.diagnosis.comparison.thermal.balance_fit import FittedBalance
from smarig.diagnosis.comparison.thermal.thermal_record import ThermalRecord
from smarig.preisach import turning_points

Rows = NDArray[np.int64]
TURN_SHARE = 0.08  # of a range: a smaller step or turn begins no transient
FEWEST_BLOCKS = 10
LEAST_ROWS = 4  # of a block
WITHIN = (0.1, 1.0)  # of a block's rows: how far errors of the thermometer, and of the balance, are alike


@dataclass(frozen=True, eq=False)
class ThermalProblem:
    """A record with its blocks: ``block`` (n,) numbers them; ``transients`` are the independent ones.

    ``base`` is the plain balance that the variables are taken from.
    """

    record: ThermalRecord
    base: FittedBalance
    block: Rows
    transients: int

    @cached_property
    def blocks(self) -> tuple[Rows, ...]:
        """Rows of each block."""
        return tuple(np.flatnonzero(self.block == b) for b in range(int(self.block.max()) + 1))

    @property
    def counts(self) -> Array:
        """Number of readings of each block (B,)."""
        return np.array([b.size for b in self.blocks], dtype=float)

    @property
    def rounding(self) -> float:
        """Variance of the rounding of a reading, of a range of one."""
        return (self.record.quantum / self.record.span) ** 2 / 12

    @cached_property
    def within(self) -> tuple[Array, Array]:
        """Covariances (n, n) of errors within a block: short ones, and long ones."""
        rows = np.arange(self.block.size)
        apart = np.abs(rows[:, None] - rows) / float(np.median(self.counts))
        same = self.block[:, None] == self.block
        short, long = (same * np.exp(-apart / length) for length in WITHIN)
        return short, long

    @cached_property
    def variables(self) -> Mapping[str, Array]:
        """Plain variables (n,) by name: time, power, and temperature and heating rate of the plain balance."""
        x, plain = self.record, self.record.temperature - self.base.error
        return {
            "time": x.t,
            "power": x.bin_drive,
            "temperature": plain,
            "heating_rate": np.gradient(plain, x.dt),
        }


def thermal_problem(x: ThermalRecord, base: FittedBalance) -> ThermalProblem:
    """The problem of a record and its plain balance."""
    ends = [0, *_beginnings(x), x.t.size]
    trace = x.temperature - base.error
    path = np.r_[0.0, np.cumsum(np.abs(np.diff(trace)))]
    moved = [path[min(b, x.t.size - 1)] - path[a] for a, b in zip(ends, ends[1:])]
    transients = max(int(np.count_nonzero(np.array(moved) >= TURN_SHARE * x.span)), 1)
    cut = int(np.ceil(FEWEST_BLOCKS / transients))
    block = np.zeros(x.t.size, dtype=np.int64)
    for begin, end, m in zip(ends, ends[1:], moved):
        parts = cut if m >= TURN_SHARE * x.span else 1  # what only rests is one block
        parts = max(min(parts, (end - begin) // LEAST_ROWS), 1)
        ruler = _ruler(path[begin:end])
        block[begin:end] = block[begin - 1] + 1 + np.minimum((ruler * parts).astype(int), parts - 1)
    return ThermalProblem(x, base, _whole(block), transients)


def _ruler(path: Array) -> Array:
    """Shares (m,) of a transient: half of its time, half of its path."""
    own = (path - path[0]) / (float(np.ptp(path)) or 1.0)
    return 0.5 * own + 0.5 * np.arange(path.size) / path.size


def _beginnings(x: ThermalRecord) -> list[int]:
    """Rows at which the drive steps, and those at which it turns between steps."""
    drive = x.bin_drive
    least = TURN_SHARE * float(np.ptp(drive))
    if not least:
        return []
    jump = np.abs(np.diff(drive)) >= least
    steps = np.flatnonzero(jump & ~np.r_[False, jump[:-1]]) + 1
    found: list[int] = []
    for k in sorted({*steps.tolist(), *_turns(drive, least, np.r_[0, steps, drive.size])}):
        if k - (found[-1] if found else 0) >= LEAST_ROWS and x.t.size - k >= LEAST_ROWS:
            found.append(k)
    return found


def _turns(drive: Array, least: float, ends: Rows) -> list[int]:
    """Turns within the parts between ``ends``; a part of constant drive has none, but noise."""
    found: list[int] = []
    for begin, end in zip(ends[:-1].tolist(), ends[1:].tolist()):
        own = drive[begin:end]
        settled = own[np.abs(own - np.median(own)) < least]
        if settled.size <= own.size // 2:
            found += [begin + k for k in turning_points(own, least) if 0 < k < own.size - 1]
    return found


def _whole(block: Rows) -> Rows:
    """Blocks without those of a row or two, which join the one before."""
    found = block.copy()
    for b in np.unique(block)[1:]:
        rows = np.flatnonzero(block == b)
        if rows.size < LEAST_ROWS:
            found[rows] = found[rows[0] - 1]
    return np.unique(found, return_inverse=True)[1]

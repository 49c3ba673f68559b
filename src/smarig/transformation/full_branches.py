"""The full heating and cooling branches of a record, paired to cycles, and the branches that are not used.

A full branch runs from one end of the temperature's range to the other. A run of first-order curves has only one full
branch in one of both directions. For settled readings the other is assembled: each curve that starts at the end of the
range lies on the major loop up to its first reversal (wiping-out, §3.3.1).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from smarig.core import Array
from smarig.measurement import input_noise_sd
from smarig.preisach import turning_points
from smarig.transformation.temperature_record import TemperatureRecord

HEATING, COOLING = "heating", "cooling"
_REVERSAL = 0.1  # of the temperature's range: a smaller reversal does not end a branch
_ZIGZAG = 0.3  # share of the readings at which the temperature turns: more is noise
_MARGIN, _MOST_REVERSAL = (
    1.2,
    0.4,
)  # times the range of the noise over all readings; of the temperature's range
_FULL = 0.1  # of the temperature's range: farthest that a full branch may end from both ends
_AT_END = 0.02  # of the temperature's range: readings within it are at the end
_SAME = 1e-3  # of the temperature's range: commanded temperatures within it are one
_MOST_READINGS = 600  # of a branch: blocks of consecutive readings are averaged
_FEWEST = 10


@dataclass(frozen=True, eq=False)
class FullBranch:
    """Readings u and y (n,) in measured order; ``cycle`` counts from 1. ``curves`` it was assembled from, 1 if none.

    ``rate_K_per_s`` is the mean rate of the temperature, None if it settled at each reading or if times are not known.
    """

    direction: str
    cycle: int
    u: Array
    y: Array
    curves: int = 1
    rate_K_per_s: float | None = None

    def rising(self) -> tuple[Array, Array]:
        """The readings in the order of rising temperature."""
        return (self.u, self.y) if self.direction == HEATING else (self.u[::-1], self.y[::-1])


@dataclass(frozen=True)
class UnusedBranch:
    """A branch that is not used, from one temperature to another, and why. ``cycle`` is 0 outside a cycle."""

    direction: str
    cycle: int
    from_: float
    to: float
    reason: str

    def sentence(self, unit: str) -> str:
        """The branch and the reason in one line."""
        which = f"Cycle {self.cycle}, {self.direction}" if self.cycle else f"A {self.direction} branch"
        return f"{which} from {self.from_:.4g} to {self.to:.4g} {unit}: {self.reason}."

    def to_json(self) -> dict[str, object]:
        """As a JSON object."""
        return {
            "direction": self.direction,
            "cycle": self.cycle,
            "from": self.from_,
            "to": self.to,
            "reason": self.reason,
        }


def full_branches(record: TemperatureRecord) -> tuple[list[FullBranch], list[UnusedBranch]]:
    """The full branches in order, numbered by cycles, and the others."""
    if record.u.size < 3 or np.ptp(record.u) == 0:
        return [], []
    full, unused = branch_rows(record)
    branches = list(_in_cycles(record, full))
    if record.settled:
        branches = _with_assembled(record, branches)
    return branches, unused


def branch_rows(record: TemperatureRecord) -> tuple[list[tuple[int, int]], list[UnusedBranch]]:
    """First and last row of each full branch of a record (n,), and the branches that are too short."""
    u, size = record.u, float(np.ptp(record.u))
    turns = turning_points(u, _reversal(record) * size)
    full: list[tuple[int, int]] = []
    unused: list[UnusedBranch] = []
    for a, b in pairwise(sorted({0, *turns, u.size - 1})):
        low, high = float(min(u[a], u[b])), float(max(u[a], u[b]))
        if low <= u.min() + _FULL * size and high >= u.max() - _FULL * size:
            full.append((a, b))
        elif high - low > _AT_END * size:
            reason = f"it covers {100 * (high - low) / size:.0f} % of the temperature range, so it is not a full one"
            unused.append(UnusedBranch(direction_of(u, a, b), 0, float(u[a]), float(u[b]), reason))
    return full, unused


def _reversal(record: TemperatureRecord) -> float:
    """The smallest reversal that ends a branch, as a share of the range: larger than the noise of the temperature."""
    u, size = record.u, float(np.ptp(record.u))
    steps = np.diff(u)
    zigzag = np.mean(steps[1:] * steps[:-1] < 0) if steps.size > 1 else 0.0
    if record.settled or zigzag < _ZIGZAG:
        return _REVERSAL
    swing = 2 * float(np.sqrt(2 * np.log(u.size))) * input_noise_sd(u) / size
    return float(np.clip(_MARGIN * swing, _REVERSAL, _MOST_REVERSAL))


def _in_cycles(record: TemperatureRecord, full: list[tuple[int, int]]) -> Iterator[FullBranch]:
    """Branches in order; two that follow each other without a gap are one cycle."""
    cycle, waiting = 0, -1  # the last row of a first branch
    for a, b in full:
        second = a == waiting
        cycle += not second
        waiting = -1 if second else b
        u, y = _averaged(record.u[a : b + 1], record.y[a : b + 1])
        yield FullBranch(direction_of(record.u, a, b), cycle, u, y, rate_K_per_s=_rate(record, a, b))


def _rate(record: TemperatureRecord, a: int, b: int) -> float | None:
    if record.t_s is None or not record.t_s[b] > record.t_s[a]:
        return None
    return float(abs(record.u[b] - record.u[a]) / (record.t_s[b] - record.t_s[a]))


def _averaged(u: Array, y: Array) -> tuple[Array, Array]:
    """Means of blocks of consecutive readings, so that a branch has at most 600."""
    size = -(-u.size // _MOST_READINGS)
    if size == 1:
        return u, y
    starts = np.arange(0, u.size, size)
    counts = np.diff(np.append(starts, u.size))
    return np.add.reduceat(u, starts) / counts, np.add.reduceat(y, starts) / counts


def _with_assembled(record: TemperatureRecord, branches: list[FullBranch]) -> list[FullBranch]:
    """The branches; those of a direction that has none with enough readings are assembled."""
    for direction in (HEATING, COOLING):
        own = [b for b in branches if b.direction == direction]
        if any(b.u.size >= _FEWEST for b in own):
            continue
        assembled = _assembled(record, direction)
        if assembled is not None:
            others = [b for b in branches if b.direction != direction and b.u.size >= _FEWEST]
            branches = [assembled, *(FullBranch(b.direction, 1, b.u, b.y) for b in others[-1:])]
    return branches


def _assembled(record: TemperatureRecord, direction: str) -> FullBranch | None:
    """The readings of a direction that lie on the major loop: from an end of the range to the first reversal."""
    sign = 1.0 if direction == HEATING else -1.0
    u, near = sign * record.u, _SAME * float(np.ptp(record.u))
    start = u.min() + near
    points: dict[float, list[float]] = {}
    curves, on_loop = 0, False
    for k in range(u.size):
        if u[k] <= start:
            on_loop = True
        elif on_loop and u[k] > u[k - 1]:
            curves += u[k - 1] <= start
        else:
            on_loop = False
        if on_loop:
            points.setdefault(round(float(u[k]), 9), []).append(float(record.y[k]))
    if len(points) < _FEWEST or max(points) < u.max() - near:
        return None
    inputs = np.array(sorted(points))
    outputs = np.array([float(np.mean(points[v])) for v in inputs])
    return FullBranch(direction, 1, sign * inputs, outputs, curves)


def direction_of(u: Array, a: int, b: int) -> str:
    """Whether a branch of temperatures u (n,), from row ``a`` to row ``b``, is one of heating or of cooling."""
    return HEATING if u[b] > u[a] else COOLING

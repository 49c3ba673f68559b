"""The full heating and cooling branches of a record, paired to cycles, and the branches that are not used.

A full branch runs from one end of the temperature's range to the other. Where an inner loop interrupts it, it goes on
as if that had not been (wiping-out), so the readings of the loop are left out. A run of first-order curves has only one
full branch in one of both directions. For settled readings the other is assembled: each curve that starts at the end of
the range lies on the major loop up to its first reversal (wiping-out, §3.3.1).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

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
    ``inner_loops``: the number of inner loops that interrupted it.
    """

    direction: str
    cycle: int
    u: Array
    y: Array
    curves: int = 1
    rate_K_per_s: float | None = None
    inner_loops: int = 0

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
    turns = _turns(record)
    full = _least_interrupted(record.u, _between_ends(record.u, turns), turns)
    branches = list(_in_cycles(record, full, turns, adjacent=True))
    if not {b.cycle for b in branches if b.direction == HEATING} & {
        b.cycle for b in branches if b.direction == COOLING
    }:
        branches = list(_in_cycles(record, full, turns, adjacent=False))
    if record.settled:
        branches = _with_assembled(record, branches)
    outside = [(a, b) for a, b in pairwise(turns) if not any(c <= a and b <= d for c, d in full)]
    return branches, list(_unused(record.u, outside))


def branch_rows(record: TemperatureRecord) -> tuple[list[tuple[int, int]], list[UnusedBranch]]:
    """First and last row of each full branch of a record (n,), and the branches that are too short."""
    full, others = [], []
    for ends in pairwise(_turns(record)):
        (full if len({*_ends_at(record.u, ends)} - {None}) == 2 else others).append(ends)
    return full, list(_unused(record.u, others))


def _turns(record: TemperatureRecord) -> list[int]:
    """The rows at which the temperature turns, with the first and the last."""
    turns = turning_points(record.u, _reversal(record) * float(np.ptp(record.u)))
    return sorted({0, *turns, record.u.size - 1})


def _ends_at(u: Array, rows: Sequence[int]) -> list[str | None]:
    """For each row, the end of the range at which it lies: "low", "high" or None."""
    margin = _FULL * float(np.ptp(u))
    low, high = float(u.min()) + margin, float(u.max()) - margin
    return ["low" if u[k] <= low else "high" if u[k] >= high else None for k in rows]


def _between_ends(u: Array, turns: Sequence[int]) -> list[tuple[int, int]]:
    """First and last row of each way from one end of the range to the other, with whatever lies between."""
    found: list[tuple[int, int]] = []
    began, last_end = -1, None
    for row, end in zip(turns, _ends_at(u, turns)):
        if end is not None:
            if last_end not in (None, end):
                found.append((began, row))
            began, last_end = row, end
    return found


def _least_interrupted(
    u: Array, full: Sequence[tuple[int, int]], turns: Sequence[int]
) -> list[tuple[int, int]]:
    """The branches of each direction that no inner loop interrupts; if it has none of these, all of them."""
    whole = [ends for ends in full if not any(ends[0] < k < ends[1] for k in turns)]
    have = {direction_of(u, *ends) for ends in whole}
    return [ends for ends in full if ends in whole or direction_of(u, *ends) not in have]


def _unused(u: Array, branches: Iterable[tuple[int, int]]) -> Iterator[UnusedBranch]:
    size = float(np.ptp(u))
    for a, b in branches:
        share = abs(float(u[b] - u[a])) / size
        if share > _AT_END:
            reason = f"it covers {100 * share:.0f} % of the temperature range, so it is not a full one"
            yield UnusedBranch(direction_of(u, a, b), 0, float(u[a]), float(u[b]), reason)


def _reversal(record: TemperatureRecord) -> float:
    """The smallest reversal that ends a branch, as a share of the range: larger than the noise of the temperature."""
    u, size = record.u, float(np.ptp(record.u))
    steps = np.diff(u)
    zigzag = np.mean(steps[1:] * steps[:-1] < 0) if steps.size > 1 else 0.0
    if record.settled or zigzag < _ZIGZAG:
        return _REVERSAL
    swing = 2 * float(np.sqrt(2 * np.log(u.size))) * input_noise_sd(u) / size
    return float(np.clip(_MARGIN * swing, _REVERSAL, _MOST_REVERSAL))


def _in_cycles(
    record: TemperatureRecord, full: list[tuple[int, int]], turns: Sequence[int], *, adjacent: bool
) -> Iterator[FullBranch]:
    """Branches in order; one and its reverse are one cycle, if they follow each other, ``adjacent`` without a gap."""
    cycle = 0
    first: tuple[int, int] | None = None
    for a, b in full:
        second = (
            first is not None
            and direction_of(record.u, *first) != direction_of(record.u, a, b)
            and (first[1] == a or not adjacent)
        )
        cycle += not second
        first = None if second else (a, b)
        rows, loops = _without_inner_loops(record.u, a, b, [k for k in turns if a < k < b])
        u, y = _averaged(record.u[rows], record.y[rows])
        rate = _rate(record, rows)
        yield FullBranch(direction_of(record.u, a, b), cycle, u, y, rate_K_per_s=rate, inner_loops=loops)


def _without_inner_loops(u: Array, a: int, b: int, turns: Sequence[int]) -> tuple[NDArray[np.int64], int]:
    """The rows from a to b, without those of inner loops, and how many of these there are.

    A loop begins at a turn, and ends where the temperature is back there.
    """
    sign, kept, loops = np.sign(u[b] - u[a]), np.ones(b - a + 1, dtype=bool), 0
    for turn in turns:
        if not kept[turn - a]:
            continue
        back = np.flatnonzero(sign * (u[turn + 1 : b + 1] - u[turn]) >= 0)
        if back.size and back[0]:
            kept[turn - a + 1 : turn - a + 1 + back[0]] = False
            loops += 1
    return a + np.flatnonzero(kept), loops


def _rate(record: TemperatureRecord, rows: NDArray[np.int64]) -> float | None:
    if record.t_s is None:
        return None
    following = np.diff(rows) == 1
    seconds = float(np.diff(record.t_s[rows])[following].sum())
    return abs(float(np.diff(record.u[rows])[following].sum())) / seconds if seconds > 0 else None


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

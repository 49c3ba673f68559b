"""Brings channels with clocks of their own into common rows, without interpolation: each reading stays as it is.

The rows are the readings of the channel that has most of them. A reading of any other channel stands in the row of the
nearest reading of the channel with the next more readings, so that two slow channels meet in one row. It has none if
that reading is more than half a usual step away, as within a pause, or has a nearer partner.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, shown

_ROUNDING = 1e-6  # of a step: half a step is still one after clocks were rounded


@dataclass(frozen=True)
class JoinedClocks:
    """``rows`` of the readings of each channel, -1 for one without; ``base``: the channel whose readings the rows are;
    ``shift``: the longest time between a reading and its row.
    """

    rows: tuple[NDArray[np.int64], ...]
    base: int
    shift: float

    @property
    def left_out(self) -> int:
        """The number of readings without a row."""
        return sum(int((rows < 0).sum()) for rows in self.rows)

    def in_rows(self, channel: int, values: Array) -> Array:
        """The readings of a channel in the common rows, NaN where it has none."""
        rows = self.rows[channel]
        found = np.full(self.rows[self.base].size, np.nan)
        found[rows[rows >= 0]] = values[rows >= 0]
        return found

    def sentence(self, base: str) -> str:
        """How readings came into one row; ``base`` is the name of the channel whose readings the rows are."""
        text = f"The rows are the readings of {shown(base)}"
        if (
            all(rows.size == self.rows[self.base].size for rows in self.rows)
            and not self.shift
            and not self.left_out
        ):
            return f"{text}; all others have the same times."
        text += ", and those of another stand in the row that is nearest in time; nothing is interpolated."
        return (
            f"{text} Without such a row within half a step, and left out: {self.left_out}."
            if self.left_out
            else text
        )


def share_times(clocks: Sequence[Array]) -> bool:
    """Whether channels with times that rise were read at one time, at least in part."""
    return max(t[0] for t in clocks) < min(t[-1] for t in clocks)


def joined_clocks(clocks: Sequence[Array]) -> JoinedClocks:
    """The common rows of channels, whose readings have the times ``clocks``, (n,) each."""
    order = sorted(range(len(clocks)), key=lambda k: -clocks[k].size)
    base = order[0]
    rows = {base: np.arange(clocks[base].size)}
    for faster, slower in zip(order, order[1:]):
        nearest = _nearest(clocks[slower], clocks[faster])
        rows[slower] = np.where(nearest < 0, -1, rows[faster][nearest])
    shifts = [np.abs(clocks[k] - clocks[base][rows[k]])[rows[k] >= 0] for k in order]
    longest = max((float(shift.max()) for shift in shifts if shift.size), default=0.0)
    return JoinedClocks(tuple(rows[k] for k in range(len(clocks))), base, longest)


def _nearest(times: Array, of: Array) -> NDArray[np.int64]:
    """The index in ``of`` of the reading nearest to each time; -1 if it is too far, or nearer to another time."""
    order = np.argsort(of, kind="stable")
    ordered = of[order]
    after = np.clip(np.searchsorted(ordered, times), 1, max(ordered.size - 1, 1)).clip(max=ordered.size - 1)
    before = (after - 1).clip(min=0)
    index = np.where(times - ordered[before] <= ordered[after] - times, before, after)
    apart = np.abs(times - ordered[index])
    found = np.where(apart <= _half_step(ordered), index, -1)
    nearest_first = np.lexsort((apart, found))
    taken = nearest_first[1:][np.diff(found[nearest_first]) == 0]
    found[taken] = -1
    return np.where(found < 0, -1, order[found])


def _half_step(ordered: Array) -> float:
    step = np.diff(ordered)
    moving = step[step > 0]
    return float(np.median(moving)) * (0.5 + _ROUNDING) if moving.size else 0.0

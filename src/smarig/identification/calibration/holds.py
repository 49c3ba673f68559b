"""Holds: the segments of a run after a step of the drive, in which a time constant can be seen."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, Quality
from smarig.record import Run, suspect_rows

_STEP = 0.02  # of the drive's range: a larger change between two samples is a step
_FEWEST = 10  # readings
_GAP_S = 2.0  # a run whose clock jumps by more was interrupted there
_INVALID = (
    Quality.STALE | Quality.TRIPPED | Quality.SUSPECT
)  # a saturated command still has a measured current


@dataclass(frozen=True)
class DriveHold:
    """Rows [begin, end) of a run after a step of the drive, which is constant until the next step."""

    begin: int
    end: int
    before: float
    drive: float


def drive_name(run: Run) -> str | None:
    """The column that heats the wire: commanded or measured current, else an input that is not a temperature."""
    for name in ("current_command_A", "current_A"):
        if run.has(name):
            return name
    return "input" if run.has("input") and run.input_unit not in ("K", "degC", "°C") else None


def drive_holds(run: Run) -> list[DriveHold]:
    """Holds that follow a step, in order; none without a clock or a drive, and none in a ramp."""
    name = drive_name(run)
    if name is None or not run.has("t_s"):
        return []
    drive = run[name]
    size = float(np.nanmax(drive) - np.nanmin(drive))
    if size == 0:
        return []
    edges = [*(np.flatnonzero(np.abs(np.diff(drive)) > _STEP * size) + 1).tolist(), len(run)]
    found = []
    for begin, end in pairwise(edges):
        level = drive[begin:end]
        if _interrupted_before(run, begin):
            continue  # the motion in between is unknown
        if end - begin >= _FEWEST and np.nanmax(level) - np.nanmin(level) <= 2 * _STEP * size:
            found.append(DriveHold(begin, end, float(drive[begin - 1]), float(np.nanmean(level))))
    return found


def _interrupted_before(run: Run, row: int) -> bool:
    """Whether a run with ticks of its own was interrupted just before a row."""
    t = run["t_s"]
    return bool(run.info.period_s) and bool(t[row] - t[row - 1] > _GAP_S)


def valid_rows(run: Run) -> NDArray[np.bool_]:
    """Mask (n,) of rows whose sample is neither stale nor suspect nor after a trip."""
    quality = np.nan_to_num(run["quality"]).astype(int)
    return ((quality & int(_INVALID)) == 0) & ~suspect_rows(run)


def at_range_end(x: Array) -> NDArray[np.bool_]:
    """Mask (n,) of readings of a finely resolved sensor that repeat its largest value: the end of its range.

    >>> at_range_end(np.array([20.1, 35.7, 61.2, 90.0, 90.0, 90.0])).tolist()
    [False, False, False, True, True, True]
    """
    at = x == np.nanmax(x)
    others = x[~at & np.isfinite(x)]
    fine = np.unique(others).size > 0.5 * others.size
    return at if at.sum() >= 3 and fine else np.zeros(x.size, dtype=bool)

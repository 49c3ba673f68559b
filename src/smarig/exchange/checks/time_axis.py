"""Checks of the time axis of a file: order, repeats and gaps. Time is repaired only as the mapping states."""

from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, shown
from smarig.record import ImportFinding, remarks

_REGISTERS = (2.0**16, 2.0**32)  # numbers of values of a counter, as of milliseconds in a microcontroller
Repeats = Literal["refuse", "mean", "keep_order"]


def check_time(path: Path, name: str, t_s: Array, line: NDArray[np.int64], repeated: Repeats) -> None:
    """Raise DataError with the line if time is missing, runs backwards, or repeats without permission."""
    bad = np.flatnonzero(~np.isfinite(t_s))
    if bad.size:
        raise DataError(
            f"{path}, line {line[bad[0]]}: {shown(name)} is empty or NaN. Every row needs a time."
        )
    step = np.diff(t_s)
    back = np.flatnonzero(step < 0)
    if back.size:
        k = int(back[0]) + 1
        raise DataError(
            f"{path}, line {line[k]}: {shown(name)} goes back from {t_s[k - 1]:g} s to {t_s[k]:g} s. "
            f"Sort the file by time, or split it where the clock was reset."
        )
    same = np.flatnonzero(step == 0)
    if same.size and repeated == "refuse":
        k = int(same[0]) + 1
        raise DataError(
            f"{path}, line {line[k]}: {shown(name)} repeats {t_s[k]:g} s ({same.size} repeats in all). "
            f'Set [time] repeated = "mean" or "keep_order" in a mapping file.'
        )


def joined_clock(name: str, t_s: Array, line: NDArray[np.int64]) -> tuple[Array, list[ImportFinding]]:
    """A clock (n,) that starts again, continued one usual step after each last reading, and a finding on it.

    >>> joined_clock("t", np.array([0.0, 1.0, 2.0, 0.0, 1.0]), np.arange(2, 7))[0].tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0]
    """
    step = np.diff(t_s)
    back = np.flatnonzero(step < 0) + 1
    if not back.size or not (step > 0).any():
        return t_s, []
    usual = float(np.median(step[step > 0]))
    later = np.zeros(t_s.size)
    later[back] = usual - step[back - 1]
    places = f"in line {line[back[0]]}" + (f" and {back.size - 1} more times" if back.size > 1 else "")
    text = (
        f"{shown(name)} starts again at {t_s[back[0]]:g} s {places}: the log was resumed. Its parts are joined to one "
        f"record, in which the specimen keeps its state, with a gap of one usual step ({usual:.3g} s); how long the "
        "pause was is not known."
    )
    return t_s + np.cumsum(later), [ImportFinding(text, "restarted clock")]


def unwrapped(x: Array) -> Array:
    """A counter (n,) that begins again from 0 after its highest value, continued; other columns as they are.

    It is one if it rises but for falls as large as the range of a register, less a step that it makes elsewhere.

    >>> unwrapped(np.array([65000.0, 65200.0, 65400.0, 64.0, 264.0])).tolist()
    [65000.0, 65200.0, 65400.0, 65600.0, 65800.0]
    """
    step = np.diff(x)
    falls = step < 0
    if not falls.any() or falls.all() or not np.isfinite(x).all():
        return x
    least, most = step[~falls].min(), step[~falls].max()
    for size in _REGISTERS:
        over = step[falls] + size
        if least > 0 and (over >= least).all() and (over <= most).all() and 0 <= x.min() <= x.max() < size:
            return x + size * np.cumsum(np.concatenate([[False], falls]))
    return x


def counter_findings(name: str, wrapped: Array, x: Array, line: NDArray[np.int64]) -> list[ImportFinding]:
    """A finding on a counter ``wrapped`` (n,) that was continued as ``x``."""
    changed = np.flatnonzero(x != wrapped)
    if not changed.size:
        return []
    return remarks(
        f"{shown(name)} is a counter that began again from 0 in line {line[changed[0]]}, after its highest value; "
        "it is continued."
    )


def time_findings(t_s: Array, line: NDArray[np.int64], repeated: Repeats) -> list[ImportFinding]:
    """Findings on repeats and gaps."""
    step = np.diff(t_s)
    out = []
    same = int((step == 0).sum())
    if same:
        what = (
            "each group was replaced by its mean" if repeated == "mean" else "the order of the file was kept"
        )
        out.append(
            ImportFinding(f"{same} rows repeat the time of the previous row; {what}.", "repeated times")
        )
    moving = step[step > 0]
    if moving.size < 3:
        return out
    usual = float(np.median(moving))
    gaps = step > 10 * usual
    if gaps.any():
        k = int(np.argmax(step))
        text = (
            f"{int(gaps.sum())} time gaps of more than ten times the usual {usual:.3g} s, "
            f"the longest {step[k]:.3g} s after line {line[k]}."
        )
        out.append(ImportFinding(text, "time gaps"))
    return out


def merge_repeats(t_s: Array, columns: dict[str, Array]) -> tuple[NDArray[np.int64], dict[str, Array]]:
    """Replace rows of one time by their mean: index of each group's first row, and the columns (k,).

    A mean ignores NaN cells and is NaN if all are NaN.
    """
    _, first, group = np.unique(t_s, return_index=True, return_inverse=True)
    out = {}
    for name, x in columns.items():
        known = np.isfinite(x)
        n = np.bincount(group, weights=known, minlength=first.size)
        total = np.bincount(group, weights=np.where(known, x, 0.0), minlength=first.size)
        out[name] = np.divide(total, n, out=np.full(first.size, np.nan), where=n > 0)
    return first.astype(np.int64), out

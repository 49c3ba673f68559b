"""Records of runs for a comparison: parts of one record joined, and the input without its own noise.

    σ_u = median |Δ²u| / (0.6745 √6),    smoothing over (σ_u / 0.003 range)² / 2√π rows

Noise of the input makes memory that the wire does not have. It is smoothed alike for all hypotheses; otherwise an
effect that smooths the input would be credited with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from smarig.core import Array
from smarig.measurement import InputRecord, input_records
from smarig.record import Run
from smarig.replay import same_condition

Mask = NDArray[np.bool_]
Part = tuple[InputRecord, bool, Mask]  # of a record: whether it is held out, and the rows that may be read
QUIET_SHARE = 0.003  # of the range: noise that makes no memory worth a name
LONGEST_SHARE = 0.05  # of the rows, of the smoothing


@dataclass(frozen=True, eq=False)
class WireRecord:
    """A ``record`` that starts in a state of its own, its ``held_out`` rows (n,), and those that may be ``read``."""

    record: InputRecord
    held_out: Mask
    read: Mask


def wire_records(
    train: Sequence[Run], held_out: Sequence[Run], selected: Sequence[Mask] | None = None
) -> list[WireRecord]:
    """The records of training and held-out runs; one that goes on, by its clock or its word, is a part of that before.

    ``selected``: the rows (n,) of each run that may be read; None: all.
    """
    count = len(input_records(train))
    joined: list[list[Part]] = []
    for number, record in enumerate(input_records([*train, *held_out])):
        read = np.ones(len(record), dtype=bool) if selected is None else selected[number]
        entry = (record, number >= count, read)
        if joined and (record.continues or _goes_on(joined[-1][-1][0], record)):
            joined[-1].append(entry)
        else:
            joined.append([entry])
    return [_joined(parts) for parts in joined]


def _goes_on(before: InputRecord, record: InputRecord) -> bool:
    """Whether a record is the next part of one that was cut: its clock goes on without a pause, at one condition."""
    if not (before.clock and record.clock) or not _under_one_condition(before, record):
        return False
    longest = max(float(np.diff(r.t).max()) for r in (before, record))
    return 0.0 < float(record.t[0] - before.t[-1]) <= longest


def _under_one_condition(before: InputRecord, record: InputRecord) -> bool:
    """Whether two records state the same conditions, with about equal values: a joined record has one of each."""
    ours, theirs = before.conditions, record.conditions
    return set(ours) == set(theirs) and all(same_condition(ours[n], theirs[n], "") for n in ours)


def _joined(parts: list[Part]) -> WireRecord:
    records = [r for r, _, _ in parts]
    held = np.concatenate([np.full(len(r), h) for r, h, _ in parts])
    columns: dict[str, Any] = {
        key: np.concatenate([getattr(r, key) for r in records]) for key in ("u", "y", "cycle", "row")
    }
    clock = all(r.clock for r in records)
    t = _clock(records) if clock else np.arange(held.size, dtype=float)
    whole = replace(records[0], **columns, t=t, clock=clock, readings=None)
    return WireRecord(
        replace(whole, u=quiet_input(whole.u)), held, np.concatenate([read for _, _, read in parts])
    )


def _clock(records: Sequence[InputRecord]) -> Array:
    """The time of joined records; a clock that starts again goes on from the last reading."""
    parts: list[Array] = []
    for record in records:
        t = record.t
        if parts and t[0] <= parts[-1][-1]:
            t = t - t[0] + parts[-1][-1] + float(np.median(np.diff(t)))
        parts.append(t)
    return np.concatenate(parts)


def quiet_input(u: Array) -> Array:
    """The input smoothed as far as its own noise asks for.

    >>> quiet_input(np.arange(5.0)).tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0]
    """
    span = float(np.ptp(u))
    if u.size < 5 or not span:
        return u
    noise = float(np.median(np.abs(np.diff(u, 2)))) / 0.6745 / np.sqrt(6.0)
    rows = (noise / (QUIET_SHARE * span)) ** 2 / (2 * np.sqrt(np.pi))
    return gaussian_filter1d(u, min(rows, LONGEST_SHARE * u.size)) if rows > 0.3 else u

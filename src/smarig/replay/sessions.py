"""Several sittings at one wire as one story: each begins anew, with its own clock, its own zero, rested wires.

Readings of one kind stand together, sitting after sitting; clocks are put far enough apart that no draught lasts
from one to the next. Knows no model.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core.errors import DataError
from smarig.record import CONTINUED
from smarig.replay.timeline import OTHER_KINDS, Array, DriveProfile, Integers, ReadingSeries, Timeline

SESSION_SPACING_S = 36000.0


def join_sessions(timelines: Sequence[Timeline]) -> Timeline:
    """One story of several sittings. DataError when they do not begin in the same state.

    A sitting whose first run is not given (it is ``continued``) is believed to have begun like the others.
    """
    starts = {str(timeline.runs[0].info.initial) for timeline in timelines} - {CONTINUED}
    if len(starts) > 1:
        raise DataError(
            f"The sittings begin in different states ({', '.join(sorted(starts))}): diagnose those that begin alike."
        )
    first, second = timelines[0], timelines[1:]
    clock = session_offsets_s(timelines)
    steps = _cumulative_before([len(s.settled) for s in timelines])
    units = {r.kind: r.unit for timeline in timelines for r in timeline.other_readings}
    kinds = {kind: units[kind] for kind in OTHER_KINDS if kind in units}
    return replace(
        first,
        drive=_joined_drive(timelines, clock),
        settled=_joined_readings(first.settled.kind, first.unit, timelines, clock, steps),
        other_readings=tuple(
            _joined_readings(kind, unit, timelines, clock, steps) for kind, unit in kinds.items()
        ),
        target_K=np.concatenate([s.target_K for s in timelines]),
        hold_s=np.concatenate([s.hold_s for s in timelines]),
        run=_renumbered([s.run for s in timelines], [len(s.runs) for s in timelines]),
        block=_renumbered([s.block for s in timelines], [int(s.block.max()) + 1 for s in timelines]),
        runs=(*first.runs, *(run for timeline in second for run in timeline.runs)),
        zero=np.concatenate([np.full(len(s.settled), k) for k, s in enumerate(timelines)]).astype(np.int64),
        sessions=tuple(timelines),
    )


def session_offsets_s(timelines: Sequence[Timeline]) -> Array:
    """When each sitting begins on the common clock, s."""
    return _cumulative_before([float(s.drive.end_s[-1]) + SESSION_SPACING_S for s in timelines])


def _cumulative_before(sizes: Sequence[float]) -> Array:
    """Sum of all earlier ones, for each."""
    return np.concatenate([[0.0], np.cumsum(sizes)[:-1]])


def _renumbered(numbers: Sequence[Integers], sizes: Sequence[int]) -> Integers:
    return np.concatenate([n + int(b) for n, b in zip(numbers, _cumulative_before(sizes))]).astype(np.int64)


def _joined_drive(timelines: Sequence[Timeline], clock: Array) -> DriveProfile:
    """All currents, none between the sittings."""
    ends, currents = [], []
    for timeline, begin in zip(timelines, clock.tolist()):
        ends += [[begin], timeline.drive.end_s + begin] if begin else [timeline.drive.end_s]
        currents += [[0.0], timeline.drive.current_A] if begin else [timeline.drive.current_A]
    return DriveProfile(np.concatenate(ends), np.concatenate(currents), timelines[0].drive.tau_s)


def _joined_readings(
    kind: str, unit: str, timelines: Sequence[Timeline], clock: Array, steps: Array
) -> ReadingSeries:
    own = [
        (r, begin, int(step))
        for timeline, begin, step in zip(timelines, clock.tolist(), steps.tolist())
        for r in timeline.all_readings
        if r.kind == kind
    ]
    return ReadingSeries(
        kind,
        np.concatenate([r.value for r, _, _ in own]),
        np.concatenate([r.t_s + begin for r, begin, _ in own]),
        np.concatenate([r.step + step for r, _, step in own]).astype(np.int64),
        unit,
    )

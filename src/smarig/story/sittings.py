"""Several sittings at one wire as one story: each begins anew, with its own clock, its own zero, rested wires.

Readings of one kind stand together, sitting after sitting; clocks are put far enough apart that no draught lasts
from one to the next. Knows no model.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.errors import DataError
from smarig.record import CONTINUED
from smarig.story.told import CHANNELS, Array, Drive, Integers, Readings, Story

APART_S = 36000.0


def joined(stories: Sequence[Story]) -> Story:
    """One story of several sittings. DataError when they do not begin in the same state.

    A sitting whose first run is not given (it is ``continued``) is believed to have begun like the others.
    """
    starts = {str(story.runs[0].meta.get("initial")) for story in stories} - {CONTINUED}
    if len(starts) > 1:
        raise DataError(
            f"The sittings begin in different states ({', '.join(sorted(starts))}): diagnose those that begin alike."
        )
    first, second = stories[0], stories[1:]
    clock = offsets(stories)
    steps = _before([len(s.settled) for s in stories])
    units = {r.kind: r.unit for story in stories for r in story.others}
    kinds = {kind: units[kind] for kind in CHANNELS if kind in units}
    return replace(
        first,
        drive=_drives(stories, clock),
        settled=_together(first.settled.kind, first.unit, stories, clock, steps),
        others=tuple(_together(kind, unit, stories, clock, steps) for kind, unit in kinds.items()),
        target_K=np.concatenate([s.target_K for s in stories]),
        hold_s=np.concatenate([s.hold_s for s in stories]),
        run=_counted([s.run for s in stories], [len(s.runs) for s in stories]),
        block=_counted([s.block for s in stories], [int(s.block.max()) + 1 for s in stories]),
        runs=(*first.runs, *(run for story in second for run in story.runs)),
        zero=np.concatenate([np.full(len(s.settled), k) for k, s in enumerate(stories)]).astype(np.int64),
        sittings=tuple(stories),
    )


def offsets(stories: Sequence[Story]) -> Array:
    """When each sitting begins on the common clock, s."""
    return _before([float(s.drive.end_s[-1]) + APART_S for s in stories])


def _before(sizes: Sequence[float]) -> Array:
    """Sum of all earlier ones, for each."""
    return np.concatenate([[0.0], np.cumsum(sizes)[:-1]])


def _counted(numbers: Sequence[Integers], sizes: Sequence[int]) -> Integers:
    return np.concatenate([n + int(b) for n, b in zip(numbers, _before(sizes))]).astype(np.int64)


def _drives(stories: Sequence[Story], clock: Array) -> Drive:
    """All currents, none between the sittings."""
    ends, currents = [], []
    for story, begin in zip(stories, clock.tolist()):
        ends += [[begin], story.drive.end_s + begin] if begin else [story.drive.end_s]
        currents += [[0.0], story.drive.current_A] if begin else [story.drive.current_A]
    return Drive(np.concatenate(ends), np.concatenate(currents), stories[0].drive.tau_s)


def _together(kind: str, unit: str, stories: Sequence[Story], clock: Array, steps: Array) -> Readings:
    own = [
        (r, begin, int(step))
        for story, begin, step in zip(stories, clock.tolist(), steps.tolist())
        for r in story.kinds
        if r.kind == kind
    ]
    return Readings(
        kind,
        np.concatenate([r.value for r, _, _ in own]),
        np.concatenate([r.t_s + begin for r, begin, _ in own]),
        np.concatenate([r.step + step for r, _, step in own]).astype(np.int64),
        unit,
    )

"""Replay of a recorded run in the order of its samples, at full speed or in multiples of real time."""

import heapq
from collections.abc import Callable, Iterator, Sequence
from itertools import chain

from smarig.core import Sample
from smarig.live.live_items import EventItem, LiveItem, SampleItem, StepItem
from smarig.record import AnyRun

BATCH_SAMPLES = 10_000  # samples read and drawn at once
PACED_INTERVAL_S = 0.2  # between batches when replayed at a speed
_COLUMNS = (
    *("tick", "t_s", "current_command_A", "current_A", "voltage_V"),
    *("temperature_degC", "counts", "position", "ambient_degC", "quality"),
)


def playback_items(run: AnyRun) -> Iterator[LiveItem]:
    """Samples, steps and events in the order of their times. Void steps are shown as interrupted."""
    timed = bool(len(run)) and run.has("t_s")
    ticks = ((t, 1, item) for t, item in _sample_items(run, timed))
    steps = sorted((s.end_s, 2, k) for k, s in enumerate(run.steps) if s.t_end_s is not None)
    ended = ((t, 2, _step_item(run, k)) for t, _, k in steps)
    in_order = sorted(run.events, key=lambda e: e.t_s)
    events = ((e.t_s, 0, EventItem(e.t_s, e.level, e.kind, e.text, e.severity)) for e in in_order)
    return (item for *_, item in heapq.merge(ticks, ended, events, key=lambda found: found[:2]))


def batches(run: AnyRun, size: int = BATCH_SAMPLES) -> Iterator[list[LiveItem]]:
    """The items of ``playback_items`` in lists."""
    batch: list[LiveItem] = []
    for item in playback_items(run):
        batch.append(item)
        if len(batch) >= size:
            yield batch
            batch = []
    if batch:
        yield batch


def replay(
    run: AnyRun,
    draw: Callable[[Sequence[LiveItem]], None],
    speed: float,
    wait: Callable[[float], bool],
    now: Callable[[], float],
) -> None:
    """Draw a run at ``speed`` times real time; 0: at once. ``wait(seconds)`` returns True when the viewer is
    closed."""
    if not speed:
        for batch in batches(run):
            draw(batch)
        return
    began = now()
    first: float | None = None
    pending: list[LiveItem] = []
    for item in playback_items(run):
        t_s = item.sample.t_s if isinstance(item, SampleItem) else item.t_s
        first = t_s if first is None else first
        while (t_s - first) / speed > now() - began:
            if pending:
                draw(pending)
                pending = []
            if wait(PACED_INTERVAL_S):
                return
        pending.append(item)
    if pending:
        draw(pending)


def _sample_items(run: AnyRun, timed: bool) -> Iterator[tuple[float, SampleItem]]:
    names = (*_COLUMNS, "step", "input")
    rows = (
        zip(*(block[name].tolist() for name in names), strict=True)
        for block in run.blocks(names, BATCH_SAMPLES)
    )
    for *values, quality, step, u in chain.from_iterable(rows):
        sample = Sample(*values, quality=0 if quality != quality else int(quality))
        yield (
            (sample.t_s if timed else sample.tick),
            SampleItem(sample, None if step != step else int(step), u),
        )


def _step_item(run: AnyRun, k: int) -> StepItem:
    s = run.steps[k]
    verdict = "interrupted" if s.void else s.verdict
    position = None if s.void else s.position
    return StepItem(
        t_start_s=s.t_start_s,
        t_s=s.end_s,
        index=s.index,
        verdict=verdict,
        branch=s.branch,
        target=s.target,
        position=position,
    )

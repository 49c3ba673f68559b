"""What a wire felt along a story where that does not ask what it did: the same for every density, so walked once.

An effect that looks at the output before the hysteresis moves, or is driven by it, has no such path; a blind moment
finds that out. Knows no hysteresis but its range.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from smarig.model.actuator import Actuator
from smarig.model.effect import Blind, Effect, Kind, Planted, Setup, Stage, chains
from smarig.model.warming import EARLY, Warming
from smarig.preisach.operator import Initial
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
Values = tuple[tuple[Kind, tuple[tuple[str, float], ...]], ...]
KEPT = 24  # paths remembered
COLUMNS = (
    "t_s",
    "dt_s",
    "command_A",
    "current_A",
    "resistance",
    "ambient_K",
    "source_K",
    "input_K",
    "felt_K",
)
_row = attrgetter(*COLUMNS)


@dataclass(frozen=True, eq=False)
class Felt:
    """Moments at the ends of parts of ticks, ``columns`` (9, m) as in ``COLUMNS``; the last part of each tick."""

    columns: Array
    ends: NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        return self.columns[COLUMNS.index(name)]


@dataclass(frozen=True)
class _Range:
    """All that an early effect may know of a hysteresis."""

    lower: float
    upper: float


def felt(story: Story, subject: Subject, effects: Sequence[Effect]) -> Felt | None:
    """The path, or None where it depends on the output."""
    h, initial = subject.hysteresis, subject.initial
    setup, early = Setup(subject.actuator, h, initial), []
    for effect in effects:
        stages = set(effect.hooks(setup))
        if Stage.FEEDBACK in stages or (stages & set(EARLY) and stages - set(EARLY)):
            return None
        if stages & set(EARLY):
            if not isinstance(effect, Planted):
                return None
            early.append((effect.kind, tuple(effect.values.items())))
    return _walked(story, subject.actuator, (h.lower, h.upper), initial, tuple(early))


@lru_cache(maxsize=KEPT)
def _walked(
    story: Story, actuator: Actuator, span: tuple[float, float], initial: Initial, early: Values
) -> Felt | None:
    setup = Setup(actuator, _Range(*span), initial)  # pyright: ignore[reportArgumentType]
    try:
        hooks = chains([kind(**dict(values)) for kind, values in early], setup)
        return _path(story, Warming(actuator, hooks, Blind()))  # pyright: ignore[reportArgumentType]
    except AttributeError:  # it looked for the output
        return None


def _path(story: Story, warming: Warming) -> Felt:
    t, current, _ = story.ticks
    now, before, rows, ends = warming.now, 0.0, [], []
    for end, command_A in zip(t.tolist(), current.tolist()):
        dt_s, start_s = end - before, now.t_s
        parts = warming.parts(command_A, dt_s)
        now.dt_s = dt_s / parts
        for k in range(1, parts + 1):
            warming.felt(command_A, 0.0, start_s + dt_s * k / parts)
            rows.append(_row(now))
        ends.append(len(rows) - 1)
        before = end
    return Felt(np.array(rows).T.copy(), np.array(ends))

"""Which effects, together, explain a story: forward from the best single one, with rivals kept and the noise refitted.

At each size the explanations compete under one covariance, that of the best of them, so no rival is judged by the
misfit of another. Stops when nothing stands out any more, or nothing named gains. Decides nothing: see ``verdict``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.refine import Refined, refined
from smarig.model.effect import Planted
from smarig.story.retelling import Subject
from smarig.story.told import Story

Judge = Callable[[Subject], Critique]
Start = tuple[Planted, ...]
TRIED = 6  # single explanations refined
BESIDE = 3  # further effects tried beside an accepted one, of those that stand out now, and at first
RIVALS = 3  # explanations kept from size to size
MOST = 3  # effects at once
GATE = 8.0  # nats: an effect that explains less is not worth its name
BEHIND = 60.0  # nats: an explanation so far behind is not tried again


@dataclass(frozen=True, eq=False)
class Level:
    """Explanations of one size, best first, under ``critique``'s covariance: that of the best with its effects in.

    ``before`` is the misfit, by the same measure, of the best explanation with one effect less; ``rough`` the
    best's gain (nats) under the covariance of the critique before.
    """

    critique: Critique
    explanations: tuple[Refined, ...]
    before: float
    rough: float

    @property
    def gain(self) -> float:
        """Nats over the best explanation with one effect less."""
        return (self.before - self.best.misfit) / 2

    @property
    def best(self) -> Refined:
        """Of least misfit."""
        return self.explanations[0]

    def lead(self, k: int) -> float:
        """Nats by which the best is better than explanation k."""
        return (self.explanations[k].misfit - self.best.misfit) / 2


def searched(first: Critique, judge: Judge, most: int = MOST) -> list[Level]:
    """Levels of one, two, … effects, as long as something stands out and is explained.

    ``judge`` makes a critique of a subject.
    """
    levels: list[Level] = []
    now, starts = first, [(p,) for p in _starts(first, TRIED)]
    while not now.silent and starts and len(levels) < most:
        level = _level(first, now, starts, judge)
        if level.gain < GATE:
            break
        levels.append(level)
        now = level.critique
        starts = _larger(level, first)
    return levels


def _starts(critique: Critique, count: int) -> list[Planted]:
    """Named candidates that gain most, each at its best."""
    return [s.candidate.best(critique.refitted.data)[0] for s in critique.best(count)]


def _larger(level: Level, first: Critique) -> list[Start]:
    """One more effect beside the best explanation, and the most promising one beside its rivals.

    What was worth trying alone is worth trying beside: a first effect may have hidden it.
    """
    starts: dict[tuple[str, ...], Start] = {}
    beside = _starts(level.critique, BESIDE) + _starts(first, BESIDE)
    for k, found in enumerate(level.explanations[:RIVALS]):
        own = {p.kind.name for p in found.effects}
        others = [p for p in beside if p.kind.name not in own]
        for p in others[:1] if k else others:
            start = (*found.effects, p)
            starts.setdefault(tuple(sorted(q.kind.name for q in start)), start)
    return list(starts.values())


def _level(first: Critique, now: Critique, starts: Sequence[Start], judge: Judge) -> Level:
    """Refine all under the covariance at hand; those near the best again under its own."""
    story, centre = first.story, first.subject.hysteresis

    def ranked(among: Sequence[Start], under: Critique) -> list[Refined]:
        found = [refined(p, story, under.subject, under.refitted, centre) for p in among]
        return sorted(found, key=lambda r: r.misfit)

    rough = ranked(starts, now)
    gained = (float(now.refitted.data @ now.refitted.data) - rough[0].misfit) / 2
    near = [r.effects for k, r in enumerate(rough) if k < 2 or r.misfit - rough[0].misfit < 2 * BEHIND]
    after = judge(replace(first.subject, effects=near[0]))
    fine = ranked(near, after)
    if fine[0].names != rough[0].names:
        after = judge(replace(first.subject, effects=fine[0].effects))
        fine = ranked([r.effects for r in fine], after)
    alone = None
    if len(near[0]) > 1:  # what the smaller explanation would leave, by the same measure
        alone = now.subject.effects
    without = refined(alone, story, after.subject, after.refitted, centre).misfit if alone else None
    bare = after.refitted.centred(_rest(first, story), story)
    return Level(after, tuple(fine), float(bare @ bare) if without is None else without, gained)


def _rest(first: Critique, story: Story) -> NDArray[np.float64]:
    return np.concatenate([r.value for r in story.kinds]) - first.told.stacked(story)

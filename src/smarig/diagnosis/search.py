"""Which effects, together, explain a story: forward from the best single one, with rivals kept and the noise refitted.

At each size the explanations compete under one covariance, that of the best of them, so no rival is judged by the
misfit of another. Stops when nothing stands out any more, or nothing named gains. Decides nothing: see ``verdict``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.density_beside import density_beside
from smarig.diagnosis.refine import Refined, refined
from smarig.diagnosis.refit import Refit
from smarig.model.effect import Planted
from smarig.story.retelling import Subject
from smarig.story.told import Story

Judge = Callable[[Subject], Critique]
Start = tuple[Subject, tuple[Planted, ...]]
TRIED = 6  # single explanations refined
BESIDE = 3  # further effects tried beside an accepted one
RIVALS = 3  # explanations kept from size to size
MOST = 3  # effects at once
BEHIND = 60.0  # nats: an explanation so far behind is not tried again


@dataclass(frozen=True, eq=False)
class Level:
    """Explanations of one size, best first, under ``critique``'s covariance: that of the best with its effects in."""

    critique: Critique
    explanations: tuple[Refined, ...]

    @property
    def best(self) -> Refined:
        """Of least misfit."""
        return self.explanations[0]

    def lead(self, k: int) -> float:
        """Nats by which the best is better than explanation k."""
        return (self.explanations[k].misfit - self.best.misfit) / 2


def searched(first: Critique, judge: Judge, most: int = MOST) -> list[Level]:
    """Levels of one, two, … effects, as long as something stands out; ``judge`` is a critique of a subject."""
    levels: list[Level] = []
    now, starts = first, [(first.subject, (p,)) for p in _starts(first, TRIED)]
    while not now.silent and starts and len(levels) < most:
        level = _level(first.story, now.refitted, starts, judge)
        levels.append(level)
        now = level.critique
        starts = _larger(level)
    return levels


def _starts(critique: Critique, count: int) -> list[Planted]:
    """Named candidates that gain most, each at its best."""
    return [s.candidate.best(critique.refitted.data)[0] for s in critique.best(count)]


def _larger(level: Level) -> list[Start]:
    """One more effect beside the best explanation, and the most promising ones beside its rivals."""
    starts: list[Start] = []
    beside = _starts(level.critique, BESIDE + len(level.best.effects))
    for k, found in enumerate(level.explanations[:RIVALS]):
        own = {p.kind.name for p in found.effects}
        others = [p for p in beside if p.kind.name not in own][: 1 if k else BESIDE]
        starts += [(replace(found.subject, effects=()), (*found.effects, p)) for p in others]
    return starts


def _level(story: Story, refitted: Refit, starts: Sequence[Start], judge: Judge) -> Level:
    """Refine all under the covariance at hand; those near the best with densities of their own, under its own."""
    found = sorted((refined(p, story, s, refitted) for s, p in starts), key=lambda r: r.misfit)
    near = [r for k, r in enumerate(found) if k < 2 or r.misfit - found[0].misfit < 2 * BEHIND]
    own = [(density_beside(story, r.extended)[0], r.effects) for r in near]
    now = judge(own[0][0])
    again = sorted((_again(e, s, story, now.refitted) for s, e in own), key=lambda r: r.misfit)
    if again[0].names != near[0].names:
        now = judge(again[0].extended)
        again = sorted(
            (_again(r.effects, r.subject, story, now.refitted) for r in again), key=lambda r: r.misfit
        )
    return Level(now, tuple(again))


def _again(effects: Sequence[Planted], subject: Subject, story: Story, refitted: Refit) -> Refined:
    return refined(effects, story, replace(subject, effects=()), refitted)

"""A model judged against a story: is anything wrong at all, and which candidates gain more than noise would give?

Every candidate's gain is measured in the spread of its own gains on nulls, (g − q50)/(q95 − q50); the largest of
them is compared with the largest in each null (Westfall and Young's max statistic), so that the chance of any false
alarm is α, however many candidates compete. Knows no effect by name.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.candidates import Candidate, generic, named, whitened
from smarig.diagnosis.nulls import nulls
from smarig.diagnosis.refit import Refit, refit
from smarig.model.effect import Kind
from smarig.preisach.sensitivity import sensitivities
from smarig.story.retelling import Retelling, retold
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
NULLS = 400
ALPHA = 0.03
LEAST_SPREAD = 1.5  # nats, about what one free strength gains by chance: none is told by a hair


@dataclass(frozen=True, eq=False)
class Score:
    """A candidate's gain (nats), its null's median and 95 % point, and the gain in that spread."""

    candidate: Candidate
    gain: float
    median: float
    high: float

    @property
    def net(self) -> float:
        """Gain beyond what nothing gains."""
        return self.gain - self.median

    @property
    def standard(self) -> float:
        """In spreads of its own null."""
        return self.net / max(self.high - self.median, LEAST_SPREAD)


@dataclass(frozen=True, eq=False)
class Critique:
    """A subject (with the effects it already has) judged: scores, and the threshold of their largest."""

    story: Story
    subject: Subject
    told: Retelling
    refitted: Refit
    scores: tuple[Score, ...]
    threshold: float
    p_value: float

    @property
    def silent(self) -> bool:
        """Whether nothing stands out."""
        return self.largest.standard <= self.threshold

    @property
    def largest(self) -> Score:
        """What stands out most."""
        return max(self.scores, key=lambda s: s.standard)

    def best(self, count: int, *, generic: bool = False) -> list[Score]:
        """The candidates, named or generic, that gain most, and after each that which stands out most."""
        kind = [s for s in self.scores if s.candidate.generic is generic and s.net > 0]
        by_gain = sorted(kind, key=lambda s: -s.net)
        by_standard = sorted(kind, key=lambda s: -s.standard)
        found = {id(s): s for pair in zip(by_gain, by_standard) for s in pair}
        return list(found.values())[:count]


def critique(
    story: Story,
    subject: Subject,
    kinds: Sequence[Kind],
    *,
    count: int = NULLS,
    alpha: float = ALPHA,
    seed: int = 0,
    like: Critique | None = None,
    wary: bool = False,
    noise_of: Critique | None = None,
) -> Critique:
    """Judge a subject by a story against ``count`` nulls at the level α.

    ``like``: noise as in another, refined; ``noise_of``: noise as in another; ``wary``: as little noise as there is
    when anything may be wrong.
    """
    told = retold(story, subject)
    known = {effect.kind.name for effect in subject.planted}
    kinds = [kind for kind in kinds if kind.name not in known]
    slope = np.array([s[-1] for s in sensitivities(subject.hysteresis, told.states)]) * told.follows
    raw = [*named(story, subject, told, kinds), *generic(story, subject, told, slope)]
    suspects = [traces for c in raw for traces in c.typical]
    refitted = refit(
        story,
        told,
        subject,
        suspects,
        like and like.refitted,
        wary=wary,
        noise_of=noise_of and noise_of.refitted,
    )
    empty = nulls(told, subject, refitted, count, seed)
    scores, standard = [], []
    for candidate in (whitened(c, refitted) for c in raw):
        by_chance = candidate.gain(empty)
        median, high = np.quantile(by_chance, [0.5, 0.95])
        score = Score(candidate, float(candidate.gain(refitted.data)[0]), float(median), float(high))
        scores.append(score)
        standard.append((by_chance - median) / max(high - median, LEAST_SPREAD))
    largest = np.sort(np.max(standard, axis=0))
    threshold = float(largest[min(int(np.ceil((count + 1) * (1 - alpha))), count) - 1])
    seen = max(s.standard for s in scores)
    p = (1 + int(np.sum(largest >= seen))) / (count + 1)
    return Critique(story, subject, told, refitted, tuple(scores), threshold, p)

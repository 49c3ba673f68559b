"""One explanation at its best: effects and the wire's own density beside them, strengths where they are likeliest.

A density takes up part of whatever is wrong, so effects and density are found in turn, strengths go farther than each
fit says, and in the end the evidence alone says how strong. Knows no rivals and takes no decision.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from smarig.diagnosis.density_beside import density_anew, density_beside
from smarig.diagnosis.refine import Refined, refined
from smarig.diagnosis.refit import Refit
from smarig.diagnosis.strength import Top, top
from smarig.model.effect import Planted
from smarig.preisach.everett import Everett
from smarig.story.subject import Subject
from smarig.story.told import Story

TURNS = 4  # of effects, then density
FARTHER, FASTER = 1.7, 1.4  # what a fit says, times; and that again after a step that was right
STILL = 0.3  # standard deviations: less is no move
TOO_SURE = 2.5  # times: what deviations by evidence fell short of on tuning boxes; a prior is a model too
LEAST_STEP = 0.01  # of a strength: what a fit may at least be wrong by


@dataclass(frozen=True, eq=False)
class Explanation:
    """Effects with the wire's density beside them, and the readings refitted with their log likelihood."""

    effects: tuple[Planted, ...]
    subject: Subject
    refitted: Refit

    @property
    def evidence(self) -> float:
        """Nats."""
        return self.refitted.log_evidence

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects, in order."""
        return tuple(sorted(p.kind.name for p in self.effects))


def strong(
    story: Story, subject: Subject, refitted: Refit, given: Everett, like: Refit
) -> tuple[Subject, Refit]:
    """A start at the first of once, twice, four times … the last effect's strength that is likelier than the next.

    A density hides most of what a weak effect does, so a fit beside the wrong one begins too low.
    """
    while True:
        *others, last = subject.planted
        primary, strength = last.kind.primary, 2 * last.strength
        if not (primary.lower <= strength <= primary.upper and strength):
            return subject, refitted
        stronger = replace(subject, effects=(*others, last.at(strength)))
        again = density_anew(story, stronger, given, like)
        if again[1].log_evidence <= refitted.log_evidence:
            return subject, refitted
        subject, refitted = again


def explained(story: Story, subject: Subject, given: Everett, refitted: Refit, turns: int) -> Explanation:
    """Effects and the density that belongs to them, in turn, until neither moves the other.

    A density takes up part of every change of strength, so strengths go farther than each fit says, where that is
    likelier than what it says.
    """
    farther = FARTHER
    for _ in range(turns):
        fine = refined(subject.planted, story, subject, refitted, subject.hysteresis)
        if fine.moved < STILL:
            break
        others = [
            density_anew(story, replace(subject, effects=fine.beyond(subject.planted, far)), given, refitted)
            for far in (1.0, farther)
        ]
        other, again = max(others, key=lambda pair: pair[1].log_evidence)
        if again.log_evidence <= refitted.log_evidence:
            break
        farther = FASTER * farther if other is others[1][0] else FARTHER
        subject, refitted = other, again
    return Explanation(subject.planted, subject, refitted)


def topped(story: Story, given: Everett, found: Explanation) -> tuple[Refined, Explanation]:
    """An explanation with each strength at the top of its evidence, and its parameters with deviations that tell it."""
    fine = refined(found.effects, story, found.subject, found.refitted, found.subject.hysteresis)
    spread = dict(fine.spread)
    for k, effect in enumerate(found.effects):
        primary, key = effect.kind.primary, (effect.kind.name, effect.kind.primary.name)
        guess = max(fine.alone[key], LEAST_STEP * abs(effect.strength))
        start = Top(effect.strength, found.evidence, found, guess)
        best = top(partial(_stronger, story, given, found, k), start, (primary.lower, primary.upper))
        found = best.at
        wider = TOO_SURE * max(best.sd / fine.alone[key], 1.0)
        spread |= {name: sd * wider for name, sd in fine.spread.items() if name[0] == effect.kind.name}
    known = {name: sd for name, sd in spread.items() if np.isfinite(sd)}  # the evidence had an end
    return replace(fine, effects=found.effects, spread=known, subject=found.subject), found


def _stronger(
    story: Story, given: Everett, found: Explanation, k: int, strength: float
) -> tuple[float, Explanation]:
    """An explanation with another strength of its effect k, and its evidence."""
    effects = list(found.effects)
    effects[k] = effects[k].at(strength)
    subject = replace(found.subject, effects=tuple(effects))
    subject, refitted = density_anew(story, subject, given, found.refitted)
    return refitted.log_evidence, Explanation(subject.planted, subject, refitted)


def without(story: Story, best: Explanation, like: Refit) -> float:
    """The largest log likelihood that one effect less leaves, from the density of all: what fewer need explain."""
    less = [
        replace(best.subject, effects=tuple(e for e in best.subject.effects if e is not one))
        for one in best.effects
    ]
    return max(density_beside(story, subject, like)[1].log_evidence for subject in less)

"""The density identified anew beside effects: what the hysteresis is once the effects are accounted for.

    ν ← max(ν + E[δν | all positions], 0),     δν of the prior of ``free_density`` about ν, spreads the likeliest

turn by turn, until their likelihood rises no more: a prior in proportion to the density is only as
good as the density. A positive measure fitted to settled positions begins it. Knows no verdict.
"""

from dataclasses import replace

import numpy as np

from smarig.diagnosis import given
from smarig.diagnosis.refit import Refit, refit
from smarig.identification.positive.fit import fit_table
from smarig.identification.positive.observations import Observations
from smarig.preisach.everett import Everett
from smarig.preisach.fod_table import FodTable
from smarig.story.retelling import Retelling, retold
from smarig.story.subject import Subject
from smarig.story.told import Story

FAIR = 1e-14  # λ of the measure that begins it
TURNS = 5
ENOUGH = 10.0  # nats: a turn that gains less is the last, for the next would gain a tenth of it


def density_beside(story: Story, subject: Subject, like: Refit | None = None) -> tuple[Subject, Refit]:
    """The subject with a new density, and its readings refitted; ``like``: begin where another refit ended.

    Positions alone make the density: what another channel says against it is the effects' business. Where the input
    was measured it is a positive measure, as smooth as held-out excursions want it.
    """
    if story.given:
        subject = replace(subject, hysteresis=_fitted(story, retold(story, subject), subject, None))
        return subject, _refitted(story, retold(story, subject), subject, like)
    return _turned(story, _start(story, subject, like))


def density_anew(
    story: Story, subject: Subject, given: Everett, like: Refit | None = None
) -> tuple[Subject, Refit]:
    """As ``density_beside``, begun from the given model's density or from a positive measure of settled positions.

    Whichever is likelier: a model may be negative somewhere (Prop. 4.6), a measure knows nothing of what is wrong.
    """
    if story.given:
        return density_beside(story, subject, like)
    fitted = _fitted(story, retold(story, subject), subject, FAIR)
    starts = [_start(story, replace(subject, hysteresis=h), like) for h in (given, fitted)]
    return _turned(story, max(starts, key=lambda start: start[2].log_evidence))


def density_said(story: Story, subject: Subject, found: Refit) -> Subject:
    """The subject with the density that its refitted readings speak for, or its own where that is nearer to them."""
    if story.given:
        return subject
    both = subject, replace(subject, hysteresis=found.posterior.table(signed=subject.signed))
    return min(both, key=lambda s: settled_rms(story, s))


def settled_rms(story: Story, subject: Subject) -> float:
    """What a subject misses settled positions by, their zeros aside."""
    error = story.settled.value - retold(story, subject).values["settled"]
    own = [error[story.zero == z] for z in np.unique(story.zero)] if story.zero.size else [error]
    return float(np.std(np.concatenate([e - e.mean() for e in own])))


def _start(story: Story, subject: Subject, like: Refit | None) -> tuple[Subject, Retelling, Refit]:
    """A subject, how it retells the story, and its positions refitted."""
    told = retold(story, subject)
    return subject, told, _refitted(story.placed, told.placed, subject, like)


def _turned(story: Story, start: tuple[Subject, Retelling, Refit]) -> tuple[Subject, Refit]:
    """From a start, as many turns as gain something."""
    subject, told, found = start
    for _ in range(TURNS):
        again = _start(
            story, replace(subject, hysteresis=found.posterior.table(signed=subject.signed)), found
        )
        gained = again[2].log_evidence - found.log_evidence
        if gained > 0:
            subject, told, found = again
        if gained < ENOUGH:
            break
    positions_alone = len(story.placed.kinds) == len(story.kinds)
    return subject, found if positions_alone else _refitted(story, told, subject, found)


def _refitted(story: Story, told: Retelling, subject: Subject, like: Refit | None) -> Refit:
    return refit(story, told, subject, (), like)


def _fitted(story: Story, told: Retelling, subject: Subject, smoothing: float | None) -> FodTable:
    n = len(story.settled)
    y = story.settled.value - (told.values["settled"] - told.output[:n])
    h = subject.hysteresis
    rows = Observations.of_states(told.states[:n], y, story.block, (h.lower, h.upper), story.unit)
    if story.zero.size:
        rows = replace(rows, zero=story.zero - 1)
    if story.given:
        rows = _weighted(rows, given.trust(story, told, subject))
    return fit_table(rows, smoothing)


def _weighted(rows: Observations, weight: np.ndarray) -> Observations:
    """Each equation times its weight."""
    return replace(rows, y=rows.y * weight, sign=rows.sign * weight[rows.term])

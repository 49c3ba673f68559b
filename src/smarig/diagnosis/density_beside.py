"""The density identified anew beside effects: what the hysteresis is once the effects are accounted for.

    ν ← max(ν + E[δν | all positions], 0),     δν of the prior of ``free_density`` about ν, spreads the likeliest

turn by turn, until their likelihood rises no more: a prior in proportion to the density is only as
good as the density. A positive measure fitted to settled positions begins it. Knows no verdict.
"""

from dataclasses import replace

import numpy as np

from smarig.diagnosis import given
from smarig.diagnosis.refit import Refit, refit
from smarig.identification.positive.fit import fit_positive, fit_table
from smarig.identification.positive.observations import Observations
from smarig.preisach.everett import Everett
from smarig.preisach.fod_table import FodTable
from smarig.story.retelling import Retelling, Subject, retold
from smarig.story.told import Story

FAIR = 1e-14  # λ of the measure that begins it
TURNS = 8
ENOUGH = 2.0  # nats: a turn that gains less is the last


def density_beside(story: Story, subject: Subject, like: Refit | None = None) -> tuple[Subject, Refit]:
    """The subject with a new density, and its readings refitted; ``like``: begin where another refit ended.

    Positions alone make the density: what another channel says against it is the effects' business. Where the input
    was measured it is a positive measure, as smooth as held-out excursions want it.
    """
    if story.given:
        subject = replace(subject, hysteresis=_fitted(story, retold(story, subject), subject, None))
        return subject, _refitted(story, retold(story, subject), subject, like)
    told = retold(story, subject)
    places, found = story.placed, _refitted(story.placed, told.placed, subject, like)
    for _ in range(TURNS):
        other = replace(subject, hysteresis=found.density)
        again_told = retold(story, other)
        again = _refitted(places, again_told.placed, other, found)
        if again.log_evidence < found.log_evidence + ENOUGH:
            break
        subject, told, found = other, again_told, again
    return subject, found if len(places.kinds) == len(story.kinds) else _refitted(story, told, subject, found)


def _refitted(story: Story, told: Retelling, subject: Subject, like: Refit | None) -> Refit:
    none = np.zeros((sum(len(r) for r in story.kinds), 0))
    return refit(story, told, subject, none, like)


def begun(story: Story, subject: Subject, given: Everett, like: Refit | None = None) -> Subject:
    """The subject with a density to begin from: the given model's, or a positive measure fitted to settled positions.

    Whichever is likelier: a model may be negative somewhere (Prop. 4.6), a measure knows nothing of what is wrong.
    """
    if story.given:
        return subject
    places = story.placed
    starts = [replace(subject, hysteresis=given)]
    starts.append(replace(subject, hysteresis=_fitted(story, retold(story, subject), subject, FAIR)))
    worth = [_refitted(places, retold(story, s).placed, s, like).log_evidence for s in starts]
    return starts[int(np.argmax(worth))]


def _fitted(story: Story, told: Retelling, subject: Subject, smoothing: float | None) -> FodTable:
    n = len(story.settled)
    y = story.settled.value - (told.values["settled"] - told.output[:n])
    h = subject.hysteresis
    rows = Observations.of_states(told.states[:n], y, story.block, (h.lower, h.upper), story.unit)
    if story.zero.size:
        rows = replace(rows, zero=story.zero - 1)
    if story.given:
        rows = _weighted(rows, given.trust(story, told, subject))
    return fit_table(rows, smoothing) if smoothing else fit_positive(rows).table


def _weighted(rows: Observations, weight: np.ndarray) -> Observations:
    """Each equation times its weight."""
    return replace(rows, y=rows.y * weight, sign=rows.sign * weight[rows.term])

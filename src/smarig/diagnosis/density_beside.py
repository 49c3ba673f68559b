"""The density identified anew beside effects: what the hysteresis is once the effects are accounted for.

Settled positions, less what effects after the operator add, are sums over the FOD surface at the memories that the
retelling gives them; a positive measure is fitted to those. As effects that feed back on the output follow the
density, that is done twice. Knows no verdict.
"""

from dataclasses import replace

import numpy as np

from smarig.diagnosis import given
from smarig.identification.positive.fit import PositiveFit, fit_positive
from smarig.identification.positive.observations import Observations
from smarig.story.retelling import Retelling, Subject, retold
from smarig.story.told import Story

TURNS = 2


def density_beside(
    story: Story, subject: Subject, smoothing: float | None = None
) -> tuple[Subject, float | None]:
    """The subject with a new density, and the smoothing that held-out excursions chose for it."""
    for _ in range(TURNS if subject.effects else 1):
        fit = _fitted(story, retold(story, subject), subject, smoothing)
        smoothing = fit.smoothing
        subject = replace(subject, hysteresis=fit.table)
    return subject, smoothing


def _fitted(story: Story, told: Retelling, subject: Subject, smoothing: float | None) -> PositiveFit:
    n = len(story.settled)
    y = story.settled.value - (told.values["settled"] - told.output[:n])
    h = subject.hysteresis
    rows = Observations.of_states(told.states[:n], y, story.block, (h.lower, h.upper), story.unit)
    if story.given:
        rows = _weighted(replace(rows, zero=story.zero - 1), given.trust(story, told, subject))
    return fit_positive(rows, smoothing=smoothing)


def _weighted(rows: Observations, weight: np.ndarray) -> Observations:
    """Each equation times its weight."""
    return replace(rows, y=rows.y * weight, sign=rows.sign * weight[rows.term])

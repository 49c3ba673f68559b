"""The density identified anew beside effects: what the hysteresis is once the effects are accounted for.

Settled positions, less what effects after the operator add, are sums over the FOD surface at the memories that the
retelling gives them; a positive measure is fitted to those. As effects that feed back on the output follow the
density, that is done twice. Knows no verdict.
"""

from dataclasses import replace

import numpy as np

from smarig.diagnosis.free_density import observed
from smarig.identification.positive.fit import PositiveFit, fit_positive
from smarig.story.retelling import Subject, retold
from smarig.story.told import Story

TURNS = 2


def density_beside(story: Story, subject: Subject, smoothing: float | None = None) -> tuple[Subject, float]:
    """The subject with a new density, and the smoothing that held-out excursions chose for it."""
    fit: PositiveFit | None = None
    for _ in range(TURNS):
        told = retold(story, subject)
        n = len(story.settled)
        y = story.settled.value - (told.values["settled"] - told.output[:n])
        rows = observed(told.states[:n], subject.hysteresis.lower, subject.hysteresis.upper, y)
        rows = replace(rows, curve=story.block, unit=story.unit)
        fit = fit_positive(rows, smoothing=smoothing)
        smoothing = fit.smoothing
        subject = replace(subject, hysteresis=fit.table)
    assert fit is not None  # noqa: S101 - TURNS > 0
    return subject, fit.smoothing


def zero(story: Story, subject: Subject) -> float:
    """Where the encoder's zero lies: the mean of settled positions over predictions."""
    told = retold(story, subject)
    return float(np.mean(story.settled.value - told.values["settled"]))

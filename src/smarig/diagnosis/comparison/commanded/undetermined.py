"""Held-out error of a rig's runs that is missing knowledge: one density describes all runs, but for noise.

    share = 1 − (S_h(all) + S_t(all) − S_t(train)) / S_h,    S: sums of squares at settled positions

A wire that changed cannot be described by one density without a larger error of the training runs.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge, inputs_of_error
from smarig.diagnosis.comparison.verdict_rules import RULES
from smarig.diagnosis.refit.joint_density import (
    joint_density_from_best_start,
    with_positive_measure,
    with_posterior_density,
)
from smarig.record import Run
from smarig.replay import PlantModel, Timeline, build_timeline, predict

Mask = NDArray[np.bool_]


def missing_knowledge_of(
    subject: CommandedProblem, base: PlantModel, noise: float, train: Sequence[Run], held_out: Sequence[Run]
) -> MissingKnowledge | None:
    """What the training runs do not determine and the held-out runs need, or None if that is not their error.

    ``base`` is the plain model; ``noise`` what a settled position scatters, output units.
    """
    if not held_out:
        return None
    timeline = build_timeline([*train, *held_out], subject.given.actuator.tau_s).positions_only
    ids = {id(run) for run in held_out}
    held = np.isin(timeline.run, [k for k, run in enumerate(timeline.runs) if id(run) in ids])
    plain = _error(timeline, base, zeroed_by=~held)
    if root_mean_square(plain[held]) <= max(
        RULES["worse"].value * root_mean_square(plain[~held]), RULES["adequate"].value * noise
    ):
        return None
    found = joint_density_from_best_start(timeline, subject.given, subject.original)
    positive = with_positive_measure(timeline, subject.given)
    joint = with_posterior_density(timeline, found.plant_model, found.refitted, positive)
    fitted = _error(timeline, joint, zeroed_by=np.ones_like(held))
    cost = max(_square(fitted[~held]) - _square(plain[~held]), 0.0)
    share = 1.0 - (_square(fitted[held]) + cost) / _square(plain[held])
    if share < RULES["not_determined"].value or root_mean_square(fitted) > RULES["adequate"].value * noise:
        return None
    inputs = predict(timeline, base).states
    u = np.array([s.u for s in inputs[: held.size]])[held]
    return MissingKnowledge(share, inputs_of_error(u, plain[held] ** 2))


def _error(timeline: Timeline, model: PlantModel, zeroed_by: Mask) -> Array:
    """Errors (k,) at settled positions, each session with the mean of the readings that zero it, if it has any."""
    error = timeline.settled.value - predict(timeline, model).values["settled"]
    for session in np.unique(timeline.session):
        own = timeline.session == session
        zeroes = own & zeroed_by if np.any(own & zeroed_by) else own
        error[own] -= error[zeroes].mean()
    return error


def _square(x: Array) -> float:
    return float(x @ x)

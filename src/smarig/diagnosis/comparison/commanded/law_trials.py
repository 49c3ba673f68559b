"""Trials of a dependence on a variable as a learned law: simulated, and with a density of its own, as effects are.

A kernel is linear about the base model. Where a wire is several kelvin off, that describes nothing, and an effect would
win only because it is simulated. A law has no shape that would make it likelier than its variable.
"""

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.effect_trials import fitted_with, refined
from smarig.diagnosis.comparison.commanded.law_shapes import law_shape, law_start
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.plant import LEARNED_FROM, can_be_learned

LAWS = 2  # fitted: far from the base model, kernels do not say which place of which variable is the better
LAW_PLACES = {"output": "output", "input": "input", "heat": "heat_loss"}  # of kernels


def laws(subject: CommandedProblem, smooth: Discrepancies) -> list[tuple[ComparedHypothesis, FittedPlant]]:
    """The laws of the most promising kernels, fitted and refined, the best last."""
    fitted = smooth.fitted
    if any(e.kind.shape for e in fitted.effects):  # one law at a time
        return []
    found = []
    for variable, place in _places(smooth)[:LAWS]:
        shape = law_shape(subject.timeline, fitted.plant_model, fitted.prediction, variable, place)
        if shape is not None:
            effects = [*fitted.effects, law_start(fitted.plant_model, shape)]
            by_law = fitted_with(subject, fitted, effects)
            found += [refined(subject, *by_law)] if by_law else []
    return sorted(found, key=lambda pair: pair[0].score)


def _places(smooth: Discrepancies) -> list[tuple[str, str]]:
    """(variable, place) that a law may have, the most promising first."""
    order = [smooth.kernels[j] for j in np.argsort(-smooth.gains).tolist()]
    places = [(k.variable, LAW_PLACES[k.place]) for k in order if k.place in LAW_PLACES]
    return [p for p in dict.fromkeys(places) if p[0] in LEARNED_FROM and can_be_learned(*p)]

"""Trials of a dependence on a variable as a learned law: simulated, and with a density of its own, as effects are.

A kernel is linear about the base model. Where a wire is several kelvin off, that describes nothing, and an effect would
win only because it is simulated. A law has no shape that would make it likelier than its variable.
"""

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.effect_trials import fitted_with, refined
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.explain.learned_term_fit import law_shape, law_start
from smarig.plant import LEARNED_FROM, can_be_learned
from smarig.replay import predict

LAWS = 2  # fitted, of different places or variables
LAW_PLACES = {"output": "output", "input": "input", "heat": "heat_loss"}  # of kernels


def laws(
    subject: CommandedProblem, smooth: Discrepancies, least_nats: float
) -> list[tuple[ComparedHypothesis, FittedPlant]]:
    """The laws of the most promising kernels, fitted, if these gain ``least_nats`` by screening."""
    base = subject.base
    prediction = predict(subject.timeline, base.plant_model)
    found = []
    for variable, place in _places(smooth, least_nats)[:LAWS]:
        shape = law_shape(subject.timeline, base.plant_model, prediction, {}, variable, place)
        if shape is not None:
            # a law far from zero needs several rounds: its first fit does not say which place is the better
            first = fitted_with(subject, base, [law_start(base.plant_model, shape)])
            found.append(refined(subject, *first))
    return found


def _places(smooth: Discrepancies, least_nats: float) -> list[tuple[str, str]]:
    """(variable, place) that a law may have, the most promising first."""
    found = [
        (k.variable, LAW_PLACES[k.place])
        for k, gain in sorted(zip(smooth.kernels, smooth.gains.tolist()), key=lambda pair: -pair[1])
        if gain > least_nats and k.place in LAW_PLACES and k.variable in LEARNED_FROM
    ]
    return [place for place in dict.fromkeys(found) if can_be_learned(*place)]

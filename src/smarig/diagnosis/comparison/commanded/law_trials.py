"""Trials of a dependence on a variable as a learned law: simulated, and with a density of its own, as effects are.

A kernel is linear about the base model. Where a wire is several kelvin off, that describes nothing, and an effect would
win only because it is simulated. A law has no shape that would make it likelier than its variable.
"""

from collections.abc import Sequence

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.discrepancy_kernels import Kernel
from smarig.diagnosis.comparison.commanded.effect_trials import fitted_with, refined
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.explain.learned_term_fit import law_shape, law_start
from smarig.plant import LEARNED_FROM, can_be_learned

LAW_PLACES = {"output": "output", "input": "input", "heat": "heat_loss"}  # of kernels


def law(
    subject: CommandedProblem, smooth: Discrepancies, by_kernels: Sequence[ComparedHypothesis]
) -> tuple[ComparedHypothesis, FittedPlant] | None:
    """The law of the kernel that predicts blocks left out best, fitted and refined; None if it can be none."""
    fitted = smooth.fitted
    if any(e.kind.shape for e in fitted.effects):  # one law at a time
        return None
    trials = sorted((t for h in by_kernels for t in h.trials), key=lambda t: -t.score)
    kernel = next((k for t in trials if _can_be_law(k := smooth.kernel_of(t))), None)
    if kernel is None:
        return None
    place = LAW_PLACES[kernel.place]
    shape = law_shape(subject.timeline, fitted.plant_model, fitted.prediction, {}, kernel.variable, place)
    if shape is None:
        return None
    first = fitted_with(subject, fitted, [*fitted.effects, law_start(fitted.plant_model, shape)])
    return refined(subject, *first)


def _can_be_law(k: Kernel) -> bool:
    return k.variable in LEARNED_FROM and can_be_learned(k.variable, LAW_PLACES.get(k.place, ""))

"""The model with a learned term, judged on held-out runs as it will be replayed: it is not offered if it is worse."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.measured.extended_measured_model import extended_measured_model, hysteresis_of_first_run
from smarig.diagnosis.measured.learned_law import LearnedLaw
from smarig.diagnosis.measured.learned_search import learn
from smarig.diagnosis.measured.measured_runs import replayed_error
from smarig.diagnosis.measured.measured_verdict import ADVANTAGE, SIMPLEST_FIRST
from smarig.identification import Comparison, MeasuredHypothesis
from smarig.measurement import MeasurementPart
from smarig.record import Run
from smarig.replay import Model

Array = NDArray[np.float64]
WORSE = 1.0  # times the plain model's error on held-out runs: a larger error is worse


@dataclass(frozen=True, eq=False)
class LearnedExtension:
    """A law with its hypothesis, its model, and the errors (m,) of that model at all readings."""

    law: LearnedLaw
    hypothesis: MeasuredHypothesis
    model: Model
    error: Array


def learned_extension(
    model: Model,
    base: MeasuredHypothesis,
    error_to_beat: float,
    comparison: Comparison,
    runs: tuple[Sequence[Run], Sequence[Run]],
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[LearnedExtension | None, str]:
    """(extension, "") or (None, a clause on why there is none).

    The law is chosen on the training runs. ``runs`` are training and held-out runs; ``error_to_beat`` is the rms
    error that a model with it must not exceed on held-out runs.
    """
    search = learn(comparison, base, progress)
    if search.found is None:
        return None, search.reason
    terms, hypothesis = search.found.terms, search.found.hypothesis
    train, held_out = runs
    law = LearnedLaw(terms, 1 - hypothesis.rms / base.rms, train[0].input_unit, train[0].unit)
    part = MeasurementPart((), learned=terms)
    warning = "Term learned from the errors of a plain model; its cause is unknown."
    extended = extended_measured_model(
        model, hysteresis_of_first_run(hypothesis.fit), part, "learned", warning, train
    )
    replayed = replayed_error(extended, [*train, *held_out], comparison)
    error = np.where(np.isfinite(replayed), replayed, hypothesis.fit.error)
    tested = ~comparison.train
    if _rms(error[~tested]) > WORSE * _rms(base.fit.error[~tested]):
        return None, "a learned law does not fit the training runs when it is replayed"
    if tested.any() and _rms(error[tested]) > WORSE * error_to_beat:
        of = law.variables[0].replace("_", " ")
        return None, f"a learned law of the {of} predicts left-out blocks better, but the held-out runs worse"
    return LearnedExtension(law, hypothesis, extended, error), ""


def verdict_with_learned(
    verdict: DiagnosisVerdict, learned: LearnedExtension | None, variables: Sequence[MeasuredHypothesis]
) -> DiagnosisVerdict:
    """The verdict; its variable is that of the law if the law explains clearly more than the variable alone, and is
    not farther from what an experiment sets.
    """
    if learned is None:
        return verdict
    found, learned_variable = verdict.depends_on, learned.law.variables[0]
    if found in SIMPLEST_FIRST and _place(found) < _place(learned_variable):
        return verdict
    alone = [h.rms for h in variables if h.variable == verdict.depends_on]
    if alone and learned.hypothesis.rms >= ADVANTAGE * alone[0]:
        return verdict
    return replace(verdict, depends_on=learned.law.variables[0].replace("_", " "))


def _place(variable: str) -> int:
    """Place of a variable in the order of preference; those that are not listed come last."""
    return SIMPLEST_FIRST.index(variable) if variable in SIMPLEST_FIRST else len(SIMPLEST_FIRST)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))

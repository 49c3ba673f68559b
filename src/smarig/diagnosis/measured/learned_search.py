"""The search for the missing term of a model: one law of one or two variables, or two, chosen on blocks left out.

Every variable is tried in every form with three knots; the best are fitted exactly, with two to five. A
coefficient must reduce the error on held-out blocks by ``PENALTY``; a term by ``MIN_GAIN``, and by more than chance.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from smarig.diagnosis.measured.adequacy import adequate_error
from smarig.diagnosis.measured.learned_fit import (
    LearnedFit,
    empty_term,
    linear,
    readings_of,
    refined,
    screened_error,
)
from smarig.diagnosis.measured.measured_search import CHANCE, MIN_GAIN, chance_of
from smarig.identification import Comparison, MeasuredHypothesis
from smarig.measurement import LearnedTerm, shared_variables

FORMS_OF = {
    "input": ("output",),
    "time_since_reversal": ("output", "output_gain", "input"),
}
FORMS = ("output", "output_gain", "input", "input_gain", "play")
CONDITION_FORMS = ("output_gain", "input", "input_gain", "play")  # the zero of each run is free anyway
FIRST_KNOTS, KNOTS = 3, (2, 5)
PLACES = (0.5, 0.0, 1.0)  # of the centre of a gain: middle and ends
SCREENED = 6  # candidates, by the error of their fit, that are compared on held-out blocks
REFINED = 3  # of these, candidates that are fitted exactly
PROMISING = 1.15  # times the least error to first order: candidates with more are not fitted exactly
HOPELESS = 0.97  # of the error without the term: with no candidate below it to first order, none is learned
FEWEST_BLOCKS = 5  # all may fall by chance in fewer
PENALTY = 0.015  # of the error, by each coefficient
MIN_FURTHER_GAIN = 0.15  # of the error, by a second term
MAX_TERMS = 2
MIN_RATE_SPAN = np.log10(1.5)  # decades: rates that differ less show no dependence


@dataclass(frozen=True, eq=False)
class LearnedSearch:
    """The learned terms found (None if none predicts held-out blocks better), and a clause on why there are none."""

    found: LearnedFit | None
    reason: str = ""


def learn(
    comparison: Comparison, base: MeasuredHypothesis, progress: Callable[[str], None] = lambda _: None
) -> LearnedSearch:
    """The missing term of the plain model, by forward selection."""
    current = LearnedFit((), base)
    for _ in range(MAX_TERMS):
        if current.terms and current.hypothesis.rms <= adequate_error(base):
            break
        found = _round(comparison, current)
        if found is None:
            break
        progress(f"with a learned term of the {found.terms[-1].variable.replace('_', ' ')}")
        current = found
    if not current.terms:
        return LearnedSearch(None, "no law of one or two variables predicts left-out blocks better")
    return LearnedSearch(current)


def _round(comparison: Comparison, current: LearnedFit) -> LearnedFit | None:
    """The best law with one more term, or None if it does not pass the gates."""
    start, present = current.hypothesis.fit, current.terms
    empty = list(_empty_terms(comparison, current, FIRST_KNOTS))
    empty.sort(key=lambda t: screened_error(comparison, start, (*present, t)))
    near = sorted(((_score(comparison, current, t), t) for t in empty[:SCREENED]), key=lambda n: n[0])
    limit = min(PROMISING * near[0][0], HOPELESS * current.hypothesis.rms) if near else 0.0
    tried = []
    for error, term in [n for n in near if n[0] <= limit][:REFINED]:
        others = [_with_knots(comparison, current, term, k) for k in KNOTS]
        best = min(
            [(error, term), *((_score(comparison, current, t), t) for t in others)], key=lambda n: n[0]
        )[1]
        tried.append(refined(comparison, start, (*present, best)))
    found = min(tried, key=_penalised, default=None)
    return found if found is not None and _passes(found, current) else None


def _passes(found: LearnedFit, start: LearnedFit) -> bool:
    least = MIN_FURTHER_GAIN if start.terms else MIN_GAIN
    a, b = found.hypothesis, start.hypothesis
    return bool(
        b.block_squares().size >= FEWEST_BLOCKS
        and a.rms <= (1 - least) * b.rms
        and a.fitted_rms <= b.fitted_rms
        and chance_of(a, b, MIN_GAIN) <= CHANCE
    )


def _penalised(found: LearnedFit) -> float:
    return found.hypothesis.rms * (1 + PENALTY * found.coefficients)


def _score(comparison: Comparison, current: LearnedFit, term: LearnedTerm) -> float:
    """Penalised error on held-out blocks with one more term, to first order."""
    terms = (*current.terms, term)
    return _penalised(LearnedFit(terms, linear(comparison, current.hypothesis.fit, terms)))


def _empty_terms(comparison: Comparison, current: LearnedFit, count: int) -> Iterator[LearnedTerm]:
    """Every term that is not present yet and whose variable varies."""
    fit, within = current.hypothesis.fit, comparison.train
    present = {(t.variable, t.form) for t in current.terms}
    conditions = set(comparison.plan.records[0].conditions)
    for variable in shared_variables(comparison.plan.records):
        least = MIN_RATE_SPAN if variable == "rate" else 0.0
        if np.ptp(readings_of(fit, variable)[within]) <= least:
            continue
        for form in CONDITION_FORMS if variable in conditions else FORMS_OF.get(variable, FORMS):
            if (variable, form) not in present:
                places = PLACES if form.endswith("gain") else PLACES[:1]
                yield from (empty_term(fit, variable, form, count, within, p) for p in places)


def _with_knots(comparison: Comparison, current: LearnedFit, term: LearnedTerm, count: int) -> LearnedTerm:
    """The same term with another number of knots."""
    other = empty_term(current.hypothesis.fit, term.variable, term.form, count, comparison.train)
    return replace(other, centre=term.centre)

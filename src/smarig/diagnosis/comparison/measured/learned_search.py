"""The law of a variable: how the errors of the plain model go with it, chosen by the errors on blocks left out.

Each place where it may enter is tried with two and three knots; the best are fitted exactly.
"""

from collections.abc import Iterator

from smarig.diagnosis.comparison.measured.learned_fit import LearnedFit, empty_term, linear, refined
from smarig.identification import Comparison, MeasuredHypothesis
from smarig.measurement import LearnedTerm, shared_variables

LAW_VARIABLES = {"speed": "rate"}  # of a variable of the comparison
FORMS_OF = {"input": ("output",), "time_since_reversal": ("output", "output_gain", "input")}
FORMS = ("output", "output_gain", "input", "input_gain", "play")
CONDITION_FORMS = ("output_gain", "input", "input_gain", "play")  # the zero of each run is free anyway
PLACES = (0.5, 0.0, 1.0)  # of the centre of a gain: middle and ends
KNOTS = (2, 3)  # a straight law, and a bent one
REFINED = 3  # forms that are fitted exactly: their errors to first order may be a little off


def learned_of(comparison: Comparison, base: MeasuredHypothesis, variable: str) -> LearnedFit | None:
    """The law of a variable that predicts blocks left out best; None if the plain model predicts them as well, or if
    no model can know the variable of another run.
    """
    name = LAW_VARIABLES.get(variable, variable)
    records = comparison.plan.records
    if name not in shared_variables(records):
        return None
    forms = CONDITION_FORMS if name in records[0].conditions else FORMS_OF.get(name, FORMS)
    tried = sorted(
        _terms(comparison, base, name, forms), key=lambda term: linear(comparison, base.fit, [term]).rms
    )
    fits = [refined(comparison, base.fit, [term]) for term in tried[:REFINED]]
    best = min(fits, key=lambda fit: fit.hypothesis.rms, default=None)
    return best if best is not None and best.hypothesis.rms < base.rms else None


def _terms(
    comparison: Comparison, base: MeasuredHypothesis, variable: str, forms: tuple[str, ...]
) -> Iterator[LearnedTerm]:
    for form in forms:
        for place in PLACES if form.endswith("gain") else PLACES[:1]:
            for count in KNOTS:
                term = empty_term(base.fit, variable, form, count, comparison.train, place)
                if len(term.knots) == count:
                    yield term

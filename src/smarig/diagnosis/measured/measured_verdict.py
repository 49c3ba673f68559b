"""The verdict on records with a measured input, from the rounds of a search."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.measured.adequacy import is_adequate
from smarig.diagnosis.measured.loop_ends import closes_loops, end_error
from smarig.diagnosis.measured.measured_search import CHANCE, SearchStep, chance_of
from smarig.identification import MeasuredHypothesis

ADVANTAGE = 0.85  # a plain variable explains more if its error is below this share of that of the effects
OWN_ADVANTAGE = 0.6  # the same for a variable that the effects depend on: it describes them with more freedom
LEAST_VARIABLE_GAIN = 0.15  # of the error on held-out blocks
EQUAL = 1.03  # effects whose errors differ by less are not told apart
CONFUSED = 1.25  # the same for effects that the catalogue says are confused
SIMILAR = 1.5  # variables whose errors differ by less are not told apart
SIMPLEST_FIRST = ("rate", "time", "cycle", "history", "level", "run")  # what an experiment sets comes first


@dataclass(frozen=True, eq=False)
class MeasuredVerdict:
    """The ``verdict``, the accepted hypothesis (the plain model if none), and one clause on why nothing is named."""

    verdict: DiagnosisVerdict
    accepted: MeasuredHypothesis
    reason: str = ""


def decide(steps: Sequence[SearchStep], *, worse_on_held_out: bool) -> MeasuredVerdict:
    """The verdict on the rounds of a search.

    ``worse_on_held_out``: the extended model predicts held-out runs worse than the plain one; then nothing is named.
    """
    first, last = steps[0], steps[-1].start
    variable = _variable(first)
    if not last.effects:
        return _unnamed(first, variable)
    if worse_on_held_out:
        reason = f"{last.name} fits the training runs but predicts the held-out runs worse"
        return MeasuredVerdict(_unknown(variable), first.start, reason)
    variables = [h for h in first.variables if _explains_more(h, last, first.start)]
    if variable is not None and variables:
        reason = f"{variable.variable} explains more than {last.name}"
        return MeasuredVerdict(_unknown(variable), first.start, reason)
    if all(e.kind.descriptive for e in last.effects):
        depends_on = last.effects[0].kind.depends_on[0]
        reason = f"{last.name} describes the error, but many causes leave such a part"
        return MeasuredVerdict(DiagnosisVerdict("unknown", depends_on=depends_on), first.start, reason)
    names = tuple(e.kind.name for e in last.effects)
    equal = [names, *_equals(steps)]
    if len(equal) > 1:
        shares = tuple((n, 1 / len(equal)) for n in equal)
        return MeasuredVerdict(DiagnosisVerdict("ambiguous", shares), last)
    return MeasuredVerdict(DiagnosisVerdict("named", ((names, 1.0),)), last)


def _explains_more(variable: MeasuredHypothesis, last: MeasuredHypothesis, start: MeasuredHypothesis) -> bool:
    """Whether a plain variable explains more than effects; what closes loops, only a variable does that closes them
    better.
    """
    if closes_loops(last, start) and end_error(variable) >= end_error(last):
        return False
    return variable.rms < _advantage(last, variable) * last.rms


def _advantage(last: MeasuredHypothesis, variable: MeasuredHypothesis) -> float:
    own = any(variable.variable in e.kind.depends_on for e in last.effects)
    return OWN_ADVANTAGE if own else ADVANTAGE


def _equals(steps: Sequence[SearchStep]) -> list[tuple[str, ...]]:
    """Other effects of the last accepted round that passed all gates with the same error."""
    step = steps[-2]
    best = step.accepted
    if best is None:
        return []
    return [
        tuple(e.kind.name for e in h.effects)
        for h in step.effects
        if h is not best
        and not step.failures[h.effects[-1].kind.name]
        and h.misfit <= _equal_ratio(h, best) * best.misfit
        and not best.effects[-1].kind.by_condition
    ]


def _equal_ratio(a: MeasuredHypothesis, b: MeasuredHypothesis) -> float:
    """Ratio of the misfits of two hypotheses up to which they are not told apart."""
    first, second = a.effects[-1].kind, b.effects[-1].kind
    return CONFUSED if first.name in second.confused_with and second.name in first.confused_with else EQUAL


def _variable(step: SearchStep) -> MeasuredHypothesis | None:
    """The variable that explains most beyond chance, or None; of several that explain much, the first of
    ``SIMPLEST_FIRST``.
    """
    limit = CHANCE / max(len(step.variables), 1)
    found = [
        h
        for h in step.variables
        if h.rms <= (1 - LEAST_VARIABLE_GAIN) * step.start.rms and chance_of(h, step.start) <= limit
    ]
    near = [h for h in found if h.rms <= SIMILAR * found[0].rms]
    return min(near, key=lambda h: SIMPLEST_FIRST.index(h.variable), default=None)


def _unnamed(first: SearchStep, variable: MeasuredHypothesis | None) -> MeasuredVerdict:
    remains = f"what remains goes with {variable.variable}" if variable else ""
    if is_adequate(first.start):
        return MeasuredVerdict(DiagnosisVerdict("silent"), first.start, remains)
    if variable is not None:
        return MeasuredVerdict(_unknown(variable), first.start)
    reason = "no effect and no variable explains the error"
    return MeasuredVerdict(DiagnosisVerdict("unknown"), first.start, reason)


def _unknown(variable: MeasuredHypothesis | None) -> DiagnosisVerdict:
    return DiagnosisVerdict("unknown", depends_on=variable.variable if variable else None)


def smallest_chance(step: SearchStep) -> float:
    """Share of resampled blocks on which the best effect or variable is not better, times the number tried."""
    tried = [*step.effects, *step.variables]
    chances = [chance_of(h, step.start) for h in tried]
    return float(np.clip(min(chances, default=1.0) * max(len(tried), 1), 1e-3, 1.0))

"""The search for effects that explain the errors of a model of records with a measured input.

Effects are added one by one while each passes the gates: the error on held-out blocks falls by more than chance and by
at least a tenth, or most of it at the ends of the input; that of the fit falls too, and no value lies at a bound or has
an interval that contains no effect.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.measured.adequacy import adequate_error
from smarig.diagnosis.measured.loop_ends import closes_loops, end_squares
from smarig.diagnosis.measured.variables import variable_terms
from smarig.identification import Comparison, MeasuredHypothesis
from smarig.measurement import InputRecord, MeasurementEffectType

MAX_EFFECTS = 3
MIN_GAIN = 0.1  # of the error on held-out blocks, by the first effect
MIN_FURTHER_GAIN = 0.25  # the same, by each further effect
DRAWS = 1000
CHANCE = 0.025  # probability that a gain on held-out blocks is due to the choice of blocks
PREFERRED = 1.05  # an effect of a recorded condition may have this much more error than an offset of runs


@dataclass(frozen=True, eq=False)
class SearchStep:
    """One round: the hypothesis it started from, the effects and variables tried, best first, and why each failed."""

    start: MeasuredHypothesis
    effects: tuple[MeasuredHypothesis, ...]
    variables: tuple[MeasuredHypothesis, ...]
    failures: dict[str, str]

    @property
    def accepted(self) -> MeasuredHypothesis | None:
        """The best hypothesis that passed all gates, or None."""
        return next((h for h in self.effects if not self.failures[_added(h)]), None)


def _added(hypothesis: MeasuredHypothesis) -> str:
    """Name of the effect that a hypothesis adds."""
    return hypothesis.effects[-1].kind.name


def search_effects(
    comparison: Comparison,
    kinds: Sequence[MeasurementEffectType],
    train: int,
    progress: Callable[[str], None] = lambda _: None,
) -> list[SearchStep]:
    """The rounds of the search; the last one accepts nothing, or starts from all effects there are to be."""
    records = comparison.plan.records[:train]
    current = comparison.evaluated([])
    steps: list[SearchStep] = []
    adequate = adequate_error(current)
    while not (current.effects and current.rms <= adequate) and len(current.effects) < MAX_EFFECTS:
        step = _round(comparison, kinds, records, current)
        steps.append(step)
        if step.accepted is None:
            return steps
        current = step.accepted
        progress(f"with {current.name}")
    return [*steps, SearchStep(current, (), (), {})]


def _round(
    comparison: Comparison,
    kinds: Sequence[MeasurementEffectType],
    records: Sequence[InputRecord],
    current: MeasuredHypothesis,
) -> SearchStep:
    """Every effect that is not present yet, and every variable, added to the present hypothesis."""
    variables = [
        comparison.evaluated(current.effects, t, n, current.fit) for n, t in variable_terms(current.fit)
    ]
    present = {e.kind.name for e in current.effects}
    tried = []
    for kind in kinds:
        if kind.name not in present:
            tried += _searched(comparison, kind, records, current)
    failures = {_added(h): failure(h, current) for h in tried}
    by_error = sorted(variables, key=lambda h: h.rms)
    return SearchStep(current, tuple(_preferred(tried)), tuple(by_error), failures)


def _searched(
    comparison: Comparison,
    kind: MeasurementEffectType,
    records: Sequence[InputRecord],
    current: MeasuredHypothesis,
) -> list[MeasuredHypothesis]:
    """The hypothesis that adds an effect; none if these records cannot show it."""
    parameters = kind.parameters(records)
    if parameters is None:
        return []
    fixed = {"reference": records[0].conditions[kind.by_condition]} if kind.by_condition else {}
    return [comparison.searched(kind, parameters, current.effects, fixed, current)]


def _preferred(tried: list[MeasuredHypothesis]) -> list[MeasuredHypothesis]:
    """Best first; an effect of a recorded condition comes before an unexplained one with about the same error."""
    return sorted(tried, key=lambda h: h.misfit / (PREFERRED if h.effects[-1].kind.by_condition else 1.0))


def failure(tried: MeasuredHypothesis, start: MeasuredHypothesis) -> str:
    """Why a hypothesis is not accepted over the one it extends, as a clause; empty if it passes every gate."""
    if tried.at_bound:
        return f"{', '.join(tried.at_bound)} is at the end of its search"
    if any(low <= 0 <= high for low, high in tried.intervals.values()):
        return "its interval contains no effect"
    least = MIN_FURTHER_GAIN if start.effects else MIN_GAIN
    closes = closes_loops(tried, start)
    if tried.rms > (1 - least) * start.rms and not closes:
        return "it does not predict held-out blocks better"
    if tried.fitted_rms > start.fitted_rms:
        return "it fits the records worse"
    if (_end_chance(tried, start) if closes else chance_of(tried, start)) > CHANCE:
        return "its gain on held-out blocks may be chance"
    return ""


def chance_of(tried: MeasuredHypothesis, start: MeasuredHypothesis, least: float = 0.0) -> float:
    """Share of resampled sets of held-out blocks on which a hypothesis does not have a smaller error than another, by
    the share ``least`` of it.
    """
    return _chance(tried.block_squares(), start.block_squares(), least)


def _end_chance(tried: MeasuredHypothesis, start: MeasuredHypothesis) -> float:
    """The same, of the errors at the ends of the input."""
    return _chance(end_squares(tried), end_squares(start))


def _chance(a: NDArray[np.float64], b: NDArray[np.float64], least: float = 0.0) -> float:
    drawn = np.random.default_rng(0).integers(0, a.size, (DRAWS, a.size))
    return float(np.mean(a[drawn].sum(axis=1) >= (1 - least) ** 2 * b[drawn].sum(axis=1)))

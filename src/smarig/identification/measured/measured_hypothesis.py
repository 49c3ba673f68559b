"""A hypothesis about records with a measured input: effects, or a plain variable, and its errors on held-out blocks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.identification.measured.left_out_errors import chosen_smoothing, held_out_errors
from smarig.identification.measured.measured_fit import MeasuredFit, fit_measured, measured_problem
from smarig.identification.measured.reading_plan import ReadingPlan, reading_plan
from smarig.identification.measured.reading_weights import reading_weights
from smarig.measurement import (
    ConditionTable,
    InputRecord,
    MeasurementEffect,
    MeasurementEffectType,
    SearchedParameter,
    changed,
)

Mask = NDArray[np.bool_]
PROMISING, WORTHWHILE = (
    5,
    0.05,
)  # tries kept of terms; share of the square error that terms must explain for more than one
REFINEMENTS = 3  # rounds that halve the distance between tried values
FIRST_SMOOTHING = 1e-10
DRAWS = 400  # resampled sets of blocks, for intervals
LEVEL_95 = (0.025, 0.975)


@dataclass(frozen=True, eq=False)
class MeasuredHypothesis:
    """Effects (none: the plain model) or a ``variable``, with the errors (m,) of held-out blocks, NaN elsewhere.

    ``intervals`` are 95 % of each searched value, by resampling blocks, inf above the largest of an open search.
    ``at_bound`` names values at the end of their search, which determine nothing.
    """

    effects: tuple[MeasurementEffect, ...]
    errors: Array
    fit: MeasuredFit
    variable: str = ""
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)
    at_bound: tuple[str, ...] = ()

    @property
    def rms(self) -> float:
        """Weighted rms error of held-out blocks, in output units."""
        return float(np.sqrt(np.nanmean(self.weighted**2)))

    @property
    def weighted(self) -> Array:
        """Errors (m,) of held-out blocks times the roots of their weights."""
        return self.fit.problem.weight * self.errors

    @property
    def fitted_rms(self) -> float:
        """Weighted rms error of the same readings in the fit to all of them, in output units."""
        known = np.isfinite(self.errors)
        return root_mean_square((self.fit.problem.weight * self.fit.error)[known])

    @property
    def misfit(self) -> float:
        """Geometric mean of both errors: what the search for a value minimises.

        Held-out blocks on a steep branch are few and predicted badly; the fit to all alone would prefer any value that
        makes the record easier to fit.
        """
        return float(np.sqrt(self.rms * self.fitted_rms))

    @property
    def name(self) -> str:
        """Names of the effects, or the variable."""
        return self.variable or " + ".join(e.kind.name for e in self.effects) or "none"


@dataclass(frozen=True, eq=False)
class Comparison:
    """The settings that all hypotheses share: readings, the mask of those to learn from, and the smoothing."""

    plan: ReadingPlan
    train: Mask
    smoothing: float
    weight: Array

    def evaluated(
        self,
        effects: Sequence[MeasurementEffect],
        near: MeasuredFit | None = None,
    ) -> MeasuredHypothesis:
        """A hypothesis with given values; ``near``: a similar fit, to find this one faster."""
        problem = measured_problem(self.plan, effects, weight=self.weight)
        by_condition = any(e.kind.by_condition for e in effects)
        fit = fit_measured(problem, self.smoothing, self.train, free_gains=by_condition, near=near)
        errors = held_out_errors(problem, self.smoothing, self.train, gains=fit.gains)
        return MeasuredHypothesis(tuple(effects), errors, fit)

    def searched(
        self,
        kind: MeasurementEffectType,
        parameters: Sequence[SearchedParameter],
        present: Sequence[MeasurementEffect],
        fixed: dict[str, float],
        start: MeasuredHypothesis | None = None,
    ) -> MeasuredHypothesis:
        """The hypothesis with the values of an effect that have the least error on held-out blocks.

        Values are searched one parameter after the other: all ``tries``, then between the best and its neighbours. Of
        an effect that only adds terms, the tries that explain most of the errors of a ``start`` are sufficient.
        """
        values = dict(fixed) | {p.name: _neutral(p) for p in parameters}

        def at(changes: dict[str, float]) -> MeasuredHypothesis:
            near = None if start is None else start.fit
            return self.evaluated([*present, kind(**(values | changes))], near=near)

        best: MeasuredHypothesis | None = None
        intervals, bound = {}, []
        for parameter in parameters:
            tries = parameter.tries
            if start is not None and kind.additive:
                tries = _promising(start, tries, [kind(**(values | {parameter.name: v})) for v in tries])
            tried = _search(lambda v, name=parameter.name: at({name: v}), tries)
            found = min(tried, key=lambda v: tried[v].misfit)
            values[parameter.name], best = found, tried[found]
            low, high = _interval(tried)
            unbounded = parameter.open_above and high >= max(parameter.tries)
            intervals[parameter.name] = (low, np.inf if unbounded else high)
            if found == min(parameter.tries) or (found == max(parameter.tries) and not parameter.open_above):
                bound.append(parameter.name)
        return replace(best or at({}), intervals=intervals, at_bound=tuple(bound))


def compared(
    records: Sequence[InputRecord], train: int, selected: Sequence[Mask] | None = None
) -> Comparison:
    """The comparison of all hypotheses on records, of which the first ``train`` are learned from.

    ``selected`` are the rows (n,) of each record that may serve as readings; None: all. Memory follows every row.
    """
    plan = reading_plan(records)
    if selected is not None:
        plan = plan.where(plan.of(selected))
    mask = plan.record < train
    rough = fit_measured(measured_problem(plan), FIRST_SMOOTHING, mask)
    weight = reading_weights(rough)
    return Comparison(plan, mask, chosen_smoothing(measured_problem(plan, weight=weight), mask), weight)


def condition_table(found: MeasuredHypothesis, train: int) -> ConditionTable | None:
    """Gain and zero by the condition of an effect, from the training records; None if no effect has a condition."""
    names = [e.kind.by_condition for e in found.effects if e.kind.by_condition]
    if not names:
        return None
    values = [r.conditions[names[0]] for r in found.fit.problem.plan.records[:train]]
    return ConditionTable.of(names[0], values, found.fit.gains[:train], found.fit.zeros[:train])


def _neutral(parameter: SearchedParameter) -> float:
    """A value to start from: 0 if it is tried, else the middle of the tries."""
    return 0.0 if 0.0 in parameter.tries else parameter.tries[len(parameter.tries) // 2]


def _promising(
    start: MeasuredHypothesis, tries: Sequence[float], effects: Sequence[MeasurementEffect]
) -> tuple[float, ...]:
    """The tries whose terms explain most of the errors of a start, by regression; one if none explains much."""
    plan, known = start.fit.problem.plan, np.isfinite(start.errors)
    weight, target = start.fit.problem.weight[known, None], start.weighted[known]
    zeros = (plan.record[known, None] == np.unique(plan.record[known])).astype(float)

    def left(effect: MeasurementEffect) -> float:
        terms = plan.of([changed(r, [effect]).terms for r in plan.records])[known]
        columns = weight * np.hstack([zeros, terms])
        rest = target - columns @ np.linalg.lstsq(columns, target, rcond=None)[0]
        return float(rest @ rest)

    order = sorted(zip((left(e) for e in effects), tries))
    worthwhile = order[0][0] < (1 - WORTHWHILE) * float(target @ target)
    return tuple(v for _, v in order[: PROMISING if worthwhile else 1])


def _search(
    at: Callable[[float], MeasuredHypothesis], tries: Sequence[float]
) -> dict[float, MeasuredHypothesis]:
    tried = {v: at(v) for v in tries}
    for _ in range(REFINEMENTS if len(tries) > 1 else 0):
        values = sorted(tried)
        k = values.index(min(tried, key=lambda v: tried[v].misfit))
        for neighbour in {max(k - 1, 0), min(k + 1, len(values) - 1)} - {k}:
            between = 0.5 * (values[k] + values[neighbour])
            tried[between] = at(between)
    return tried


def _interval(tried: dict[float, MeasuredHypothesis]) -> tuple[float, float]:
    """95 % interval of the value with the least misfit when the blocks are drawn again."""
    values = np.array(sorted(tried))
    hypotheses = [tried[v] for v in values.tolist()]
    known = np.isfinite(hypotheses[0].errors)
    weight, block = hypotheses[0].fit.problem.weight[known], hypotheses[0].fit.problem.plan.block[known]
    held_out = np.array([h.weighted[known] ** 2 for h in hypotheses])
    fitted = np.array([(weight * h.fit.error[known]) ** 2 for h in hypotheses])
    return resampled_interval(values, (held_out, fitted), block)


def resampled_interval(
    values: Array, squares: Sequence[Array], block: NDArray[np.int64]
) -> tuple[float, float]:
    """95 % interval of the value (k,) whose sums of ``squares``, (k, m) each, have the least product when blocks (m,)
    are drawn again, with replacement.

    It reaches half way to the next values, because the values in between were not tried.
    """
    place = np.unique(block, return_inverse=True)[1]
    rng = np.random.default_rng(0)
    drawn = rng.integers(0, int(place.max()) + 1, (DRAWS, int(place.max()) + 1))
    product = np.ones((values.size, DRAWS))
    for part in squares:
        sums = np.array([np.bincount(place, row) for row in part])
        product *= sums[:, drawn].sum(axis=2)
    best = np.sort(np.argmin(product, axis=0))
    low, high = (int(np.quantile(best, q, method="nearest")) for q in LEVEL_95)
    middle = np.concatenate([values[:1], 0.5 * (values[1:] + values[:-1]), values[-1:]])
    return float(middle[low]), float(middle[high + 1])

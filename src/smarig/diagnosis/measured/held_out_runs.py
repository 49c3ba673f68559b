"""Errors of the plain and of the extended model on held-out runs, and offsets between them and the training runs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.measured.measured_hypothesis import Comparison, MeasuredHypothesis, resampled_interval
from smarig.identification import fit_measured, measured_problem, predicted_outputs
from smarig.measurement import ConditionTable, MeasurementEffect, input_records, measurement_effect_types
from smarig.record import Run
from smarig.replay import Model, simulate_runs

Array = NDArray[np.float64]
OFFSET = "input_offset"
MIN_OFFSET_GAIN = 0.1  # of the run's error
REFINEMENTS = 3


@dataclass(frozen=True, eq=False)
class RunOffset:
    """An offset of a held-out run's input against the training runs, with its 95 % interval, and the rms errors without
    and with it.
    """

    run: str
    offset: float
    interval: tuple[float, float]
    without: float
    with_offset: float


def condition_table(found: MeasuredHypothesis, train: int) -> ConditionTable | None:
    """Gain and zero by the condition of an effect, from the training records; None if no effect has a condition."""
    names = [e.kind.by_condition for e in found.effects if e.kind.by_condition]
    if not names:
        return None
    values = [r.conditions[names[0]] for r in found.fit.problem.plan.records[:train]]
    return ConditionTable.of(names[0], values, found.fit.gains[:train], found.fit.zeros[:train])


def held_out_error(found: MeasuredHypothesis, train: int) -> Array:
    """Errors (m,) at all readings; those of held-out records have the zero and gain of their condition, or about their
    mean if nothing determines the zero.
    """
    fit, plan = found.fit, found.fit.problem.plan
    error = fit.error
    table = condition_table(found, train)
    if table is not None:
        gains = fit.gains.copy()
        zeros = np.zeros(len(plan.records))
        for k, record in enumerate(plan.records[train:], start=train):
            gains[k], zeros[k] = table.at(record.conditions.get(table.condition, table.values[0]))
        programme = fit.problem.programme(gains)
        own_zero = fit.zeros[fit.problem.observations.zero]  # no estimate for a held-out record
        shape = predicted_outputs(fit.problem, programme, fit.x) - own_zero
        error = plan.y - shape - zeros[plan.record]
        error = np.where(plan.record < train, fit.error, error)
    for k in range(train, len(plan.records)):
        own = plan.record == k
        if own.any() and table is None:
            error = np.where(own, error - error[own].mean(), error)
    return error


def replayed_error(model: Model, runs: Sequence[Run], comparison: Comparison) -> Array:
    """Errors (m,) of a model, as it is replayed, at the readings, about their mean in each run; NaN where it predicts
    nothing."""
    plan, found = comparison.plan, []
    predicted = dict(zip((id(r) for r in runs), simulate_runs(model, list(runs))))
    usable = [run for run in runs if input_records([run])]
    for run, record, rows in zip(usable, plan.records, plan.rows):
        finite = np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))
        error = record.y[rows] - predicted[id(run)][np.searchsorted(finite, record.row[rows])]
        found.append(error - np.nanmean(error) if np.isfinite(error).any() else error)
    return np.concatenate(found)


def run_offsets(comparison: Comparison, effects: Sequence[MeasurementEffect], train: int) -> list[RunOffset]:
    """The offsets of held-out runs whose recorded input does not agree with that of the training runs."""
    kind = next(k for k in measurement_effect_types() if k.name == OFFSET)
    found = []
    for k, record in enumerate(comparison.plan.records[train:], start=train):
        parameters = kind.parameters([comparison.plan.records[0], record])
        own = comparison.plan.record == k
        if not parameters or not own.any() or any(e.kind.by_condition for e in effects):
            continue
        errors: dict[float, Array] = {}

        def error_at(offset: float, errors=errors, name=record.name, own=own) -> Array:
            if offset not in errors:
                moved = [*effects, kind(**{name: offset})]
                problem = measured_problem(comparison.plan, moved, weight=comparison.weight)
                error = fit_measured(problem, comparison.smoothing, comparison.train).error[own]
                errors[offset] = error - error.mean()
            return errors[offset]

        found += _offset_of(record.name, error_at, parameters[0].tries, comparison.plan.block[own])
    return found


def _offset_of(name: str, error_at, tries: tuple[float, ...], block: NDArray[np.int64]) -> list[RunOffset]:
    """The offset with the least error, if its interval excludes 0 and the error falls by ``MIN_OFFSET_GAIN``."""
    values = sorted({0.0, *tries})
    for _ in range(REFINEMENTS):
        k = int(np.argmin([_rms(error_at(v)) for v in values]))
        near = {max(k - 1, 0), min(k + 1, len(values) - 1)} - {k}
        values = sorted({*values, *(0.5 * (values[k] + values[j]) for j in near)})
    errors = np.array([error_at(v) for v in values])
    best = int(np.argmin(np.mean(errors**2, axis=1)))
    low, high = resampled_interval(np.array(values), (errors**2,), block)
    without, with_offset = _rms(error_at(0.0)), _rms(errors[best])
    if low <= 0 <= high or with_offset > (1 - MIN_OFFSET_GAIN) * without:
        return []
    return [RunOffset(name, values[best], (low, high), without, with_offset)]


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))

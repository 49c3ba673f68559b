"""Errors of the plain and of the extended model on held-out runs, and offsets between them and the training runs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.identification import (
    Comparison,
    MeasuredHypothesis,
    condition_table,
    fit_measured,
    measured_problem,
    resampled_interval,
)
from smarig.measurement import InputRecord, MeasurementEffect, measurement_effect_types

Array = NDArray[np.float64]
OFFSET = "input_offset"
MIN_OFFSET_GAIN = 0.1  # of the run's error
REFINEMENTS = 3
SAME_RANGE = 0.1  # share by which the ranges of two inputs may differ


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


def held_out_error(found: MeasuredHypothesis, train: int) -> Array:
    """Errors (m,) at all readings; those of held-out records have the zero and gain of their condition, or about their
    mean if nothing determines the zero.
    """
    fit, plan = found.fit, found.fit.problem.plan
    error = fit.error
    table = condition_table(found, train)
    if table is not None:
        shape, terms = fit.shape, fit.problem.terms @ fit.amplitudes
        for k, record in enumerate(plan.records[train:], start=train):
            own = plan.record == k
            value = record.conditions.get(table.condition, table.values[0])
            error[own] = plan.y[own] - table.outputs(shape[own], value) - terms[own]
    for k in range(train, len(plan.records)):
        own = plan.record == k
        if own.any() and table is None:
            error = np.where(own, error - error[own].mean(), error)
    return error


def run_offsets(comparison: Comparison, effects: Sequence[MeasurementEffect], train: int) -> list[RunOffset]:
    """The offsets of held-out runs whose recorded input does not agree with that of the training runs."""
    kind = next(k for k in measurement_effect_types() if k.name == OFFSET)
    found = []
    for k, record in enumerate(comparison.plan.records[train:], start=train):
        parameters = kind.parameters([comparison.plan.records[0], record])
        own = comparison.plan.record == k
        if not parameters or not own.any() or any(e.kind.by_condition for e in effects):
            continue
        if not _same_range(comparison.plan.records[:train], record):
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


def _same_range(train: Sequence[InputRecord], record: InputRecord) -> bool:
    """Whether a record covers the input range of the training runs: the memory of a smaller one is not known, and a
    larger one is extrapolated.
    """
    span = max(float(np.ptp(r.u)) for r in train)
    return abs(float(np.ptp(record.u)) / span - 1) <= SAME_RANGE


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
    if best in (0, len(values) - 1) or not low < values[best] < high:
        return []
    if low <= 0 <= high or with_offset > (1 - MIN_OFFSET_GAIN) * without:
        return []
    return [RunOffset(name, values[best], (low, high), without, with_offset)]


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))

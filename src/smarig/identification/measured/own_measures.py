"""A hysteresis of its own for each load: fitted to the readings under that load alone, and applied to all the others.

Settled readings are few and precise, so they have a finer partition, and a part of the output that is proportional to
the input, such as thermal expansion: k v, with any sign. In the table it is a density on the diagonal.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.measured.measured_fit import MeasuredFit, fit_measured, measured_problem
from smarig.identification.measured.reading_plan import ReadingPlan
from smarig.measurement import MeasurementEffect, changed, monotone_branches, reversals
from smarig.preisach import FodTable, Initial, Preisach

Mask = NDArray[np.bool_]
FEWEST_INTERVALS, MOST_INTERVALS = 30, 75  # of settled readings,
READINGS_PER_INTERVAL = 2.5  # with fewer, the measure would follow each reading alone


@dataclass(frozen=True, eq=False)
class OwnMeasure:
    """The hysteresis of one load, ``table``; its outputs ``shape`` (m,) at the readings of all loads, without a zero;
    ``zeros`` (m,) of the readings under it, and ``error`` (m,) of these, NaN at others.
    """

    table: FodTable
    shape: Array
    zeros: Array
    error: Array


def own_measure(fit: MeasuredFit, smoothing: float, own: Mask, *, proportional: bool) -> OwnMeasure:
    """The hysteresis of the readings of a mask (m,), with the effects of a fit to all loads.

    ``proportional``: with a part that is proportional to the input.
    """
    problem = fit.problem
    if any(r.readings is None for r in problem.plan.records):
        found = fit_measured(problem, smoothing, own)
        zeros = found.zeros[problem.observations.zero]
        return OwnMeasure(found.table, found.shape, zeros, np.where(own, found.error, np.nan))
    effects = [e for e in problem.effects if e.kind.by_condition]
    plan = problem.plan.where(own)
    intervals = round(int(own.sum()) / READINGS_PER_INTERVAL)
    intervals = min(max(intervals, FEWEST_INTERVALS), MOST_INTERVALS)
    inputs = plan.of([changed(record, effects).input for record in plan.records])
    terms = inputs[:, None] if proportional else None
    alone = measured_problem(
        plan, effects, extra_terms=terms, weight=problem.weight[own], intervals=intervals
    )
    found = fit_measured(alone, smoothing)
    slope = float(found.amplitudes[0]) if proportional else 0.0
    table = _with_slope(found.table, slope)
    zeros, error = np.zeros(own.size), np.full(own.size, np.nan)
    zeros[own], error[own] = found.zeros[alone.observations.zero], found.error
    return OwnMeasure(table, _along(table, problem.plan, effects), zeros, error)


def _with_slope(table: FodTable, slope: float) -> FodTable:
    """The table plus ``slope`` times the input: y(α, β) + k β."""
    return FodTable(table.nodes, table.values + slope * table.nodes[None, :], table.unit) if slope else table


def _along(table: FodTable, plan: ReadingPlan, effects: list[MeasurementEffect]) -> Array:
    """Outputs (m,) of a hysteresis at all readings of a plan."""
    outputs: list[Array] = []
    operator: Preisach | None = None
    for k, record in enumerate(plan.records):
        change = changed(record, effects)
        u = monotone_branches(change.input, reversals(change.input, change.noise))
        start: Initial = plan.starts[k].state or "negative"
        if record.continues and operator is not None:
            start = operator.state
        operator = Preisach(table, start, samples=u.size)
        outputs.append(operator.simulate(np.clip(u, table.lower, table.upper), start))
    return plan.of(outputs)

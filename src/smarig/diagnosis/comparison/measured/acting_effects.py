"""How an effect of the catalogue becomes a hypothesis: the input that acts, and covariances of what it adds.

An effect that adds terms gets φφᵀ with an unknown amplitude, and a small smooth deviation from its fixed shape, because
no drift is an exponential. An effect of a condition gets a zero, a gain, a shift and a width that are smooth in it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem, smooth_kernel
from smarig.diagnosis.comparison.measured.varied_together import at_one_rate
from smarig.measurement import (
    InputRecord,
    LearnedTerm,
    MeasurementEffect,
    MeasurementEffectType,
    changed,
    learned_input,
    measurement_effect_types,
    reversals,
    width_of_leading_loops,
)

DEVIATION = 0.02  # variance of the deviation from the shape, over that of the shape
DEVIATION_LENGTH = 0.35  # of the range of the variable
CONDITION_LENGTH = 1.0  # of the range of a condition: gain and zero between two loads lie near a line
LAGS = 9
MAX_CYCLE_SHARE = 0.25  # of a cycle: a longer lag is no lag
Tries = dict[str, tuple[float, ...]]


def acting_inputs(
    problem: ReadingProblem, effects: Sequence[MeasurementEffect], laws: Sequence[LearnedTerm] = ()
) -> list[Array]:
    """The input (n,) of each record that acts on the wire, under effects and laws."""
    return [learned_input(r, changed(r, effects).input, laws) for r in problem.records]


def added_parts(problem: ReadingProblem, effect: MeasurementEffect, shapes: Sequence[Array]) -> list[Array]:
    """Covariances (m, m) of what an effect adds to the output; ``shapes`` (m,) are its level, slope and width."""
    if effect.kind.by_condition:
        z, (level, slope, width) = problem.variables[effect.kind.by_condition], shapes
        k = centred(smooth_kernel(z, CONDITION_LENGTH), problem.train)
        curved = _without_line(
            k, z, problem.train
        )  # a shift in proportion to the condition is the effect itself
        return [k, k * np.outer(level, level), curved * np.outer(slope, slope), k * np.outer(width, width)]
    if effect.kind.name == "input_offset":  # what the search has left of the offsets, and those of other runs
        run = problem.record
        return [centred((run[:, None] == run) * np.outer(shapes[1], shapes[1]), problem.train)]
    terms = np.concatenate(
        [changed(r, [effect]).terms[rows] for r, rows in zip(problem.records, problem.rows)]
    )
    parts = []
    for column in terms.T:
        own = column[problem.train]
        x = (column - own.mean()) / (float(own.std()) or 1.0)
        parts.append(np.outer(x, x) + DEVIATION * _deviation(problem, effect.kind))
    return parts


def _deviation(problem: ReadingProblem, kind: MeasurementEffectType) -> Array:
    if kind.name == "output_jump":  # its shape is exact
        return np.zeros((problem.y.size, problem.y.size))
    name = next(n for n in kind.depends_on if n in problem.variables)
    return centred(smooth_kernel(problem.variables[name], DEVIATION_LENGTH), problem.train)


def centred(k: Array, train: NDArray[np.bool_]) -> Array:
    """A covariance (m, m) of functions whose mean over the training readings is zero."""
    column = k[:, train].mean(axis=1)
    return k - column[:, None] - column + float(column[train].mean())


def _without_line(k: Array, z: Array, train: NDArray[np.bool_]) -> Array:
    """A covariance (m, m) of functions without a constant and a linear part in z over the training readings."""
    line = np.column_stack([np.ones(z.size), (z - z.mean()) / (float(np.ptp(z)) or 1.0)])
    weights = np.linalg.pinv(line[train])
    half = k - line @ (weights @ k[train])
    return half - (half[:, train] @ weights.T) @ line.T


def testable_effects(problem: ReadingProblem) -> list[tuple[MeasurementEffectType, Tries]]:
    """The effects that these records can be asked for, with the values to try; an effect may have alternatives."""
    trained = [r for k, r in enumerate(problem.records) if (problem.train & (problem.record == k)).any()]
    found: list[tuple[MeasurementEffectType, Tries]] = []
    for kind in measurement_effect_types():
        if kind.descriptive:  # the plain model has a smooth reversible part of any sign
            continue
        if kind.name == "output_jump":  # in any one of the records
            options = [_tries(kind, [r]) for r in trained]
        else:
            options = [_lags(problem, trained) if kind.name == "input_lag" else _tries(kind, trained)]
        found += [(kind, tries) for tries in options if tries]
    return found


def _tries(kind: MeasurementEffectType, records: Sequence[InputRecord]) -> Tries:
    return {p.name: p.tries for p in kind.parameters(records) or ()}


def _lags(problem: ReadingProblem, records: Sequence[InputRecord]) -> Tries:
    """Two rows to a quarter of a cycle.

    Without a clock, or at one rate, only an output that leads its input shows a lag, for no wire leads; the import may
    have found it.
    """
    clocks = {r.clock for r in records}
    blind = clocks == {False} or at_one_rate(problem)
    leads = "input_lag" in problem.suspected or any(_leads(r) for r in records)
    if len(clocks) > 1 or (blind and not leads):
        return {}
    step = max(float(np.median(np.diff(r.t))) for r in records)
    cycle = float(np.median([np.ptp(r.t) / max(r.cycle[-1] - r.cycle[0], 0.5) for r in records]))
    low, high = 2 * step, MAX_CYCLE_SHARE * cycle
    if high <= 2 * low or step <= 0:
        return {}
    return {"lag_s" if clocks == {True} else "lag_rows": tuple(np.geomspace(low, high, LAGS).tolist())}


def _leads(record: InputRecord) -> bool:
    return width_of_leading_loops(record.u, record.y, reversals(record.u)) is not None

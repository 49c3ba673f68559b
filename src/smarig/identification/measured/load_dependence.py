"""One model of a wire under several loads: a shift of the input by the load, and outputs interpolated between loads.

    v = u − (σ − σ₀)/C,    y(σ) interpolated between y_k = z_k + g_k P[v] at the loads σ_k

The slope C is searched for with one measure P for all loads, and with a part k u of the output (thermal expansion, of
either sign) if the readings need one. Each load then has a measure of its own if that predicts loads left out better.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, root_mean_square, spaced, suggestion
from smarig.identification.measured.left_out_errors import chosen_smoothing
from smarig.identification.measured.measured_fit import MeasuredFit, fit_measured, measured_problem
from smarig.identification.measured.measured_hypothesis import Comparison, MeasuredHypothesis, compared
from smarig.identification.measured.own_measures import OwnMeasure, own_measure
from smarig.identification.measured.reading_weights import reading_weights
from smarig.identification.measured.zero_by_load import ZERO_SLOPE, ZeroSlope, with_zero_slope
from smarig.measurement import (
    SAME_SHARE,
    ConditionTable,
    InputRecord,
    MeasurementEffect,
    MeasurementEffectType,
    MeasurementPart,
    condition_groups,
    measurement_effect_types,
)
from smarig.preisach import FodTable

OWN_ADVANTAGE = 0.9  # of the error at loads left out, at most: measures of their own are the larger model
FEWEST_TO_LEAVE_OUT = 3
PROPORTIONAL = "proportional_part"


@dataclass(frozen=True)
class LeftOutLoad:
    """Rms errors at a load left out: with ``one`` measure for all loads, and with their ``own``.

    ``beyond``: the load is the smallest or the largest, so it is not interpolated.
    """

    value: float
    beyond: bool
    one: float
    own: float


@dataclass(frozen=True, eq=False)
class LoadDependence:
    """The fit to runs under several loads.

    ``value`` of the ``parameter`` of the effect (C) has a 95 % ``interval``; ``at_bound``: it lies at the end of its
    search. ``hysteresis`` is the one measure of all loads. ``own``: each load has its own, in ``part``. ``table`` holds
    gain and zero of each load. ``error`` (m,) are measured minus fitted outputs at the readings. ``zero_slope``: how
    the position of a wire of a rig changes with the load alone, None if no run shows it.
    """

    condition: str
    parameter: str
    unit: str
    value: float
    interval: tuple[float, float]
    at_bound: bool
    hysteresis: FodTable
    part: MeasurementPart
    table: ConditionTable
    own: bool
    left_out: tuple[LeftOutLoad, ...]
    error: Array
    smoothing: float
    zero_slope: ZeroSlope | None = None

    def with_zero_slope(self, slope: ZeroSlope) -> "LoadDependence":
        """The same with the zeros of a wire that this load moves."""
        table = with_zero_slope(self.table, slope)
        return replace(self, table=table, part=replace(self.part, table=table), zero_slope=slope)

    def left_out_rms(self, *, beyond: bool) -> float | None:
        """Rms error at loads left out, between the others or beyond them; None if none was left out."""
        squares = [(k.own if self.own else k.one) ** 2 for k in self.left_out if k.beyond == beyond]
        return float(np.sqrt(np.mean(squares))) if squares else None

    @property
    def text(self) -> str:
        """The slope with its interval, and the error at loads left out."""
        low, high = self.interval
        loads = ", ".join(f"{v:.4g}" for v in self.table.values)
        errors = [
            f"{where} the others {rms:.3g}"
            for where, rms in (
                ("between", self.left_out_rms(beyond=False)),
                ("beyond", self.left_out_rms(beyond=True)),
            )
            if rms is not None
        ]
        left_out = f" Rms error at loads left out: {', '.join(errors)}." if errors else ""
        return (
            f"{self.parameter} = {self.value:.3g}{spaced(self.unit)} [{low:.3g}, {high:.3g}] from "
            f"{self.condition} {loads}; "
            f"{'one measure for each load' if self.own else 'one measure for all loads'}.{left_out}{self._zero_text}"
        )

    @property
    def _zero_text(self) -> str:
        if self.zero_slope is None:
            return ""
        z, (low, high) = self.zero_slope, self.zero_slope.interval
        return f" The load alone moves the position by {z.value:.3g}{spaced(z.unit)} [{low:.3g}, {high:.3g}]."

    def to_json(self) -> dict[str, Any]:
        """Plain values, as in the model file and on the command line."""
        return {
            "condition": self.condition,
            "values": list(self.table.values),
            self.parameter: {"value": self.value, "ci95": list(self.interval), "unit": self.unit},
            "measures": "one for each load" if self.own else "one for all loads",
            "left_out": [
                {"value": k.value, "beyond": k.beyond, "one_measure": k.one, "own_measures": k.own}
                for k in self.left_out
            ],
            "between_rms": self.left_out_rms(beyond=False),
            "beyond_rms": self.left_out_rms(beyond=True),
            **({ZERO_SLOPE: self.zero_slope.to_json()} if self.zero_slope else {}),
        }


def fit_load_dependence(records: Sequence[InputRecord], condition: str) -> LoadDependence:
    """Fit one model to records under several loads.

    Raises UsageError if no effect depends on the condition, DataError if the records do not state several values.
    """
    kind = _effect_of(condition)
    _check_loads(records, condition)
    plain = compared(records, len(records))
    rough = _searched(plain, kind, records)
    weight = reading_weights(rough.fit)
    problem = measured_problem(plain.plan, rough.effects, weight=weight)
    smoothing = chosen_smoothing(problem, gains=rough.fit.gains)
    comparison = replace(plain, smoothing=smoothing, weight=weight)
    present = _proportional(comparison, rough.effects)
    return _with_measures(comparison, _searched(comparison, kind, records, present), condition)


def _effect_of(condition: str) -> MeasurementEffectType:
    kinds = {k.by_condition: k for k in measurement_effect_types() if k.by_condition}
    if condition not in kinds:
        raise UsageError(
            f"No effect of the catalogue depends on '{condition}'{suggestion(condition, sorted(kinds))}. "
            f"A load can be taken from: {', '.join(sorted(kinds))}."
        )
    return kinds[condition]


def _check_loads(records: Sequence[InputRecord], condition: str) -> None:
    missing = [r.name for r in records if condition not in r.conditions]
    if missing:
        raise DataError(
            f"{', '.join(missing)} does not state its {condition}. Import it with a mapping that has '{condition}' "
            "under [conditions]."
        )
    if _effect_of(condition).parameters(records) is None:
        raise DataError(
            f"The {condition} is about {records[0].conditions[condition]:.4g} in all runs, so its influence cannot be "
            f"identified. Give runs of at least two values of the {condition}."
        )


def _searched(
    comparison: Comparison,
    kind: MeasurementEffectType,
    records: Sequence[InputRecord],
    present: Sequence[MeasurementEffect] = (),
) -> MeasuredHypothesis:
    parameters = kind.parameters(records) or ()
    return comparison.searched(
        kind, parameters, present, {"reference": records[0].conditions[kind.by_condition]}
    )


def _proportional(
    comparison: Comparison, effects: Sequence[MeasurementEffect]
) -> tuple[MeasurementEffect, ...]:
    """A part of the output proportional to the input, if settled readings are predicted better with it."""
    if any(r.readings is None for r in comparison.plan.records):
        return ()
    kinds = {k.name: k for k in measurement_effect_types()}
    part = (kinds[PROPORTIONAL](),)
    with_part, without = comparison.evaluated((*part, *effects)), comparison.evaluated(effects)
    return part if with_part.misfit < OWN_ADVANTAGE * without.misfit else ()


def _with_measures(comparison: Comparison, found: MeasuredHypothesis, condition: str) -> LoadDependence:
    """The result with one measure, or with one for each load."""
    effect = next(e for e in found.effects if e.kind.by_condition)
    loads = _Loads.of(comparison, found.fit, condition)
    parameter = next(iter(effect.kind.parameters(comparison.plan.records) or ()))
    left_out = loads.left_out()
    inner = np.array([(k.one, k.own) for k in left_out if not k.beyond]).reshape(-1, 2)
    one, several = np.sqrt(np.mean(inner**2, axis=0)) if inner.size else (0.0, np.inf)
    own = bool(several < OWN_ADVANTAGE * one)
    table = replace(loads.table, zeros=loads.own_zeros) if own else loads.table
    return LoadDependence(
        condition=condition,
        parameter=parameter.name,
        unit=parameter.unit,
        value=effect.values[parameter.name],
        interval=found.intervals[parameter.name],
        at_bound=bool(found.at_bound),
        hysteresis=found.fit.table,
        part=MeasurementPart((effect,), (), table, loads.own_tables())
        if own
        else MeasurementPart(found.effects, tuple(found.fit.amplitudes.tolist()), table),
        table=table,
        own=own,
        left_out=left_out,
        error=loads.own_error() if own else found.fit.error,
        smoothing=comparison.smoothing,
    )


@dataclass(frozen=True, eq=False)
class _Loads:
    """A fit of one measure, and one fit for each load; ``group`` (m,) is the load of each reading."""

    smoothing: float
    fit: MeasuredFit
    condition: str
    table: ConditionTable
    group: NDArray[np.int64]
    each: tuple[OwnMeasure, ...]

    @classmethod
    def of(cls, comparison: Comparison, fit: MeasuredFit, condition: str) -> "_Loads":
        plan = fit.problem.plan
        group = np.array(condition_groups([r.conditions[condition] for r in plan.records]))[plan.record]
        proportional = bool(fit.amplitudes.size)
        each = tuple(
            own_measure(fit, comparison.smoothing, group == k, proportional=proportional)
            for k in range(int(group.max()) + 1)
        )
        table = _table(fit, np.ones(group.size, dtype=bool), condition)
        return cls(comparison.smoothing, fit, condition, table, group, each)

    @property
    def shapes(self) -> Array:
        """The own hysteresis of each load at all readings, over its gain, (loads, m)."""
        return np.array([f.shape / g for f, g in zip(self.each, self.table.gains)])

    def own_tables(self) -> tuple[FodTable, ...]:
        """The own hysteresis of each load over its gain."""
        tables = zip((f.table for f in self.each), self.table.gains)
        return tuple(FodTable(t.nodes, t.values / g, t.unit) for t, g in tables)

    def own_error(self) -> Array:
        """Measured minus fitted outputs (m,) with the own measure of each load."""
        return np.array([f.error for f in self.each])[self.group, np.arange(self.group.size)]

    def left_out(self) -> tuple[LeftOutLoad, ...]:
        """The errors at each load when it is left out; none if fewer than two loads remain."""
        count = len(self.each)
        return tuple(self._left_out(k) for k in range(count)) if count >= FEWEST_TO_LEAVE_OUT else ()

    def _left_out(self, k: int) -> LeftOutLoad:
        kept, value = self.group != k, self.table.values[k]
        y = self.fit.problem.plan.y[~kept]
        again = fit_measured(self.fit.problem, self.smoothing, kept, gains=self.fit.gains, free_gains=True)
        terms = again.problem.terms @ again.amplitudes  # what the terms add to the output
        one = _table(again, kept, self.condition).outputs(again.shape[~kept], value) + terms[~kept]
        others = [j for j in range(len(self.each)) if j != k]
        rest = ConditionTable(
            self.condition,
            *(tuple(x[j] for j in others) for x in (self.table.values, self.table.gains, self.own_zeros)),
        )
        own = rest.outputs(self.shapes[others][:, ~kept], value)
        return LeftOutLoad(
            value, k in (0, len(self.each) - 1), root_mean_square(y - one), root_mean_square(y - own)
        )

    @property
    def own_zeros(self) -> tuple[float, ...]:
        """Zero of each load with its own measure."""
        return tuple(float(np.mean(f.zeros[self.group == k])) for k, f in enumerate(self.each))


def _table(fit: MeasuredFit, used: NDArray[np.bool_], condition: str) -> ConditionTable:
    """Gain and zero of the loads of a mask (m,) of readings."""
    plan, zero = fit.problem.plan, fit.problem.observations.zero
    place = {k: int(zero[np.argmax(plan.record == k)]) for k in np.unique(plan.record[used]).tolist()}
    values = [plan.records[k].conditions[condition] for k in place]
    return ConditionTable.of(condition, values, fit.gains[list(place)], fit.zeros[list(place.values())])


def expected_rms(stored: dict[str, Any], value: float) -> float | None:
    """The error to be expected at a value of the condition, from loads left out; None if the load was measured, or if
    it is farther from the others than these are apart: nothing is known of it then.
    """
    values = [float(v) for v in stored["values"]]
    if min(abs(value - v) for v in values) <= SAME_SHARE * (max(values) - min(values)):
        return None
    if is_far(values, value):
        return None
    return stored["between_rms" if values[0] < value < values[-1] else "beyond_rms"]


def is_far(values: Sequence[float], value: float) -> bool:
    """Whether a value lies farther outside increasing ones than the widest gap between them."""
    widest = max((b - a for a, b in pairwise(values)), default=0.0)
    return not values[0] - widest <= value <= values[-1] + widest

"""Coercive field, remanence and largest output of loops over a field: what a magnet or a ferroelectric is known by.

On the rising and the falling branch of a loop whose output is centred between its largest and smallest value,

    H± where y = 0:   coercive field (H₊ − H₋)/2, bias (H₊ + H₋)/2        y± at H = 0:   remanence (y₋ − y₊)/2

Several loops of one condition give the mean, and the least and the largest as its range; loops at another temperature
or load have figures of their own. A loop counts if it is closed, its ends are opposite, and readings lie on both of its
branches: reversal curves have no such loop. Source: Bertotti, Hysteresis in Magnetism, 1998, section 1.1.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from smarig.core import Array, capitalised
from smarig.exchange import dimension
from smarig.measurement import reversals
from smarig.record import Run
from smarig.study.runs_by_condition import RunsOfCondition, conditions_text, runs_by_condition
from smarig.study.study_sentences import measure

_MAGNETIC = ("magnetic field", "magnetic moment", "specific moment")  # M in A/m and B in T count as fields
_ELECTRIC = ("polarisation", "charge")
_OUTPUTS = {
    "magnetic field": _MAGNETIC,
    "electric field": _ELECTRIC,
    "voltage": _ELECTRIC,
}  # by what drives them
_WIDE = 0.9  # of the largest loop's field: smaller loops are inner ones
Range = tuple[float, float, float]  # mean, least, largest


@dataclass(frozen=True)
class FieldLoops:
    """Each figure as mean, least and largest of ``loops``: ``coercive`` and ``bias`` in the unit of the field,
    ``remanence`` and ``saturation`` (half the range of the output) in that of the output. ``conditions``: those by
    which the runs of these loops differ from others, with value and unit.
    """

    loops: int
    coercive: Range
    bias: Range
    remanence: Range
    saturation: Range
    field_unit: str
    unit: str
    conditions: tuple[tuple[str, float, str], ...] = ()

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        figures = {n: getattr(self, n) for n in ("coercive", "bias", "remanence", "saturation")}
        units = {n: self.field_unit if n in ("coercive", "bias") else self.unit for n in figures}
        values = {n: {"value": m, "range": [a, b], "unit": units[n]} for n, (m, a, b) in figures.items()}
        conditions = {name: {"value": value, "unit": unit} for name, value, unit in self.conditions}
        return {"conditions": conditions, "loops": self.loops} | values


def field_loops(runs: Sequence[Run]) -> tuple[FieldLoops, ...]:
    """The figures of the full loops of runs over a field, for each condition of the runs; none without such loops, or
    if the field keeps its sign.
    """
    hold = [run for run in runs if run.has("input") and run.has("position") and _is_field(run)]
    found = [_of_group(group) for group in runs_by_condition(hold)]
    return tuple(loops for loops in found if loops is not None)


def _of_group(group: RunsOfCondition) -> FieldLoops | None:
    found = [figures for run in group.runs for figures in _of_run(run["input"], run["position"])]
    if not found:
        return None
    coercive, bias, remanence, saturation = (
        (float(column.mean()), float(column.min()), float(column.max())) for column in np.array(found).T
    )
    units = group.runs[0].input_unit, group.runs[0].unit
    return FieldLoops(len(found), coercive, bias, remanence, saturation, *units, group.conditions)


def _is_field(run: Run) -> bool:
    return dimension(run.unit) in _OUTPUTS.get(dimension(run.input_unit), ())


def _of_run(u: Array, y: Array) -> Iterator[tuple[float, float, float, float]]:
    finite = np.isfinite(u) & np.isfinite(y)
    u, y = u[finite], y[finite]
    if u.size < 10 or not u.min() < 0 < u.max():
        return
    branches = [slice(a, b + 1) for a, b in pairwise(reversals(u))]
    whole = float(np.ptp(u))
    full = [part for part in branches if np.ptp(u[part]) >= _WIDE * whole]
    for first, second in list(pairwise(full))[::2]:
        if first.stop - 1 != second.start or not _is_closed(u, y, first, second):
            continue
        both = np.concatenate([y[first], y[second]])
        middle, half = (both.max() + both.min()) / 2, np.ptp(both) / 2
        ways = [(u[p], y[p] - middle) for p in (first, second)]
        rising, falling = sorted(ways, key=lambda w: w[0][0])  # which begins at the low end
        crossings = [_crossing(*way) for way in (rising, falling)]
        crossings += [_crossing(out, field) for field, out in (rising, falling)]
        known = [c for c in crossings if c is not None]
        if len(known) == len(crossings):
            up, down, low, high = known
            yield abs(up - down) / 2, (up + down) / 2, abs(high - low) / 2, float(half)


def _is_closed(u: Array, y: Array, first: slice, second: slice) -> bool:
    """Whether two branches end where they began, and their ends are opposite fields."""
    start, turn, end = first.start, second.start, second.stop - 1
    opposite = abs(u[start] + u[turn]) <= (1 - _WIDE) * abs(u[start] - u[turn])
    return bool(opposite and abs(y[start] - y[end]) <= (1 - _WIDE) * np.ptp(y[start : end + 1]))


def _crossing(x: Array, y: Array) -> float | None:
    """x where y first changes its sign, between two readings; None if it does not, or between the ends of a branch on
    which nothing was read.
    """
    at = np.flatnonzero(np.diff(np.sign(y)) != 0)
    if not at.size:
        return None
    k = int(at[at.size // 2])  # of crossings by noise the middle one
    if k == 0 and k + 2 == y.size:
        return None
    step = y[k + 1] - y[k]
    return float(x[k] - y[k] * (x[k + 1] - x[k]) / step)


def field_sentences(found: Sequence[FieldLoops]) -> list[str]:
    """The figures as lines of text, one for each condition; none without loops."""
    return [_sentence(loops) for loops in found]


def _sentence(loops: FieldLoops) -> str:
    how = f"means of {loops.loops} loops" if loops.loops > 1 else "of one loop"
    coercive, bias = (measure(mean, loops.field_unit) for mean, *_ in (loops.coercive, loops.bias))
    remanence = measure(loops.remanence[0], loops.unit)
    at = conditions_text(loops.conditions)
    what = f"{capitalised(at)}: coercive field" if at else "Coercive field"
    return f"{what} {coercive}, bias {bias}, remanence {remanence} ({how})."

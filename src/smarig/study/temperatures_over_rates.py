"""Transformation temperatures of one specimen at several rates: a lag moves them, and at rate zero it does not.

A lag τ shifts the temperatures of heating by τ times the rate, and those of cooling by as much the other way: up on
heating where the specimen follows its thermometer late, down where the thermometer is late. So T = T₀ ± τ r is fitted
to each temperature over the rate r. The error of T₀ is the largest of that of the tangents, that of their propagation
through the line, and that of the scatter about it, with Student's t.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import stdtrit  # scipy.stats takes 50 MB and a second

from smarig.core import Array, spaced
from smarig.record import Run, load_run
from smarig.report import display_unit, number, to_uncertainty
from smarig.study.input_turns import wide_turns
from smarig.study.other_zeros import columns_of
from smarig.study.runs_by_condition import differing
from smarig.transformation import HEAT_TEMPERATURES

if TYPE_CHECKING:
    from smarig.study.each_file import FileOutcome

_OTHER_RATE = 1.2  # times: smaller differences are one rate
_ENOUGH_RATES = 3  # for an interval of the temperatures at rate zero
_MIDDLE = (0.1, 0.9)  # of the range of a branch, between which its rate is taken
_S_PER_MIN = 60.0


@dataclass(frozen=True)
class TemperatureAtRate:
    """A temperature at a rate (K/min), with half of its 95 % interval."""

    name: str
    rate: float
    value: float
    half: float


@dataclass(frozen=True)
class RateLine:
    """A temperature over the rate: slope in minutes, value at rate zero, and half of its 95 % interval."""

    slope: float
    at_zero: float
    half: float


@dataclass(frozen=True)
class RateTrend:
    """Temperatures that go with the rate: their ``readings``, the line of each by name, and the ``files`` compared."""

    readings: tuple[TemperatureAtRate, ...]
    lines: Mapping[str, RateLine]
    files: tuple[str, ...] = ()

    @property
    def rates(self) -> list[float]:
        """The different rates in K/min."""
        return _different([r.rate for r in self.readings])

    @property
    def has_intervals(self) -> bool:
        """Whether there are enough rates for intervals at rate zero."""
        return len(self.rates) >= _ENOUGH_RATES

    @property
    def lag_s(self) -> float:
        """The lag; negative if it is the thermometer that follows the specimen."""
        slopes = [line.slope * (1 if name.startswith("A") else -1) for name, line in self.lines.items()]
        return _S_PER_MIN * float(np.mean(slopes))

    def cause(self) -> str:
        """How the temperatures go with the rate, in a sentence."""
        heating, cooling = (
            ", ".join(name for name in self.lines if name.startswith(way)) for way in ("A", "M")
        )
        up, down = (heating, cooling) if self.lag_s > 0 else (cooling, heating)
        late = (
            "specimen that follows its thermometer"
            if self.lag_s > 0
            else "thermometer that follows the specimen"
        )
        listed = ", ".join(number(rate) for rate in self.rates)
        first = f"{up} rise and {down} fall with the rate ({listed} K/min), as of a {late}"
        return (
            f"{first} {number(abs(self.lag_s), 2)} s late: those of one rate are not of the specimen alone."
        )

    def sentence(self, unit: str = "degC") -> str:
        """The cause, and the temperatures at rate zero, each with its interval if there is one."""
        values = ", ".join(
            f"{name} {_shown(line, unit, interval=self.has_intervals)}" for name, line in self.lines.items()
        )
        how = "At rate zero" if self.has_intervals else "By the line through two rates, at rate zero"
        more = "" if self.has_intervals else "; a third rate would give their intervals"
        names = f"{', '.join(self.files)}: " if self.files else ""
        return f"{names}{self.cause()} {how}: {values}{more}."


def over_rates(outcomes: "Sequence[FileOutcome]") -> dict[str, RateTrend]:
    """By the first file of those with equal columns and conditions, how their temperatures go with the rate."""
    groups: dict[tuple[Any, ...], list[FileOutcome]] = {}
    for outcome in outcomes:
        if outcome.found is not None and (outcome.found["calorimetry"] or outcome.found["transformation"]):
            groups.setdefault(columns_of(outcome.found), []).append(outcome)
    found = {}
    for group in groups.values():
        runs = [_runs(outcome) for outcome in group]
        if len(group) > 1 and differing([run for own in runs for run in own]):
            continue
        readings = [r for o, own in zip(group, runs) for r in readings_of(o.found or {}, own)]
        if trend := rate_trend(readings):
            names = tuple(Path(outcome.file).name for outcome in group)
            found[group[0].file] = replace(trend, files=names)
    return found


def readings_of(found: Mapping[str, Any], runs: Sequence[Run]) -> list[TemperatureAtRate]:
    """The temperatures that a study found, each at the rate of its branch; ``runs`` are those of the study."""
    heat, loops = (
        found.get("calorimetry") or {},
        (found.get("transformation") or {}).get("temperatures") or {},
    )
    readings: list[TemperatureAtRate] = []
    for cycle in heat.get("cycles", ()):
        rates = cycle["rates_K_per_min"]
        readings += _at(cycle["figures"], {way: rate for way, rate in rates.items() if rate})
    rates_of = {run.name: _rates(run) for run in runs}
    for each in loops.get("runs", ()):
        readings += _at(each["figures"], rates_of.get(each["run"], {}))
    return readings


def _at(figures: Mapping[str, Any], rates: Mapping[str, float]) -> Iterator[TemperatureAtRate]:
    for name, figure in figures.items():
        way = "heating" if name.startswith("A") else "cooling"
        if name in HEAT_TEMPERATURES and way in rates and figure.get("value") is not None:
            low, high = figure["ci95"]
            yield TemperatureAtRate(name, rates[way], figure["value"], (high - low) / 2)


def _rates(run: Run) -> dict[str, float]:
    """The rates of the temperature of a run in K/min on heating and on cooling; {} without a clock."""
    if not run.has("t_s") or not run.has("input") or run.settled:
        return {}
    t, u = run["t_s"], run["input"]
    known = np.isfinite(t) & np.isfinite(u)
    t, u = t[known], u[known]
    found: dict[str, list[float]] = {}
    turns = wide_turns(u).tolist() if u.size > 3 else []
    for a, b in zip(turns, turns[1:]):
        part = np.clip((u[a : b + 1] - u[a]) / (u[b] - u[a]), 0, 1)
        rows = a + np.flatnonzero((part >= _MIDDLE[0]) & (part <= _MIDDLE[1]))
        if rows.size > 1 and t[rows[-1]] > t[rows[0]]:
            rate = abs(u[rows[-1]] - u[rows[0]]) / (t[rows[-1]] - t[rows[0]])
            found.setdefault("heating" if u[b] > u[a] else "cooling", []).append(_S_PER_MIN * float(rate))
    return {way: float(np.median(rates)) for way, rates in found.items()}


def rate_trend(readings: Sequence[TemperatureAtRate]) -> RateTrend | None:
    """How temperatures go with the rate; None if they do not, or were read at one rate only."""
    names = [
        name
        for name in HEAT_TEMPERATURES
        if len(_different([r.rate for r in readings if r.name == name])) > 1
    ]
    lines = {name: _line([r for r in readings if r.name == name]) for name in names}
    rising = {np.sign(line.slope) * (1 if name.startswith("A") else -1) for name, line in lines.items()}
    both_ways = {name[0] for name in names} == {"A", "M"}
    if not both_ways or len(rising) != 1 or 0 in rising or not _is_clear(readings, lines):
        return None
    return RateTrend(tuple(r for r in readings if r.name in lines), lines)


def _shown(line: RateLine, unit: str, *, interval: bool) -> str:
    value = f"{to_uncertainty(line.at_zero, line.half)}{spaced(display_unit(unit))}"
    low, high = (to_uncertainty(line.at_zero + sign * line.half, line.half) for sign in (-1, 1))
    return f"{value} ({low} to {high})" if interval else value


def _different(rates: Sequence[float]) -> list[float]:
    """The mean of each group of rates that differ by more than a fifth."""
    groups: list[list[float]] = []
    for rate in sorted(rates):
        if groups and rate <= _OTHER_RATE * groups[-1][0]:
            groups[-1].append(rate)
        else:
            groups.append([rate])
    return [float(np.mean(group)) for group in groups]


def _line(readings: Sequence[TemperatureAtRate]) -> RateLine:
    rate, value, half = (np.array([getattr(r, key) for r in readings]) for key in ("rate", "value", "half"))
    x = rate - rate.mean()
    weights = x / (x @ x)
    slope = float(weights @ value)
    at_zero = 1 / rate.size - rate.mean() * weights
    residual = value - value.mean() - slope * x
    ends = [float(half.mean()), float(np.sqrt(np.sum((at_zero * half) ** 2))), _of_scatter(residual, at_zero)]
    return RateLine(slope, float(at_zero @ value), max(ends))


def _of_scatter(residual: Array, weights: Array) -> float:
    free = residual.size - 2
    if free < 1:
        return 0.0
    scatter = float(np.sqrt(residual @ residual / free))
    return scatter * float(np.sqrt(weights @ weights)) * float(stdtrit(free, 0.975))


def _is_clear(readings: Sequence[TemperatureAtRate], lines: Mapping[str, RateLine]) -> bool:
    """Whether the temperatures change over the rates by more than their intervals, on average."""
    change = np.mean([abs(line.slope) for line in lines.values()]) * np.ptp([r.rate for r in readings])
    return bool(change > 2 * np.mean([r.half for r in readings]))


def _runs(outcome: "FileOutcome") -> list[Run]:
    """The runs of a file, wherever its study was made."""
    folder = Path(outcome.folder) / "runs"
    return [load_run(folder / Path(path).name) for path in (outcome.found or {}).get("runs", ())]

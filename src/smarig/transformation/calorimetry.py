"""Transformation temperatures and latent heat from curves of heat flow over temperature (DSC), by ASTM F2004.

Heating to austenite takes up heat, cooling to martensite gives it off. So the peak of a heating branch is endothermic
and that of a cooling branch exothermic, whatever direction the instrument draws upwards.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.core import Array, UsageError
from smarig.measurement import input_noise_sd
from smarig.record import Run
from smarig.transformation.branch_tangents import LEAST_RISE
from smarig.transformation.cycle_figures import Drawn
from smarig.transformation.full_branches import HEATING, UnusedBranch, branch_rows, direction_of
from smarig.transformation.heat_flow_peak import HeatFlowPeak, heat_flow_peak
from smarig.transformation.rough_shape import monotone
from smarig.transformation.temperature_record import TemperatureRecord, temperature_record

UP, DOWN = "up", "down"
_NAMES = {  # of the figures of a peak, by direction
    "heating": {"low": "A_s", "peak": "A_p", "high": "A_f", "heat": "heating_heat"},
    "cooling": {"high": "M_s", "peak": "M_p", "low": "M_f", "heat": "cooling_heat"},
}
HEAT_TEMPERATURES = ("A_s", "A_p", "A_f", "M_s", "M_p", "M_f")
HEAT_FIGURES = (*HEAT_TEMPERATURES, "heating_heat", "cooling_heat")
_HEATS = {"W/g": "J/g", "mW/mg": "J/g", "mW": "mJ"}  # the unit of heat flow times seconds
_SLOW = 0.5  # of the rate at which half of the range is passed: slower readings belong to a hold
_MOST_READINGS = 4000  # of a branch: blocks of consecutive readings are averaged
_S_PER_MIN = 60.0
_BLOCKS, _FEWEST_BLOCKS = 100, 20  # of a branch, in which the beginning after a turn is looked for


@dataclass(frozen=True, eq=False)
class HeatFlowScan:
    """One heating or cooling branch: temperatures u and heat flows y (n,) as recorded, in order of rising u.

    ``sign`` turns its peak up. ``peak`` is None if none stands out, with the reason ``why_not``.
    """

    direction: str
    u: Array
    y: Array
    sign: float
    rate_K_per_s: float | None
    peak: HeatFlowPeak | None
    why_not: str

    @property
    def rate_K_per_min(self) -> float | None:
        """The rate of the temperature in K/min, None if no time is recorded."""
        return None if self.rate_K_per_s is None else _S_PER_MIN * self.rate_K_per_s


@dataclass(frozen=True, eq=False)
class CalorimetryCycle:
    """A heating and a cooling branch in a row, or one of them: figures with draws, and reasons of missing ones."""

    number: int
    scans: tuple[HeatFlowScan, ...]
    figures: dict[str, Drawn]
    why_not: dict[str, str]

    def scan(self, direction: str) -> HeatFlowScan | None:
        """Its branch of a direction."""
        return next((s for s in self.scans if s.direction == direction), None)


@dataclass(frozen=True, eq=False)
class Calorimetry:
    """The result of ``calorimetry``.

    ``exothermic`` is "up", "down", or "" if neither file nor peaks say it; ``stated``: the file says it. ``agrees``:
    all peaks point as the laws of heating and cooling want it. ``heat_unit`` is "" if the unit gives no heat.
    """

    cycles: tuple[CalorimetryCycle, ...]
    unused: tuple[UnusedBranch, ...]
    exothermic: str
    stated: bool
    agrees: bool
    unit: str
    input_unit: str
    heat_unit: str

    def unit_of(self, figure: str) -> str:
        """The unit of a figure."""
        return self.input_unit if figure in HEAT_TEMPERATURES else self.heat_unit

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {
            "exothermic": self.exothermic or None,
            "exothermic_stated": self.stated,
            "unit": self.unit,
            "cycles": [self._cycle_json(c) for c in self.cycles],
            "unused": [u.to_json() for u in self.unused],
        }

    def _cycle_json(self, cycle: CalorimetryCycle) -> dict[str, Any]:
        figures = {
            name: {"value": d.value, "ci95": list(d.ci95), "unit": self.unit_of(name)}
            for name, d in cycle.figures.items()
        }
        rates = {s.direction: s.rate_K_per_min for s in cycle.scans}
        return {"cycle": cycle.number, "figures": figures, "why_not": cycle.why_not, "rates_K_per_min": rates}


def calorimetry(runs: Sequence[Run], *, exothermic: str = "", mass_mg: float | None = None) -> Calorimetry:
    """A_s, A_p, A_f, M_s, M_p, M_f and the latent heat of each cycle of runs whose output is a heat flow.

    ``exothermic``: "up" or "down" if the file says it; else the peaks say it. With ``mass_mg`` a heat flow in mW gives
    J/g. Raises UsageError for a run without a temperature, or without a branch through its range of temperature.
    """
    record = _joined([temperature_record(run) for run in runs])
    rows, unused = branch_rows(record)
    bare = [scan for a, b in rows if (scan := _scan(record, a, b)) is not None]
    if not bare:
        raise UsageError(f"{runs[0].name} has no heating or cooling branch through its range of temperature.")
    votes = [_endothermic(scan) for scan in bare]
    endothermic = {UP: -1.0, DOWN: 1.0}.get(exothermic) or float(np.sign(np.sum(votes))) or 1.0
    scans = [_with_peak(scan, endothermic, seed) for seed, scan in enumerate(bare)]
    heat_unit = _HEATS.get(record.unit, "")
    scale = 1.0
    if heat_unit == "mJ" and mass_mg:
        heat_unit, scale = "J/g", 1.0 / mass_mg
    return Calorimetry(
        cycles=tuple(_cycle(k, own, heat_unit, scale) for k, own in enumerate(_in_cycles(scans), start=1)),
        unused=tuple(unused),
        exothermic=exothermic or (DOWN if endothermic > 0 else UP),
        stated=bool(exothermic),
        agrees=all(vote in (0.0, endothermic) for vote in votes),
        unit=record.unit,
        input_unit=record.input_unit,
        heat_unit=heat_unit,
    )


def _joined(records: Sequence[TemperatureRecord]) -> TemperatureRecord:
    """One record of several in a row: an instrument writes heating and cooling as two tables."""
    times = [r.t_s for r in records if r.t_s is not None]
    return replace(
        records[0],
        u=np.concatenate([r.u for r in records]),
        y=np.concatenate([r.y for r in records]),
        t_s=np.concatenate(times) if len(times) == len(records) else None,
    )


def _scan(record: TemperatureRecord, a: int, b: int) -> HeatFlowScan | None:
    """The readings of a branch while its temperature moves; None for a jump from one table to the next."""
    rows = slice(a + (a > 0), b + 1)  # the first one of a later branch is the last one of the branch before
    u, y = record.u[rows], record.y[rows]
    t = record.t_s[rows] if record.t_s is not None else None
    moving = _moving(u, t)
    u, y = u[moving], y[moving]
    t = t[moving] if t is not None else None
    settled = _settled(y)
    u, y = u[settled], y[settled]
    t = t[settled] if t is not None else None
    if u.size < 3:
        return None
    rate = float(abs(u[-1] - u[0]) / (t[-1] - t[0])) if t is not None and t[-1] > t[0] else None
    direction = direction_of(record.u, a, b)
    u, y = _averaged(u, y)
    if direction != HEATING:
        u, y = u[::-1], y[::-1]
    return HeatFlowScan(direction, monotone(u), y, 1.0, rate, None, "")


def _moving(u: Array, t: Array | None) -> slice:
    """The rows (n,) between the holds at both ends of a branch."""
    x = np.arange(u.size, dtype=float) if t is None else t
    width = max(1, u.size // 100)
    low, high = (np.clip(np.arange(u.size) + k, 0, u.size - 1) for k in (-width, width))
    span = x[high] - x[low]
    speed = np.abs(np.divide(u[high] - u[low], span, out=np.zeros(u.size), where=span > 0))
    order = np.argsort(speed)
    passed = np.cumsum(np.abs(np.gradient(u))[order]) if u.size > 1 else np.zeros(u.size)
    typical = speed[order][min(int(np.searchsorted(passed, passed[-1] / 2)), u.size - 1)]
    fast = np.flatnonzero(speed > _SLOW * typical)
    if not fast.size:
        return slice(0, 0)
    first, last = int(fast[0]), int(fast[-1])
    first += width if first > 0 else 0  # the differences reach into the hold
    last -= width if last < u.size - 1 else 0
    return slice(first, max(last + 1, first))


def _settled(y: Array) -> slice:
    """The rows of heat flows (n,) in order of time after the instrument has followed the turn of the temperature.

    Heat flow is proportional to the rate, so it changes its sign at a turn, and a sensor follows that with a lag.
    Blocks of readings go one way, ever more slowly, until their noise hides it; a quarter more of them is left out.
    """
    size = max(1, y.size // _BLOCKS)
    means = y[: y.size // size * size].reshape(-1, size).mean(axis=1)
    steps = np.diff(means)
    noise = input_noise_sd(y) * float(np.sqrt(2 / size))
    if steps.size < _FEWEST_BLOCKS or not abs(steps[0]) > LEAST_RISE * noise:
        return slice(0, y.size)
    along = steps * np.sign(steps[0])
    ends = int(np.argmax(along <= 2 * noise)) if (along <= 2 * noise).any() else 0
    decays = ends > 0 and bool(np.argmax(along[:ends]) <= 1)  # a flank gets steeper first
    return slice(size * (ends + 1 + ends // 4) if decays else 0, y.size)


def _averaged(u: Array, y: Array) -> tuple[Array, Array]:
    size = -(-u.size // _MOST_READINGS)
    starts = np.arange(0, u.size, size)
    counts = np.diff(np.append(starts, u.size))
    return np.add.reduceat(u, starts) / counts, np.add.reduceat(y, starts) / counts


def _endothermic(scan: HeatFlowScan) -> float:
    """The direction of endothermic heat flow that a branch shows: +1 up, −1 down; 0 if nothing stands out of its noise.

    It is that of the reading farthest from the line through both ends, of a heating branch; of a cooling branch, the
    other one.
    """
    far = scan.y - np.interp(scan.u, scan.u[[0, -1]], scan.y[[0, -1]])
    peak = float(far[np.argmax(np.abs(far))])
    if abs(peak) <= LEAST_RISE * input_noise_sd(scan.y):
        return 0.0
    return float(np.sign(peak)) * (1.0 if scan.direction == HEATING else -1.0)


def _with_peak(scan: HeatFlowScan, endothermic: float, seed: int) -> HeatFlowScan:
    sign = endothermic if scan.direction == HEATING else -endothermic
    try:
        peak = heat_flow_peak(scan.u, sign * scan.y, rate_K_per_s=scan.rate_K_per_s, seed=seed)
    except UsageError as error:
        return replace(scan, sign=sign, why_not=str(error))
    return replace(scan, sign=sign, peak=peak)


def _in_cycles(scans: Sequence[HeatFlowScan]) -> Iterator[tuple[HeatFlowScan, ...]]:
    """The branches in pairs: two that follow each other are one cycle if their directions differ."""
    waiting: list[HeatFlowScan] = []
    for scan in scans:
        if len(waiting) == 2 or (waiting and waiting[0].direction == scan.direction):
            yield tuple(waiting)
            waiting = []
        waiting.append(scan)
    if waiting:
        yield tuple(waiting)


def _cycle(number: int, scans: tuple[HeatFlowScan, ...], heat_unit: str, scale: float) -> CalorimetryCycle:
    figures: dict[str, Drawn] = {}
    why_not: dict[str, str] = {}
    for scan in scans:
        for key, name in _NAMES[scan.direction].items():
            found = scan.peak.figures.get(key) if scan.peak else None
            if found is None:
                why_not[name] = scan.peak.why_not[key] if scan.peak else scan.why_not
            elif key != "heat":
                figures[name] = found
            elif heat_unit:
                figures[name] = Drawn(scale * found.value, scale * found.draws)
            else:
                why_not[name] = "the unit of the heat flow gives no heat"
    missing = [d for d in _NAMES if not any(s.direction == d for s in scans)]
    why_not |= {name: f"the cycle has no {d} branch" for d in missing for name in _NAMES[d].values()}
    return CalorimetryCycle(number, scans, figures, why_not)

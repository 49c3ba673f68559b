"""The dependence of transformation temperatures on stress: the Clausius–Clapeyron coefficient C = dσ/dT.

Over the runs, T = T₀ + |σ|/C is fitted to each temperature, for tension and for compression by itself. The error of the
slope dT/dσ is the larger of two: that of the tangents (the choice of their readings is common to all runs, and mostly
cancels), and that of the scatter about the line, with Student's t. C is its inverse, and so is its interval. If the
interval of dT/dσ contains zero, the runs do not determine C.

Where runs state loads and no stress, as of a wire whose cross section is not known, the line is over the load.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit  # scipy.stats takes 50 MB and a second

from smarig.core import Array
from smarig.transformation.cycle_figures import TEMPERATURES
from smarig.transformation.run_figures import RunFigures

TENSION, COMPRESSION = "tension", "compression"
_SAME_SHARE = 0.02  # of the largest stress: smaller differences are one stress


@dataclass(frozen=True)
class StressSlope:
    """One temperature: dT/dσ in K/MPa, C = dσ/dT in MPa/K with 95 % intervals, T₀ at no stress, over n runs.

    ``C_ci95_MPa_per_K`` has None for an end that the runs do not determine. ``scatter_K`` is the rms deviation from
    the line, None for two runs.
    """

    temperature: str
    load: str
    dT_dstress_K_per_MPa: float
    dT_dstress_ci95_K_per_MPa: tuple[float, float]
    C_MPa_per_K: float | None
    C_ci95_MPa_per_K: tuple[float | None, float | None]
    at_zero: float
    stress_range_MPa: tuple[float, float]
    scatter_K: float | None
    n: int

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {
            "temperature": self.temperature,
            "load": self.load,
            "dT_dstress_K_per_MPa": self.dT_dstress_K_per_MPa,
            "dT_dstress_ci95_K_per_MPa": list(self.dT_dstress_ci95_K_per_MPa),
            "C_MPa_per_K": self.C_MPa_per_K,
            "C_ci95_MPa_per_K": list(self.C_ci95_MPa_per_K),
            "at_zero": self.at_zero,
            "stress_range_MPa": list(self.stress_range_MPa),
            "scatter_K": self.scatter_K,
            "n": self.n,
        }


@dataclass(frozen=True)
class LoadSlope:
    """One temperature over the load: its slope in K per ``unit`` with a 95 % interval, over n runs."""

    temperature: str
    K_per_unit: float
    ci95: tuple[float, float]
    unit: str
    load_range: tuple[float, float]
    n: int

    @property
    def is_determined(self) -> bool:
        """Whether the interval leaves out zero."""
        return self.ci95[0] * self.ci95[1] > 0

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {
            "temperature": self.temperature,
            "K_per_unit": self.K_per_unit,
            "ci95": list(self.ci95),
            "unit": self.unit,
            "load_range": list(self.load_range),
            "n": self.n,
        }


@dataclass(frozen=True)
class _Line:
    """A temperature over a stress or a load: slope, half of its 95 % interval, value at zero, scatter about it."""

    slope: float
    half: float
    at_zero: float
    scatter: float | None


def load_dependence(runs: Sequence[RunFigures]) -> tuple[LoadSlope, ...]:
    """The slopes over the load of all temperatures, of two runs or more that state different loads and no stress."""
    loads = {id(r): load for r in runs if (load := r.mean_of("load"))[0] is not None}
    units = {unit for _, unit in loads.values()}
    if any(r.stress_MPa is not None for r in runs) or len(units) != 1:
        return ()
    (unit,) = units
    found: list[LoadSlope] = []
    for name in TEMPERATURES:
        having = [r for r in runs if name in r.means and id(r) in loads]
        load = np.array([loads[id(r)][0] for r in having], dtype=float)
        if _differ(load):
            line = _line(name, load, having)
            ends = (line.slope - line.half, line.slope + line.half)
            extent = (float(load.min()), float(load.max()))
            found.append(LoadSlope(name, line.slope, ends, unit, extent, load.size))
    return tuple(found)


def _differ(values: Array) -> bool:
    return values.size >= 2 and bool(np.ptp(values) > _SAME_SHARE * np.abs(values).max())


def stress_dependence(runs: Sequence[RunFigures]) -> tuple[StressSlope, ...]:
    """The slopes of all temperatures that two runs or more with different stresses have; () without one."""
    found: list[StressSlope] = []
    for load in (TENSION, COMPRESSION):
        sign = 1.0 if load == TENSION else -1.0
        own = [r for r in runs if r.stress_MPa is not None and sign * r.stress_MPa >= 0]
        if load == COMPRESSION and not any((r.stress_MPa or 0.0) < 0 for r in own):
            continue
        for name in TEMPERATURES:
            having = [r for r in own if name in r.means]
            stress = np.array([abs(r.stress_MPa or 0.0) for r in having])
            if _differ(stress):
                found.append(_slope(name, load, stress, having))
    return tuple(found)


def _slope(name: str, load: str, stress: Array, runs: Sequence[RunFigures]) -> StressSlope:
    line = _line(name, stress, runs)
    ci95 = (line.slope - line.half, line.slope + line.half)
    return StressSlope(
        temperature=name,
        load=load,
        dT_dstress_K_per_MPa=line.slope,
        dT_dstress_ci95_K_per_MPa=ci95,
        C_MPa_per_K=1 / line.slope if ci95[0] * ci95[1] > 0 else None,
        C_ci95_MPa_per_K=(1 / ci95[1], 1 / ci95[0]) if ci95[0] * ci95[1] > 0 else (None, None),
        at_zero=line.at_zero,
        stress_range_MPa=(float(stress.min()), float(stress.max())),
        scatter_K=line.scatter,
        n=stress.size,
    )


def _line(name: str, over: Array, runs: Sequence[RunFigures]) -> _Line:
    """A temperature of runs as a line over a stress or a load (n,)."""
    values = np.array([r.means[name].value for r in runs])
    draws = np.stack([r.means[name].draws for r in runs])
    x = over - over.mean()
    weights = x / (x @ x)
    slope = float(weights @ values)
    residual = values - values.mean() - slope * x
    half = 1.96 * float(np.std(weights @ draws))
    scatter = None
    if values.size > 2:
        scatter = float(np.sqrt(residual @ residual / (values.size - 2)))
        expected = float(np.sqrt(np.mean(draws.var(axis=1))))
        if scatter > expected:
            half = max(half, scatter / float(np.sqrt(x @ x)) * float(stdtrit(values.size - 2, 0.975)))
    return _Line(slope, half, float(values.mean() - slope * over.mean()), scatter)

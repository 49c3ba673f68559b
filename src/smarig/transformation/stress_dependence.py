"""The dependence of transformation temperatures on stress: the Clausius–Clapeyron coefficient C = dσ/dT.

Over the runs, T = T₀ + |σ|/C is fitted to each temperature, for tension and for compression by itself. The error of the
slope dT/dσ is the larger of two: that of the tangents (the choice of their readings is common to all runs, and mostly
cancels), and that of the scatter about the line, with Student's t. C is its inverse, and so is its interval. If the
interval of dT/dσ contains zero, the runs do not determine C.
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
            if stress.size >= 2 and np.ptp(stress) > _SAME_SHARE * stress.max():
                found.append(_slope(name, load, stress, having))
    return tuple(found)


def _slope(name: str, load: str, stress: Array, runs: Sequence[RunFigures]) -> StressSlope:
    values = np.array([r.means[name].value for r in runs])
    draws = np.stack([r.means[name].draws for r in runs])
    x = stress - stress.mean()
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
    ci95 = (slope - half, slope + half)
    return StressSlope(
        temperature=name,
        load=load,
        dT_dstress_K_per_MPa=slope,
        dT_dstress_ci95_K_per_MPa=ci95,
        C_MPa_per_K=1 / slope if ci95[0] * ci95[1] > 0 else None,
        C_ci95_MPa_per_K=(1 / ci95[1], 1 / ci95[0]) if ci95[0] * ci95[1] > 0 else (None, None),
        at_zero=float(values.mean() - slope * stress.mean()),
        stress_range_MPa=(float(stress.min()), float(stress.max())),
        scatter_K=scatter,
        n=values.size,
    )

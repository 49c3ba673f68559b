"""The drift of figures from cycle to cycle: the slope of a line over the cycles, with a 95 % interval.

The interval is Student's, from the scatter about the line; neighbours that are correlated count as fewer cycles. Where
the change over all cycles has an interval of more than twice the range of the figures, no drift is given.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import stdtrit  # scipy.stats takes 50 MB and a second

from smarig.identification import Estimate, variance_inflation
from smarig.transformation.cycle_figures import NAMES, Drawn

_FEWEST = 3
_WIDEST = 2.0  # times the range of the figures: a wider change over all cycles is not determined


def cycle_drift(
    numbers: Sequence[int], cycles: Sequence[Mapping[str, Drawn]], units: Mapping[str, str]
) -> tuple[dict[str, Estimate], str]:
    """The slope per cycle of each figure that three cycles or more have, and which figures scatter too much for it."""
    found: dict[str, Estimate] = {}
    scattered: list[str] = []
    for name, unit in units.items():
        own = [(k, c[name].value) for k, c in zip(numbers, cycles) if name in c]
        if len(own) >= _FEWEST:
            x, y = np.array(own, dtype=float).T
            slope = _slope(x - x.mean(), y, f"{unit}/cycle")
            half = (slope.ci95[1] - slope.ci95[0]) / 2
            if half * float(np.ptp(x)) > _WIDEST * float(np.ptp(y)):
                scattered.append(name)
            else:
                found[name] = slope
    names = ", ".join(NAMES.get(name, name) for name in scattered)
    return found, f"the cycles scatter too much to determine a drift of {names}" if scattered else ""


def _slope(x: np.ndarray, y: np.ndarray, unit: str) -> Estimate:
    slope = float(x @ y / (x @ x))
    residual = y - y.mean() - slope * x
    degrees = x.size - 2
    inflation = variance_inflation([residual]) if x.size >= 8 else 1.0
    effective = max(x.size / inflation - 2, 1.0)
    error = float(np.sqrt(residual @ residual / degrees * inflation / (x @ x)))
    half = error * float(stdtrit(min(degrees, effective), 0.975))
    return Estimate(slope, (slope - half, slope + half), unit, "line over the cycles", x.size)

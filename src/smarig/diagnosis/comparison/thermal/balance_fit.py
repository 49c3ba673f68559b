"""The plain parameters of a heat balance at given values of its effects, and the slopes of the trace with them.

The fit is least squares of the readings. It is only where the trace is made linear: how the plain parameters move when
a block is left out is the matter of their covariance.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.thermal.heat_balance import HeatBalance
from smarig.diagnosis.comparison.thermal.thermal_record import ThermalRecord

PLAIN = ("start", "offset", "gain", "tau")
LEVELS = (-100.0, 400.0)  # bounds of start and offset, °C
MOST_STEPS = 40
STARTS = (0.1, 0.5, 0.8)  # quantiles of the values that are tried


@dataclass(frozen=True, eq=False)
class FittedBalance:
    """A balance with its errors (n,) in kelvin, and the slopes (n, 4) of the trace with the plain parameters."""

    balance: HeatBalance
    error: Array
    slopes: Array

    @property
    def rms(self) -> float:
        """Of the errors, kelvin."""
        return root_mean_square(self.error)


def fit_balance(
    x: ThermalRecord, values: Mapping[str, float], near: HeatBalance | None = None
) -> FittedBalance:
    """The balance with ``values`` of its effects; ``near`` is where the search begins."""
    return _fitted(x, replace(near or _linear_balance(x), **values), {})


def fit_with_effect(x: ThermalRecord, near: HeatBalance, tries: Mapping[str, Sequence[float]]) -> HeatBalance:
    """The balance with the parameters of an effect fitted as well, between the ends of ``tries``, from three starts."""
    bounds = {name: (min(options), max(options)) for name, options in tries.items()}
    starts = [{name: float(np.quantile(o, q)) for name, o in tries.items()} for q in STARTS]
    return min((_fitted(x, replace(near, **s), bounds) for s in starts), key=lambda f: f.rms).balance


def _fitted(x: ThermalRecord, first: HeatBalance, bounds: Mapping[str, tuple[float, float]]) -> FittedBalance:
    from scipy.optimize import least_squares  # imported here: takes most of a second

    free = (*PLAIN, *bounds)
    ends = [LEVELS, LEVELS, (0.0, 1e6), (x.step, 20 * x.length), *bounds.values()]
    low, high = (np.array([e[k] for e in ends]) for k in (0, 1))
    margin = 1e-6 * np.minimum(high - low, 1.0)
    begin = np.clip([getattr(first, q) for q in free], low + margin, high - margin)

    def error(v: Array) -> Array:
        balance = replace(first, **dict(zip(free, v.tolist())))
        return x.temperature - balance.predicted_temperature(x)

    scale = np.r_[1.0, 1.0, np.maximum(np.abs(begin[2:4]), 1e-9), (high - low)[4:] / 10]
    found = least_squares(error, begin, bounds=(low, high), x_scale=scale, ftol=1e-7, max_nfev=MOST_STEPS)
    balance = replace(first, **dict(zip(free, found.x.tolist())))
    return FittedBalance(balance, found.fun, -found.jac[:, : len(PLAIN)])


def _linear_balance(x: ThermalRecord) -> HeatBalance:
    """A plain balance by finite differences, where the search begins."""
    columns = np.column_stack([x.bin_drive, x.bin_room - x.temperature, np.ones(x.t.size)])
    heating = np.gradient(x.temperature, x.dt)
    gain, rate, constant = np.linalg.lstsq(columns, heating, rcond=None)[0].tolist()
    rate = min(max(rate, 0.2 / x.length), 0.5 / x.dt)
    return HeatBalance(float(x.temperature[0]), constant / rate, max(gain, 1e-12), 1 / rate)

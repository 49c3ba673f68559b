"""The plain parameters of a heat balance at given values of its effects, and the slopes of the trace with them.

The fit is least squares of the readings. It is only where the trace is made linear: how the plain parameters move when
a block is left out is the matter of their covariance.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.comparison.thermal.heat_balance import HeatBalance
from smarig.diagnosis.comparison.thermal.thermal_record import FINE, ThermalRecord

Array = NDArray[np.float64]
PLAIN = ("start", "offset", "gain", "tau")
LEVELS = (-100.0, 400.0)  # bounds of start and offset, °C
MOST_STEPS = 40


@dataclass(frozen=True, eq=False)
class FittedBalance:
    """A balance with its errors (n,) in kelvin, and the slopes (n, 4) of the trace with the plain parameters."""

    balance: HeatBalance
    error: Array
    slopes: Array

    @property
    def rms(self) -> float:
        """Of the errors, kelvin."""
        return float(np.sqrt(np.mean(self.error**2)))

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviations of the plain parameters, for independent errors of this size."""
        covariance = np.linalg.pinv(self.slopes.T @ self.slopes)
        return dict(zip(PLAIN, (self.rms * np.sqrt(np.maximum(np.diag(covariance), 0.0))).tolist()))


def fit_balance(
    x: ThermalRecord, values: Mapping[str, float], near: HeatBalance | None = None
) -> FittedBalance:
    """The balance with ``values`` of its effects; ``near`` is where the search begins."""
    from scipy.optimize import least_squares  # imported here: takes most of a second

    first = replace(near or _linear_balance(x), **values)
    low = np.array([LEVELS[0], LEVELS[0], 0.0, x.step])
    high = np.array([LEVELS[1], LEVELS[1], 1e6, 20 * x.length])
    begin = np.clip([asdict(first)[q] for q in PLAIN], low + 1e-9, high - 1e-9)

    def error(v: Array) -> Array:
        balance = replace(first, **dict(zip(PLAIN, v.tolist())))
        return x.temperature - balance.predicted_temperature(x)

    scale = np.r_[1.0, 1.0, np.maximum(np.abs(begin[2:]), 1e-9)]
    found = least_squares(error, begin, bounds=(low, high), x_scale=scale, ftol=1e-7, max_nfev=MOST_STEPS)
    balance = replace(first, **dict(zip(PLAIN, found.x.tolist())))
    return FittedBalance(balance, found.fun, -found.jac)


def _linear_balance(x: ThermalRecord) -> HeatBalance:
    """A plain balance by finite differences, where the search begins."""
    drive = x.drive[1:].reshape(-1, FINE).mean(axis=1)
    excess = (x.temperature - x.room[::FINE])[:-1]
    columns = np.column_stack([drive, -excess, np.ones(drive.size)])
    gain, rate, constant = np.linalg.lstsq(columns, np.diff(x.temperature) / x.dt, rcond=None)[0].tolist()
    rate = min(max(rate, 0.2 / x.length), 0.5 / x.dt)
    return HeatBalance(float(x.temperature[0]), constant / rate, max(gain, 1e-12), 1 / rate)

"""The rates of sweeps: whether the same inputs were passed at clearly different rates in one direction."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.sweeps.sweep_record import SweepRecord

LEVELS = 12  # inputs at which rates are compared
_MARGIN = 0.1  # of the range: no level is closer to its ends
_WINDOW = 0.02  # of the range: the rate at a level is the mean over this width


def rate_ratio(records: Sequence[SweepRecord]) -> float:
    """The largest over the smallest rate at which sweeps of one direction pass the same input; median over inputs.

    1 for sweeps at one rate, and if no input was passed twice. A sweep that only the wire's own cooling drives passes
    an input at the same rate as any other such sweep, so it does not count as a second rate.
    """
    ratios = []
    for rising in (True, False):
        rates = [_rates(r, rows, rising) for r in records for rows in _sweeps(r)]
        table = np.array([row for row in rates if np.isfinite(row).any()]).reshape(-1, LEVELS)
        several = np.sum(np.isfinite(table), axis=0) >= 2
        if several.any():
            passed = table[:, several]
            ratios.append(float(np.median(np.nanmax(passed, axis=0) / np.nanmin(passed, axis=0))))
    return max(ratios, default=1.0)


def _sweeps(record: SweepRecord) -> list[NDArray[np.intp]]:
    edges = np.flatnonzero(np.diff(record.sweep)) + 1
    return np.split(np.arange(record.sweep.size), edges)


def _rates(record: SweepRecord, rows: NDArray[np.intp], rising: bool) -> Array:
    """|du/dt| at each level (LEVELS,) of one sweep, NaN where it does not pass in this direction."""
    u, t = record.inputs_K(record.actuator.tau_s)[rows], np.cumsum(record.dt_s[rows])
    found = np.full(LEVELS, np.nan)
    if not rising:
        u = -u
    if u.size < 3 or u[-1] <= u[0]:
        return found
    u = np.maximum.accumulate(u) + 1e-9 * np.arange(u.size)
    share = np.linspace(_MARGIN, 1 - _MARGIN, LEVELS)
    levels = record.lower + share * record.span_K
    low, high = ((levels if rising else -levels) + side * _WINDOW * record.span_K / 2 for side in (-1, 1))
    inside = (low > u[0]) & (high < u[-1])
    seconds = np.interp(high, u, t) - np.interp(low, u, t)
    found[inside] = (high - low)[inside] / seconds[inside]
    return found

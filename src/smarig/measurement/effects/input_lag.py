"""The recorded input lags the one that acts, as of a glued thermocouple.

    v(t) = s(t) + τ ds/dt,    s: the record smoothed over τ/4, which the differentiation needs

τ is the time constant of a first-order lag.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.measurement.input_record import InputRecord, input_noise_sd
from smarig.measurement.lag_search import lags_to_try
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

Array = NDArray[np.float64]
SMOOTHED_SHARE = 0.25  # of the lag: standard deviation of the smoothing


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    tries = lags_to_try(records)
    return None if tries is None else (SearchedParameter("lag_s", "s", tries),)


def _change(p: Values, record: InputRecord) -> RecordChange:
    lag_s, none = p["lag_s"], RecordChange.none(record)
    if not lag_s:
        return none
    period = float(np.median(np.diff(record.t)))
    grid = np.arange(record.t[0], record.t[-1] + period / 2, period)  # rows that are missing are interpolated
    smooth = _smoothed(np.interp(grid, record.t, record.u), SMOOTHED_SHARE * lag_s / period)
    u = np.interp(record.t, grid, smooth + lag_s * np.gradient(smooth, period))
    return RecordChange(u, none.terms, _noise(record.u, lag_s / period))


def _noise(u: Array, lag_rows: float) -> float:
    """Standard deviation of v for white noise of u: that of the Gaussian's and of its derivative's weights."""
    sd_rows = max(SMOOTHED_SHARE * lag_rows, 0.3)
    square = 1 / (2 * np.sqrt(np.pi) * sd_rows) + lag_rows**2 / (4 * np.sqrt(np.pi) * sd_rows**3)
    return input_noise_sd(u) * float(np.sqrt(square))


def _smoothed(u: Array, sd_rows: float) -> Array:
    """Gaussian smoothing of evenly spaced values; the ends are continued by their point reflection."""
    half = int(np.ceil(4 * sd_rows))
    if half < 1 or u.size < 3:
        return u
    half = min(half, u.size - 1)
    weight = np.exp(-0.5 * (np.arange(-half, half + 1) / max(sd_rows, 1e-9)) ** 2)
    padded = np.concatenate([2 * u[0] - u[half:0:-1], u, 2 * u[-1] - u[-2 : -half - 2 : -1]])
    return np.asarray(np.convolve(padded, weight / weight.sum(), "valid"), dtype=float)


input_lag = MeasurementEffectType(
    name="input_lag",
    summary="The recorded input lags the one that acts: a sensor with a time constant.",
    looks_like="loops are too wide or turn the wrong way, the more the faster the input changes",
    confused_with=("sensor_lag",),
    separated_by="a slower run, or a second sensor of the input",
    depends_on=("rate", "history"),
    parameters=_parameters,
    change=_change,
)

"""The recorded input lags the one that acts, as of a glued thermocouple.

    v(t) = s(t) + τ ds/dt,    s: the record smoothed over τ/4, which the differentiation needs

τ is the time constant of a first-order lag, in rows where no clock was recorded: then the rows must be equally spaced.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from smarig.core import Array
from smarig.measurement.input_record import InputRecord, input_noise_sd, reversals
from smarig.measurement.loop_direction import width_of_leading_loops
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

SMOOTHED_SHARE = 0.25  # of the lag: standard deviation of the smoothing
MAX_CYCLE_SHARE = 0.25  # of a cycle: a longer lag is no lag
LAGS_PER_DECADE = 5
PARTS = 8  # of a branch, whose rates are compared
RATE_RATIO = 1.5  # of the fast to the slow tenth of the parts: less is one rate


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """Lags from two rows to a quarter of the median cycle; None if rows are uneven, if some runs have a clock and some
    have none, or if the rate does not change. Without a clock, rows may be uneven in time: then a lag is only offered
    where the output leads its input, as no hysteresis does. A lag after which the output still leads is none: columns
    that were exchanged look alike.

    At one rate a lag is a shift of each branch, which any measure contains.
    """
    clocks = {r.clock for r in records}
    if len(clocks) > 1 or not all(_even(r.t) for r in records) or _one_rate(records):
        return None
    if clocks == {False} and not any(_leads(r, RecordChange.none(r)) for r in records):
        return None
    period = max(float(np.median(np.diff(r.t))) for r in records)
    cycle_s = float(np.median([np.ptp(r.t) / max(r.cycle[-1] - r.cycle[0], 0.5) for r in records]))
    low, high = np.log10(2 * period), np.log10(MAX_CYCLE_SHARE * cycle_s)
    if high <= low:
        return None
    tries = np.logspace(low, high, max(int(LAGS_PER_DECADE * (high - low)), 4))
    name, unit = ("lag_s", "s") if clocks == {True} else ("lag_rows", "rows")
    undone = [lag for lag in tries.tolist() if not any(_leads(r, _change({name: lag}, r)) for r in records)]
    return (SearchedParameter(name, unit, tuple(undone)),) if undone else None


def _leads(record: InputRecord, change: RecordChange) -> bool:
    """Whether the output leads the changed input."""
    turns = reversals(change.input, change.noise)
    return width_of_leading_loops(change.input, record.y, turns) is not None


def _one_rate(records: Sequence[InputRecord]) -> bool:
    """Whether the input changes at one rate throughout, but for its turns."""
    rates = []
    for record in records:
        for begin, end in pairwise(reversals(record.u)):
            at = np.unique(np.linspace(begin, end, PARTS + 1).round().astype(int))
            rates += (np.abs(np.diff(record.u[at])) / np.maximum(np.diff(record.t[at]), 1e-12)).tolist()
    slow, fast = np.quantile(rates, [0.1, 0.9])
    return bool(fast < RATE_RATIO * slow)


def _even(t: Array) -> bool:
    step = np.diff(t)
    return bool(np.all(step > 0)) and float(np.quantile(step, 0.95)) < 1.5 * float(np.median(step))


def _change(p: Values, record: InputRecord) -> RecordChange:
    none, period = RecordChange.none(record), float(np.median(np.diff(record.t)))
    lag_s = p["lag_s"] if "lag_s" in p else p["lag_rows"] * period  # without a clock, a second is a row
    if not lag_s:
        return none
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
    bounds={"lag_s": (0.0, 1e7), "lag_rows": (0.0, 1e7)},
)

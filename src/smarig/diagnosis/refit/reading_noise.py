"""The noise of each reading by itself: instrument noise, zeros shared with other readings, and scale.

Positions of one session share a zero. A resistance has its own zero and scale. Other channels are independent.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.diagnosis.drive_statistics import DriveStatistics, raw_noise, reading_scatter
from smarig.diagnosis.refit.quantization import noise_before_rounding, quantization_traces
from smarig.replay import PlantModel, Prediction, ReadingSeries, Timeline

FREE_ZERO_SD = 30.0  # sd of a zero, in ranges of the output: practically free
EFFECT_ERROR_SHARE = 0.01  # of what effects change that no density would: their equations are approximations
UNOBSERVED_SHARE = 0.03  # of the stroke: travel beyond the farthest hold, which a resistance shows


def reading_scales(
    timeline: Timeline,
    prediction: Prediction,
    plant_model: PlantModel,
    coupled: list[ReadingSeries],
    output_rate: Array,
    effect_contribution: Array,
) -> tuple[Array, Array, Array, Array]:
    """Per coupled reading: white noise (scaled), covariance of free zeros, scale, and slope to y (scaled)."""
    raw, span = raw_noise(timeline, plant_model), plant_model.stroke  # negative if the output falls
    timing_noise = DriveStatistics(timeline).timing_noise(prediction, output_rate)
    white, scale, zero, at = [], [], [], 0
    for k, r in enumerate(coupled):
        y = r.value - prediction.values[r.kind]
        known_noise = {"settled": 0.0, "moving": raw}.get(r.kind)
        noise = 0.0 if known_noise is None else known_noise
        scale.append(
            _resistance_noise(y, timeline.target_K[r.step])
            if known_noise is None
            else np.full(len(r), abs(span))
        )
        effect_error = EFFECT_ERROR_SHARE * np.abs(effect_contribution[at : at + len(r)])
        white.append(
            np.full(len(r), 1.0)
            if known_noise is None
            else np.sqrt(noise**2 + timing_noise[at : at + len(r)] ** 2 + effect_error**2) / abs(span)
        )
        at += len(r)
        session_zero = timeline.zero[r.step] if timeline.zero.size else np.zeros(len(r), dtype=np.int64)
        zero.append(np.full(len(r), -1 - k) if known_noise is None else session_zero)
    own_zero, scales = np.concatenate(zero), np.concatenate(scale)
    same = own_zero[:, None] == own_zero[None, :]
    # a constant in ohms (leads, contacts): one in units of the noise would be a voltage, and hide a missing current
    size = np.where(
        own_zero >= 0, FREE_ZERO_SD, _FREE_BLOCK_ZERO_SD * _constant_in_own_unit(own_zero, scales)
    )
    slope = prediction.output_slope * span / scales
    free = np.where(same, np.outer(size, size), 0.0)
    unobserved = np.where(
        own_zero >= 0,
        0.0,
        UNOBSERVED_SHARE * slope * (prediction.output - plant_model.hysteresis.y_lower) / span,
    )
    return np.concatenate(white), free + np.outer(unobserved, unobserved), scales, slope


def _constant_in_own_unit(block: NDArray[np.int64], scales: Array) -> Array:
    """A constant of each block in the readings' unit, divided by their scales (n,); typically 1."""
    typical = np.ones(scales.size)
    for one in np.unique(block):
        typical[block == one] = np.median(scales[block == one])
    return typical / scales


def encoder_error_traces(timeline: Timeline, plant_model: PlantModel, coupled: list[ReadingSeries]) -> Array:
    """Traces (n, q) of the encoder's error at settled positions, in the readings' unit, of strengths ~ N(0, 1)."""
    count = plant_model.per_count
    n = sum(len(r) for r in coupled)
    scatter = reading_scatter(timeline)
    if not count or not scatter:
        return np.empty((n, 0))
    traces = quantization_traces(timeline.settled.value / count, noise_before_rounding(scatter / count))
    return np.concatenate([traces * count, np.zeros((n - len(timeline.settled), traces.shape[1]))])


def _resistance_noise(y: Array, target_K: Array) -> Array:
    """Standard deviation (n,) of resistances V/i, from residuals (n,): that of the voltage over the current.

    The steady temperature is proportional to i², so its root is the current in relative units. The constant of leads
    is taken off first: times a current that steps, it would count as noise.
    """
    current = np.sqrt(np.maximum(np.abs(target_K), 1e-12))
    current = np.maximum(current / float(np.median(current)), MIN_CURRENT_SHARE)
    return np.maximum(_local_noise((y - np.median(y)) * current) / current, _MIN_NOISE["resistance"])


def output_rate(prediction: Prediction, plant_model: PlantModel) -> Array:
    """Output per second at each coupled reading, over the preceding tick."""
    at, before = prediction.tick_index, np.maximum(prediction.tick_index - 1, 0)
    y = prediction.outputs_at(plant_model.hysteresis, plant_model.initial, np.append(at, before))
    return np.abs(y[: at.size] - y[at.size :]) / np.maximum(prediction.t_s[at] - prediction.t_s[before], 1e-9)


MIN_CURRENT_SHARE = 0.05  # of the median current: smaller currents give no better known resistance
OUTLIER_SD = 4.0  # robust sds: larger second differences are jumps, not noise
_MIN_NOISE = {"resistance": 5e-4, "current": 5e-5, "room": 0.005}  # ohm, A, K: best instruments
_FREE_BLOCK_ZERO_SD = 1e3  # sd of a block's own zero, in noise sds: practically free, and safe from rounding


def independent_block(
    readings: ReadingSeries, timeline: Timeline, prediction: Prediction
) -> tuple[Array, Array, Array]:
    """An independent block: white noise from the residuals of a smooth curve; free constants except for currents."""
    y = readings.value - prediction.values[readings.kind]
    noise = max(_local_noise(y), _MIN_NOISE[readings.kind])
    if readings.kind == "current":
        return np.eye(y.size), np.full(y.size, noise), y
    session = timeline.session[readings.step]
    same = np.where(session[:, None] == session, _FREE_BLOCK_ZERO_SD**2, 0.0)
    return same + np.eye(y.size), np.full(y.size, noise), y - session_means(y, readings, timeline)


def session_means(y: Array, readings: ReadingSeries, timeline: Timeline) -> Array:
    """The mean (n,) over each session."""
    session = timeline.session[readings.step]
    return (np.bincount(session, y) / np.maximum(np.bincount(session), 1))[session]


def _local_noise(y: Array) -> float:
    """Standard deviation of white noise from second differences of neighbours, without the outliers among them."""
    second_differences = np.abs(y[:-2] - 2 * y[1:-1] + y[2:])
    robust = float(np.median(second_differences)) / 0.6745
    usual = second_differences[second_differences <= OUTLIER_SD * robust]
    noise = root_mean_square(usual) if usual.size else robust
    return max(noise / np.sqrt(6.0), 1e-9 * max(float(np.abs(y).max()), 1e-9))

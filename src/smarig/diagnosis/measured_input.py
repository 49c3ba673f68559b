"""Where the input itself was measured: which plain variables may matter, and how noisy such data may be.

A rate changes how high and how wide a loop is, so its traces are smooth functions of log |du/dt| times: 1, the
output, the slope (felt), and the slope with the sign of du/dt (a wider loop). Knows no effect by name.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from smarig.preisach.sensitivity import sensitivities
from smarig.replay.measured_input_timeline import input_noise_sd
from smarig.replay.plant_model import PlantModel
from smarig.replay.prediction import Prediction
from smarig.replay.timeline import Timeline

Array = NDArray[np.float64]
MIN_RATE_RATIO = 1.5  # rates that differ less, as a factor, are one rate
MIN_NOISE_SHARE, ALWAYS_ALLOWED_SHARE = (
    1e-5,
    3e-3,
)  # of a range: sd of a noise at least, and what it may be however smooth the record is
MIN_SD_SHARE = 0.01  # of the stroke: a density is fitted to nothing more firmly than that
MAX_SCATTER_RATIO = 3.0  # times the scatter that a record shows: nothing larger is noise
CORRELATION_READINGS = (0.5, 5.0, 50.0)  # readings over which input noise keeps


def noise_bounds(
    timeline: Timeline, span: float, stroke: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Least and most of s₀ (strokes) and s_T (input units): what a record's own scatter allows.

    ``span``, ``stroke``: input and output range of the hysteresis.
    """
    outputs = [run["position"][np.isfinite(run["position"])] for run in timeline.runs]
    y = MAX_SCATTER_RATIO * max(input_noise_sd(v) for v in outputs) / stroke
    u = MAX_SCATTER_RATIO * float(np.sqrt(np.mean(timeline.input_scatter**2))) / span
    return (MIN_NOISE_SHARE, max(y, ALWAYS_ALLOWED_SHARE)), (
        MIN_NOISE_SHARE * span,
        max(u, ALWAYS_ALLOWED_SHARE) * span,
    )


def input_scatter(timeline: Timeline, prediction: Prediction, plant_model: PlantModel) -> Array:
    """What the input's own scatter does to each reading, by the local slope, output units (n,)."""
    slope = [s[-1] for s in sensitivities(plant_model.hysteresis, prediction.states)]
    return np.abs(np.array(slope)) * timeline.input_scatter


def reading_weights(timeline: Timeline, prediction: Prediction, plant_model: PlantModel) -> Array:
    """Weights (n,) of readings in a fit of the density, 1/σ, the best known at 1; equal ones for zeros apart."""
    if np.ptp(timeline.zero) > 0:
        return np.ones(timeline.zero.size)
    sigma = np.hypot(input_scatter(timeline, prediction, plant_model), MIN_SD_SHARE * plant_model.stroke)
    return sigma.min() / sigma


def correlations_s(timeline: Timeline) -> tuple[float, ...]:
    """Correlation times worth trying, on the story's own clock."""
    spacing_s = float(np.median(np.diff(timeline.settled.t_s)))
    return tuple(k * spacing_s for k in CORRELATION_READINGS)


def plain_variables(timeline: Timeline, base: Prediction) -> dict[str, Array]:
    """Variables (n,) of each reading; time only where there is a clock."""
    reversal_count = np.concatenate([[0], np.cumsum(np.diff(timeline.block) != 0)])
    travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
    time_variable = {"time": timeline.settled.t_s} if timeline.measured_input == "clock" else {}
    return time_variable | {
        "cycle": travel,
        "level": base.values["settled"],
        "history": timeline.last_reversal,
        "reversals": reversal_count.astype(float),
    }


def rate_traces(
    timeline: Timeline, base: Prediction, output_change: float, input_change: Array
) -> Iterator[tuple[str, Array]]:
    """("rate", raw traces (n, 8)) where runs of a clock differ in their rate, else nothing.

    ``output_change`` is an output, ``input_change`` (n,) what an input adds, as large as may be expected.
    """
    z = np.log(np.maximum(timeline.speed, 1e-12))
    if timeline.measured_input != "clock" or np.ptp(z) < np.log(MIN_RATE_RATIO):
        return
    scaled_log_rate = 2 * (z - z.min()) / np.ptp(z) - 1
    y = base.values["settled"]
    level = (y - y.mean()) / (np.std(y) or 1.0)
    direction = np.sign(np.diff(timeline.target_K, prepend=timeline.target_K[0]))
    shapes = (np.full(z.size, output_change), output_change * level, input_change, input_change * direction)
    waves = (scaled_log_rate, (3 * scaled_log_rate**2 - 1) / 2)
    yield "rate", np.column_stack([w * s for w in waves for s in shapes])

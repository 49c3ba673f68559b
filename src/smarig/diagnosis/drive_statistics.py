"""Statistics of a diagnosis that depend on the kind of drive: variables, noise, and how a density is identified.

Under a commanded current, readings follow heating, holds and steps; the noise is that of settled windows. Along a
measured input, readings follow the branches of the input. A rate then changes the height and the width of a loop.
Its traces are smooth functions of log |du/dt| times 1, the output, the slope ∂y/∂u, and the slope with the sign of
du/dt.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import lru_cache
from typing import ClassVar, final

import numpy as np
from numpy.typing import NDArray

from smarig.measurement import input_noise_sd
from smarig.preisach import sensitivities
from smarig.replay import MeasuredInput, PlantModel, Prediction, ReadingSeries, Timeline

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Bounds = tuple[float, float]
JITTER_S = 0.02  # uncertainty of a time stamp
CORRELATIONS_S = (120.0, 30.0, 300.0)
MAX_FLUCTUATION_K = 0.4  # of the ambient temperature
MIN_FLUCTUATION_K = 10**-2.5
MIN_COUNT_SD = 0.1  # counts: the best that an encoder's marks allow
MAX_COUNT_SD = 0.6  # counts: the worst mean of settled samples that do not scatter
MIN_RATE_RATIO = 1.5  # rates that differ by a smaller factor count as one
MIN_NOISE_SHARE, ALWAYS_ALLOWED_SHARE = (
    1e-5,
    3e-3,
)  # of a range: least sd of a noise, and the sd allowed however smooth the record is
MIN_SD_SHARE = 0.01  # of the stroke: least sd of a reading in a fit of the density
MAX_SCATTER_RATIO = 3.0  # times the scatter of the record: a larger deviation is not noise
CORRELATION_READINGS = (0.5, 5.0, 50.0)  # correlation lengths of input noise, in readings


class DriveStatistics(ABC):
    """Variables and noise of a timeline's readings, by the kind of its drive.

    ``positive_measure_only``: a density is identified only as a smooth positive measure, and stays as identified.
    """

    positive_measure_only: ClassVar[bool]

    def __init__(self, timeline: Timeline) -> None:
        self.timeline = timeline

    @abstractmethod
    def correlations_s(self) -> tuple[float, ...]:
        """Correlation times to try for remembered noise, on the timeline's own clock."""

    @abstractmethod
    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """Lower and upper bounds of s₀ (strokes) and of s_T (input units)."""

    @abstractmethod
    def input_scatter(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """Standard deviation (n,) in output units that the scatter of a measured input adds to each position."""

    @abstractmethod
    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:
        """Standard deviation (coupled,) in output units due to the uncertain time or input of each coupled reading.

        ``output_rate`` (coupled,) is the output per second there.
        """

    @abstractmethod
    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """Weights (k,) of settled readings in a fit of the density: 1/σ, scaled to at most 1."""

    @abstractmethod
    def variables(self, base: Prediction) -> dict[str, Array]:
        """Plain variables (n,) of each position, by name. An error may depend on them."""

    @abstractmethod
    def rate_traces(
        self, base: Prediction, output_change: float, input_change: Array
    ) -> Iterator[tuple[str, Array]]:
        """(name, raw traces (n, m)) of a dependence on the rate, in addition to the plain variables.

        ``output_change`` is the expected size of a change of output, ``input_change`` (n,) the effect of an
        expected change of input.
        """

    @abstractmethod
    def rate_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str, bool]:
        """Values (n,) of the variable "rate" at readings, its label, and whether its axis is logarithmic."""

    @abstractmethod
    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:
        """Values (n,) of the variable "history" at readings, and its label."""

    @abstractmethod
    def residual_zeros(self, readings: ReadingSeries) -> Integers:
        """Indices (n,) of the zeros that are removed from residuals."""


@final
class CurrentStatistics(DriveStatistics):
    """Readings under commanded currents."""

    positive_measure_only = False

    def correlations_s(self) -> tuple[float, ...]:
        """The correlation times of ambient fluctuations."""
        return CORRELATIONS_S

    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """Bounds from the number of samples of a mean and from the largest plausible ambient fluctuation."""
        timeline = self.timeline
        samples = max(float(np.median([step.n for run in timeline.runs for step in run.settled])), 1.0)
        sample_noise = raw_noise(timeline, plant_model)
        minimised, most = (
            max(sample_noise / np.sqrt(samples), MIN_COUNT_SD * plant_model.per_count) / plant_model.stroke,
            max(MAX_COUNT_SD * plant_model.per_count, sample_noise) / plant_model.stroke,
        )
        return (minimised, most), (MIN_FLUCTUATION_K, MAX_FLUCTUATION_K)

    def input_scatter(self, plant_model: PlantModel, prediction: Prediction) -> Array:  # noqa: ARG002
        """Zero: the input follows from the command."""
        return np.zeros(prediction.output.size)

    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:  # noqa: ARG002
        """For moving positions, the output rate times ``JITTER_S``."""
        noise = np.zeros(output_rate.size)
        if "moving" in prediction.values:
            moving = prediction.of("moving")
            noise[moving] = JITTER_S * output_rate[moving]
        return noise

    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:  # noqa: ARG002
        """Equal weights."""
        return np.ones(len(self.timeline.settled))

    def variables(self, base: Prediction) -> dict[str, Array]:
        """Time, travel, level, step, hold, rate, history and reversals at settled and moving positions."""
        timeline = self.timeline
        positions = [r for r in timeline.all_readings if r.kind in ("settled", "moving")]
        step, t = np.concatenate([r.step for r in positions]), np.concatenate([r.t_s for r in positions])
        target, before = timeline.target_K, self._target_before()
        level = np.concatenate([base.values[k] for k in ("settled", "moving") if k in base.values])
        travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
        reversal_count = np.concatenate(
            [[0.0], np.cumsum(np.abs(np.diff(np.sign(np.diff(target)), prepend=1)) > 0)]
        )
        elapsed = t - self._step_start_s()[step] + self._clock_start_s()
        return {
            "time": t,
            "cycle": travel[step],
            "level": level,
            "step": (target - before)[step],
            "hold": np.log(np.maximum(timeline.hold_s, 1.0))[step],
            "rate": np.exp(-np.maximum(elapsed, 0.0) / 10.0) * np.sign(target - before)[step],
            "history": before[step],
            "reversals": reversal_count[: target.size][step],
        }

    def rate_traces(
        self,
        base: Prediction,  # noqa: ARG002
        output_change: float,  # noqa: ARG002
        input_change: Array,  # noqa: ARG002
    ) -> Iterator[tuple[str, Array]]:
        """Nothing: the rate is a plain variable here."""
        return iter(())

    def rate_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str, bool]:  # noqa: ARG002
        """Time since the step started, with the sign of the step."""
        change = np.sign(self.timeline.target_K - self._target_before())[readings.step]
        begin = (self._step_start_s() - self._clock_start_s())[readings.step]
        return (
            (readings.t_s - begin) * change,
            "Time since the step started (s), negative in cooling steps",
            False,
        )

    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:
        """Target of the previous step."""
        return self._target_before()[readings.step], f"Target of the previous step ({input_unit})"

    def residual_zeros(self, readings: ReadingSeries) -> Integers:
        """One common zero."""
        return np.zeros(len(readings), dtype=np.int64)

    def _target_before(self) -> Array:
        target = self.timeline.target_K
        return np.concatenate([target[:1], target[:-1]])

    def _step_start_s(self) -> Array:
        """Start times of the settled steps (k,), on the clock of the runs."""
        return np.array([step.t_start_s for run in self.timeline.runs for step in run.settled])

    def _clock_start_s(self) -> float:
        """Start time of the timeline, on the clock of the runs."""
        first = self.timeline.runs[0]
        return float(first["t_s"][0]) - float(first.info.period_s or 0.1)


@final
class MeasuredInputStatistics(DriveStatistics):
    """Readings along a measured input."""

    positive_measure_only = True

    def __init__(self, timeline: Timeline, drive: MeasuredInput) -> None:
        super().__init__(timeline)
        self.drive = drive

    def correlations_s(self) -> tuple[float, ...]:
        """Multiples of the typical time between readings."""
        spacing_s = float(np.median(np.diff(self.timeline.settled.t_s)))
        return tuple(k * spacing_s for k in CORRELATION_READINGS)

    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """Bounds from the scatter of the record itself."""
        h, stroke = plant_model.hysteresis, plant_model.stroke
        span = h.upper - h.lower
        outputs = [run["position"][np.isfinite(run["position"])] for run in self.timeline.runs]
        y = MAX_SCATTER_RATIO * max(input_noise_sd(v) for v in outputs) / stroke
        u = MAX_SCATTER_RATIO * float(np.sqrt(np.mean(self.drive.scatter**2))) / span
        return (MIN_NOISE_SHARE, max(y, ALWAYS_ALLOWED_SHARE)), (
            MIN_NOISE_SHARE * span,
            max(u, ALWAYS_ALLOWED_SHARE) * span,
        )

    def input_scatter(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """The scatter of the input times the local slope."""
        slope = [s[-1] for s in sensitivities(plant_model.hysteresis, prediction.states)]
        return np.abs(np.array(slope)) * self.drive.scatter

    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:  # noqa: ARG002
        """The scatter of the input."""
        return self.input_scatter(plant_model, prediction)

    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """Weights by the scatter of the input; equal weights if outputs have different zeros."""
        zero = self.timeline.zero
        if np.ptp(zero) > 0:
            return np.ones(zero.size)
        sigma = np.hypot(self.input_scatter(plant_model, prediction), MIN_SD_SHARE * plant_model.stroke)
        return sigma.min() / sigma

    def variables(self, base: Prediction) -> dict[str, Array]:
        """Travel, level, last reversal and reversals; time only if there is a clock."""
        timeline = self.timeline
        reversal_count = np.concatenate([[0], np.cumsum(np.diff(timeline.block) != 0)])
        travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
        time_variable = {"time": timeline.settled.t_s} if self.drive.has_clock else {}
        return time_variable | {
            "cycle": travel,
            "level": base.values["settled"],
            "history": self.drive.last_reversal,
            "reversals": reversal_count.astype(float),
        }

    def rate_traces(
        self, base: Prediction, output_change: float, input_change: Array
    ) -> Iterator[tuple[str, Array]]:
        """("rate", raw traces (n, 8)) if runs with a clock differ in their rate, else nothing."""
        z = np.log(np.maximum(self.drive.speed, 1e-12))
        if not self.drive.has_clock or np.ptp(z) < np.log(MIN_RATE_RATIO):
            return
        scaled_log_rate = 2 * (z - z.min()) / np.ptp(z) - 1
        y, target = base.values["settled"], self.timeline.target_K
        level = (y - y.mean()) / (np.std(y) or 1.0)
        direction = np.sign(np.diff(target, prepend=target[0]))
        shapes = (
            np.full(z.size, output_change),
            output_change * level,
            input_change,
            input_change * direction,
        )
        waves = (scaled_log_rate, (3 * scaled_log_rate**2 - 1) / 2)
        yield "rate", np.column_stack([w * s for w in waves for s in shapes])

    def rate_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str, bool]:  # noqa: ARG002
        """|du/dt| of the branch."""
        return self.drive.speed, f"Rate of the input on its branch ({input_unit}/s)", True

    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:  # noqa: ARG002
        """Input at the last reversal."""
        return self.drive.last_reversal, f"Input at the last reversal ({input_unit})"

    def residual_zeros(self, readings: ReadingSeries) -> Integers:  # noqa: ARG002
        """The zeros of the runs."""
        return self.timeline.zero


def drive_statistics(timeline: Timeline) -> DriveStatistics:
    """The statistics for the kind of a timeline's drive."""
    drive = timeline.drive
    return (
        MeasuredInputStatistics(timeline, drive)
        if isinstance(drive, MeasuredInput)
        else CurrentStatistics(timeline)
    )


def raw_noise(timeline: Timeline, plant_model: PlantModel) -> float:
    """Standard deviation of a single position reading from the scatter within settled windows; at least half a
    count.
    """
    return float(np.sqrt(max(_scatter(timeline), (0.5 * plant_model.per_count) ** 2, 1e-12)))


@lru_cache(maxsize=8)
def _scatter(timeline: Timeline) -> float:
    """Median variance of neighbouring readings in settled windows; cached for all refits."""
    spread = []
    for run in timeline.runs:
        for step in run.settled[:: max(1, len(run.settled) // 40)]:
            y = run["position"][run.window(step)]
            if y.size > 20:
                spread.append(float(np.var(np.diff(y)) / 2))
    return float(np.median(spread)) if spread else 0.0

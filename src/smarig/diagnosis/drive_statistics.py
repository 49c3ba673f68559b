"""What the kind of drive decides in a diagnosis: variables that may matter, noise, and how a density is identified.

Under a commanded current, readings follow heating, holds and steps; noise is that of settled windows. Where the input
itself was measured, readings follow the input's branches: a rate changes how high and how wide a loop is, so its traces
are smooth functions of log |du/dt| times 1, the output, the slope ∂y/∂u, and the slope with the sign of du/dt.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import lru_cache
from typing import ClassVar, final

import numpy as np
from numpy.typing import NDArray

from smarig.preisach import sensitivities
from smarig.replay import MeasuredInput, PlantModel, Prediction, ReadingSeries, Timeline, input_noise_sd

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Bounds = tuple[float, float]
JITTER_S = 0.02  # of a time stamp: what moves fast is known no better
CORRELATIONS_S = (120.0, 30.0, 300.0)
MAX_FLUCTUATION_K = 0.4  # of the ambient temperature
MIN_FLUCTUATION_K = 10**-2.5
MIN_COUNT_SD = 0.1  # counts: no encoder's marks lie better
MAX_COUNT_SD = 0.6  # counts: no mean of settled samples is worse, unless they scatter
MIN_RATE_RATIO = 1.5  # rates that differ less, as a factor, are one rate
MIN_NOISE_SHARE, ALWAYS_ALLOWED_SHARE = (
    1e-5,
    3e-3,
)  # of a range: sd of a noise at least, and what it may be however smooth the record is
MIN_SD_SHARE = 0.01  # of the stroke: a density is fitted to nothing more firmly than that
MAX_SCATTER_RATIO = 3.0  # times the scatter that a record shows: nothing larger is noise
CORRELATION_READINGS = (0.5, 5.0, 50.0)  # readings over which input noise keeps


class DriveStatistics(ABC):
    """Variables and noise of a timeline's readings, by the kind of its drive.

    ``positive_measure_only``: a density is identified as a smooth positive measure alone, and so left as it is found.
    """

    positive_measure_only: ClassVar[bool]

    def __init__(self, timeline: Timeline) -> None:
        self.timeline = timeline

    @abstractmethod
    def correlations_s(self) -> tuple[float, ...]:
        """Correlation times of remembered noise worth trying, on the timeline's own clock."""

    @abstractmethod
    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """Least and most of s₀ (strokes) and of s_T (input units)."""

    @abstractmethod
    def input_scatter(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """Sd (n,) in output units that the scatter of a measured input adds to each position."""

    @abstractmethod
    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:
        """Sd (coupled,) in output units of what is uncertain in the time or the input of each coupled reading.

        ``output_rate`` (coupled,) is the output per second there.
        """

    @abstractmethod
    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """Weights (k,) of settled readings in a fit of the density, 1/σ, the best known at 1."""

    @abstractmethod
    def variables(self, base: Prediction) -> dict[str, Array]:
        """Plain variables (n,) of each position on which an error may depend, by name."""

    @abstractmethod
    def rate_traces(
        self, base: Prediction, output_change: float, input_change: Array
    ) -> Iterator[tuple[str, Array]]:
        """(name, raw traces (n, m)) of what depends on a rate beside the plain variables.

        ``output_change`` is an output, ``input_change`` (n,) what an input adds, as large as may be expected.
        """

    @abstractmethod
    def rate_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str, bool]:
        """Values (n,) of the variable "rate" at readings, its label, and whether its axis is logarithmic."""

    @abstractmethod
    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:
        """Values (n,) of the variable "history" at readings, and its label."""

    @abstractmethod
    def residual_zeros(self, readings: ReadingSeries) -> Integers:
        """Numbers (n,) of the zeros that are removed from residuals."""


@final
class CurrentStatistics(DriveStatistics):
    """Readings under commanded currents."""

    positive_measure_only = False

    def correlations_s(self) -> tuple[float, ...]:
        """Those of ambient fluctuations."""
        return CORRELATIONS_S

    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """No mean is better than its samples allow, and a misfit of kelvins is no ambient fluctuation."""
        timeline = self.timeline
        samples = max(float(np.median([step.n for run in timeline.runs for step in run.settled])), 1.0)
        sample_noise = raw_noise(timeline, plant_model)
        minimised, most = (
            max(sample_noise / np.sqrt(samples), MIN_COUNT_SD * plant_model.per_count) / plant_model.stroke,
            max(MAX_COUNT_SD * plant_model.per_count, sample_noise) / plant_model.stroke,
        )
        return (minimised, most), (MIN_FLUCTUATION_K, MAX_FLUCTUATION_K)

    def input_scatter(self, plant_model: PlantModel, prediction: Prediction) -> Array:  # noqa: ARG002
        """None: the input follows from the command."""
        return np.zeros(prediction.output.size)

    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:  # noqa: ARG002
        """Of moving positions: their time stamps are no better than ``JITTER_S``."""
        noise = np.zeros(output_rate.size)
        if "moving" in prediction.values:
            moving = prediction.of("moving")
            noise[moving] = JITTER_S * output_rate[moving]
        return noise

    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:  # noqa: ARG002
        """Equal ones."""
        return np.ones(len(self.timeline.settled))

    def variables(self, base: Prediction) -> dict[str, Array]:
        """At settled and moving positions: time, travel, level, step, hold, rate, history, reversals."""
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
        """None: the rate is a plain variable."""
        return iter(())

    def rate_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str, bool]:  # noqa: ARG002
        """Time since the step began, with the sign of the step."""
        change = np.sign(self.timeline.target_K - self._target_before())[readings.step]
        begin = (self._step_start_s() - self._clock_start_s())[readings.step]
        return (readings.t_s - begin) * change, "Time since the step began, < 0: cooling steps (s)", False

    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:
        """Target of the step before."""
        return self._target_before()[readings.step], f"Target of the step before ({input_unit})"

    def residual_zeros(self, readings: ReadingSeries) -> Integers:
        """One for all."""
        return np.zeros(len(readings), dtype=np.int64)

    def _target_before(self) -> Array:
        target = self.timeline.target_K
        return np.concatenate([target[:1], target[:-1]])

    def _step_start_s(self) -> Array:
        """When each settled step began (k,), on the clock of the runs."""
        return np.array([step.t_start_s for run in self.timeline.runs for step in run.settled])

    def _clock_start_s(self) -> float:
        """When the timeline began, on the clock of the runs."""
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
        """By the usual distance of readings."""
        spacing_s = float(np.median(np.diff(self.timeline.settled.t_s)))
        return tuple(k * spacing_s for k in CORRELATION_READINGS)

    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """What the record's own scatter allows."""
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
        """The input's own scatter times the local slope."""
        slope = [s[-1] for s in sensitivities(plant_model.hysteresis, prediction.states)]
        return np.abs(np.array(slope)) * self.drive.scatter

    def timing_noise(self, plant_model: PlantModel, prediction: Prediction, output_rate: Array) -> Array:  # noqa: ARG002
        """That of the input."""
        return self.input_scatter(plant_model, prediction)

    def reading_weights(self, plant_model: PlantModel, prediction: Prediction) -> Array:
        """By the input's scatter; equal ones where outputs have different zeros."""
        zero = self.timeline.zero
        if np.ptp(zero) > 0:
            return np.ones(zero.size)
        sigma = np.hypot(self.input_scatter(plant_model, prediction), MIN_SD_SHARE * plant_model.stroke)
        return sigma.min() / sigma

    def variables(self, base: Prediction) -> dict[str, Array]:
        """Travel, level, last reversal, reversals; time only where there is a clock."""
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
        """("rate", raw traces (n, 8)) where runs with a clock differ in their rate, else nothing."""
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
        """Those of the runs."""
        return self.timeline.zero


def drive_statistics(timeline: Timeline) -> DriveStatistics:
    """The statistics that belong to the kind of a timeline's drive."""
    drive = timeline.drive
    return (
        MeasuredInputStatistics(timeline, drive)
        if isinstance(drive, MeasuredInput)
        else CurrentStatistics(timeline)
    )


def raw_noise(timeline: Timeline, plant_model: PlantModel) -> float:
    """Sd of a single position reading, from the scatter within settled windows; half a count at least."""
    return float(np.sqrt(max(_scatter(timeline), (0.5 * plant_model.per_count) ** 2, 1e-12)))


@lru_cache(maxsize=8)
def _scatter(timeline: Timeline) -> float:
    """Median variance of neighbours in settled windows; kept, because every refit needs it."""
    spread = []
    for run in timeline.runs:
        for step in run.settled[:: max(1, len(run.settled) // 40)]:
            y = run["position"][run.window(step)]
            if y.size > 20:
                spread.append(float(np.var(np.diff(y)) / 2))
    return float(np.median(spread)) if spread else 0.0

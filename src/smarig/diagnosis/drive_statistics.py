"""Statistics of a timeline under commanded currents: the plain variables of its readings, and bounds of its noise."""

from functools import lru_cache

import numpy as np

from smarig.core import Array
from smarig.replay import PlantModel, Prediction, ReadingSeries, Timeline

Bounds = tuple[float, float]
JITTER_S = 0.02  # uncertainty of a time stamp
CORRELATIONS_S = (120.0, 30.0, 300.0)
MAX_FLUCTUATION_K = 0.4  # of the ambient temperature
MIN_FLUCTUATION_K = 10**-2.5
MIN_COUNT_SD = 0.1  # counts: the best that an encoder's marks allow
MAX_COUNT_SD = 0.6  # counts: the worst mean of settled samples that do not scatter


class DriveStatistics:
    """Variables and noise of a timeline's readings."""

    def __init__(self, timeline: Timeline) -> None:
        self.timeline = timeline

    def correlations_s(self) -> tuple[float, ...]:
        """The correlation times of ambient fluctuations."""
        return CORRELATIONS_S

    def noise_bounds(self, plant_model: PlantModel) -> tuple[Bounds, Bounds]:
        """Bounds from the number of samples of a mean and from the largest plausible ambient fluctuation."""
        timeline = self.timeline
        samples = max(float(np.median([step.n for run in timeline.runs for step in run.settled])), 1.0)
        sample_noise = raw_noise(timeline, plant_model)
        minimised, most = (
            max(sample_noise / np.sqrt(samples), MIN_COUNT_SD * plant_model.per_count)
            / abs(plant_model.stroke),
            max(MAX_COUNT_SD * plant_model.per_count, sample_noise) / abs(plant_model.stroke),
        )
        return (minimised, most), (MIN_FLUCTUATION_K, MAX_FLUCTUATION_K)

    def timing_noise(self, prediction: Prediction, output_rate: Array) -> Array:
        """For moving positions, the output rate times ``JITTER_S``."""
        noise = np.zeros(output_rate.size)
        if "moving" in prediction.values:
            moving = prediction.of("moving")
            noise[moving] = JITTER_S * output_rate[moving]
        return noise

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

    def rate_axis(self, readings: ReadingSeries) -> tuple[Array, str]:
        """Time since the step started, with the sign of the step."""
        change = np.sign(self.timeline.target_K - self._target_before())[readings.step]
        begin = (self._step_start_s() - self._clock_start_s())[readings.step]
        return (readings.t_s - begin) * change, "Time since the step started (s), negative in cooling steps"

    def history_axis(self, readings: ReadingSeries, input_unit: str) -> tuple[Array, str]:
        """Target of the previous step."""
        return self._target_before()[readings.step], f"Target of the previous step ({input_unit})"

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


def raw_noise(timeline: Timeline, plant_model: PlantModel) -> float:
    """Standard deviation of a single position reading from the scatter within settled windows; at least half a
    count.
    """
    return float(np.sqrt(max(_scatter(timeline), (0.5 * plant_model.per_count) ** 2, 1e-12)))


def reading_scatter(timeline: Timeline) -> float:
    """Standard deviation of a single position reading in settled windows; 0 if they do not scatter."""
    return float(np.sqrt(_scatter(timeline)))


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

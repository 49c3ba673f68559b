"""An observer of position: the model's prediction, corrected by the resistance as far as the resistance tells it.

    y = ŷ + y_δ δ + e + l λ              δ: error of the input (K), e: error of the output, λ: of the lag l
    R = R̂ + R_δ δ + R_y (e + l λ) + b_w + v,   R̂ from the map of wire w, v = white noise of a reading, noise_V/|i|

δ, e, λ and b_w are first-order Gauss–Markov processes with the standard deviations and times of the identification,
and a Kalman filter estimates them. Without current there is no reading: the prediction goes on, and its interval grows
to that of the model alone.

A reading alone determines the position through the slope of R over y among the states that the model holds possible,

    s = cov(R, y)/var(y),   half-width = 1.96 √(var(R | y) + noise²) / |s|.

The position is limited to the ends of the model. A reading is ``ambiguous`` if its 99.7 % interval, ± 3 standard
deviations, is wider than ± ``AMBIGUOUS_SHARE`` of the stroke: positions so far apart have the same resistance.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.control.sensing.resistance_map import SelfSensing
from smarig.control.sensing.wire_prediction import PredictedWire, WirePrediction
from smarig.plant import Actuator
from smarig.preisach import Everett, Initial

AMBIGUOUS_SHARE = 0.1  # of the stroke: a wider 99.7 % interval of a single reading tells no position
INPUT_TIME_S = 60.0  # correlation time of the input's error: it may be another in another state
LAG_TIME_S = 600.0  # that of the lag, which belongs to the wire
QUANTILE, SURE_QUANTILE = 1.96, 3.0
_STATES = 3  # δ, e, λ; then the error of the map of each wire


def is_ambiguous(reading_half: ArrayLike, stroke: float) -> NDArray[np.bool_]:
    """Whether readings with half-widths (n,) of their 95 % intervals tell no position.

    >>> is_ambiguous([0.5, 0.7, math.inf], stroke=10.0).tolist()
    [False, True, True]
    """
    return ~(np.asarray(reading_half) * SURE_QUANTILE / QUANTILE <= AMBIGUOUS_SHARE * stroke)


class Observation(NamedTuple):
    """The observed position and half of its 95 % interval, in the model's unit and scale.

    ``reading`` and ``reading_half`` are those of the resistance of this tick alone, NaN and infinite without a reading.
    ``deviation`` is the resistance minus the expected one in standard deviations of the latter, 0 without a reading.
    """

    position: float
    half: float
    predicted: float
    reading: float
    reading_half: float
    ambiguous: bool
    deviation: float


class PositionObserver:
    """``step(voltage_V, current_A)`` at every tick, from a known state of the memory and cold wires."""

    def __init__(
        self,
        sensing: SelfSensing,
        actuator: Actuator,
        hysteresis: Everett,
        initial: Initial,
        period_s: float,
    ) -> None:
        self.sensing = sensing
        self.model = WirePrediction(actuator, hysteresis, initial, period_s, sensing.input_error_K)
        maps = sensing.wires
        errors = sensing.input_error_K, sensing.output_error, sensing.lag_error
        spread = np.array([*errors, *(w.error_ohm for w in maps)])
        times_s = np.array([INPUT_TIME_S, sensing.output_time_s, LAG_TIME_S, *(w.time_s for w in maps)])
        self._decay = np.exp(-period_s / times_s)
        self._stationary = np.diag(spread**2)
        self._kept = np.outer(self._decay, self._decay)
        self._added = np.diag(spread**2 * (1 - self._decay**2))
        margin, low = 3 * sensing.output_error, hysteresis.y_lower
        high = low + hysteresis.everett(hysteresis.upper, hysteresis.lower)
        self._ends = min(low, high) - margin, max(low, high) + margin
        self._x, self._P = np.zeros(spread.size), self._stationary.copy()

    def predict(self, current_A: float, ticks: int) -> None:
        """Let ticks pass at a current, without readings."""
        for _ in range(ticks):
            self.step(math.nan, current_A)

    def step(self, voltage_V: float, current_A: float) -> Observation:
        """One tick. A voltage that is not finite gives no reading."""
        here, warmer, colder = self.model.step(current_A)
        self._x = self._x * self._decay
        self._P = self._P * self._kept + self._added
        to_position = np.zeros(self._x.size)
        per_K = (warmer.position - colder.position) / (2 * self.model.offsets_K[1])
        to_position[:_STATES] = per_K, 1.0, self.model.lag
        reading, reading_half, deviation = math.nan, math.inf, 0.0
        if abs(current_A) >= self.sensing.least_A and math.isfinite(voltage_V):
            wire = self.model.wire_of(current_A)
            to_ohm, expected = self._resistance(wire, here, warmer, colder)
            innovation = voltage_V / current_A - expected
            noise = (self.sensing.noise_V / current_A) ** 2
            slope, spread = self._alone(to_position, to_ohm, noise)
            if slope:
                reading = here.position + innovation / slope
                reading_half = QUANTILE * self.sensing.reading_factor * spread / abs(slope)
            deviation = innovation / math.sqrt(float(to_ohm @ self._stationary @ to_ohm) + noise)
            self._correct(to_ohm, innovation, noise)
        variance = float(to_position @ self._P @ to_position)
        low, high = self._ends
        position = min(max(here.position + float(to_position @ self._x), low), high)
        self.model.corrected(position)
        return Observation(
            position,
            QUANTILE * self.sensing.interval_factor * math.sqrt(max(variance, 0.0)),
            here.position,
            reading,
            reading_half,
            bool(is_ambiguous(reading_half, self.sensing.stroke)),
            deviation,
        )

    def _resistance(
        self, wire: int, here: PredictedWire, warmer: PredictedWire, colder: PredictedWire
    ) -> tuple[np.ndarray, float]:
        """The gradient of the resistance by the states, and the expected resistance."""
        known = self.sensing.wires[wire]
        gradient = np.zeros(self._x.size)
        gradient[0] = (known.ohm(*warmer) - known.ohm(*colder)) / (2 * self.model.offsets_K[1])
        gradient[1:_STATES] = np.array([1.0, self.model.lag]) * known.per_position(here.wire)
        gradient[_STATES + wire] = 1.0
        return gradient, known.ohm(*here)

    def _alone(self, to_position: np.ndarray, to_ohm: np.ndarray, noise: float) -> tuple[float, float]:
        """Slope of R over y, and the standard deviation of R at a position, of a reading without those before."""
        covariance = float(to_ohm @ self._stationary @ to_position)
        variance = float(to_position @ self._stationary @ to_position)
        rest = float(to_ohm @ self._stationary @ to_ohm) - covariance**2 / variance
        return covariance / variance, math.sqrt(max(rest, 0.0) + noise)

    def _correct(self, to_ohm: np.ndarray, innovation: float, noise: float) -> None:
        with_ohm = self._P @ to_ohm
        gain = with_ohm / (float(to_ohm @ with_ohm) + noise)
        self._x = self._x + gain * (innovation - float(to_ohm @ self._x))
        self._P = self._P - np.outer(gain, with_ohm)

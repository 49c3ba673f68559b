"""Plausibility of readings in a set-point loop: an integrator would follow a dead encoder to the end of the range.

Two signs show that a set-point cannot be reached: the source stays at its limit while the wire is off target, or the
readings stand still although the wire must have moved far by the model. Ambient changes shift the source as well, so
the thresholds exceed their effect.
"""

import math

from smarig.core import LimitExceeded
from smarig.preisach import Everett, Preisach, State
from smarig.protocols import Setup

LIMIT_TAUS = 10.0  # time at the limit after which the wire is at rest there
OFF_TARGET = 0.03  # of the output range: a larger error is off the set-point
EXPECTED_MOTION = 0.3  # of the output range: motion of the model that readings must show
STANDSTILL = 0.03  # of the output range: a smaller motion is a standstill


class SensorPlausibility:
    """``check(source_K, position, error)`` at every sample of a loop that was closed at rest in ``state``.

    ``sensor`` is what the position comes from, for the message.
    """

    def __init__(self, setup: Setup, hysteresis: Everett, state: State, sensor: str = "encoder") -> None:
        self._sensor = sensor
        self._setup, self._operator = setup, Preisach(hysteresis, state)
        self._range = abs(hysteresis.everett(hysteresis.upper, hysteresis.lower))
        self._wire_K, self._at_limit_s = state.u, 0.0
        self._last_motion = (state.y, math.nan)  # of model and encoder, when the encoder last moved

    def check(self, source_K: float, position: float, error: float) -> None:
        """Raise LimitExceeded if the set-point cannot be reached or the readings are implausible."""
        self._follow(source_K)
        self._check_reach(source_K, error)
        self._check_motion(position)

    def _follow(self, source_K: float) -> None:
        setup = self._setup
        self._wire_K += (source_K - self._wire_K) * -math.expm1(-setup.period_s / setup.tau_s)
        self._operator.step(self._wire_K)

    def _check_reach(self, source_K: float, error: float) -> None:
        setup = self._setup
        limited = source_K <= setup.lower_K or source_K >= setup.upper_K
        held_off_target = limited and abs(error) > OFF_TARGET * self._range
        self._at_limit_s = self._at_limit_s + setup.period_s if held_off_target else 0.0
        if self._at_limit_s > LIMIT_TAUS * setup.tau_s:
            raise LimitExceeded(
                f"The set-point is unreachable: the source has been at its limit of {source_K:.3g} K for "
                f"{self._at_limit_s:.0f} s, and the position error is {abs(error):.3g}."
            ).at_zero()

    def _check_motion(self, position: float) -> None:
        output, read = self._last_motion
        if not abs(position - read) <= STANDSTILL * self._range:
            self._last_motion = self._operator.y, position
        elif abs(self._operator.y - output) > EXPECTED_MOTION * self._range:
            raise LimitExceeded(
                f"According to the model the wire moved by {abs(self._operator.y - output):.3g}, but according to "
                f"the {self._sensor} only by "
                f"{abs(position - read):.3g}. Check the {self._sensor} and the wire."
            ).at_zero()

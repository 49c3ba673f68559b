"""Host-side limits, checked on every tick, around any rig: current, its rate, predicted temperature.

The prediction is the heating model (5.1) driven by the measured current; it is also what the record
calls ``input``. The device's own limits come first; these are the second layer. Never reshapes a
command: what is not allowed is refused, and the rig made safe.
"""

import math

from smarig.config import LimitsFile
from smarig.errors import LimitExceeded
from smarig.model.actuator import Actuator
from smarig.model.heating import Heating
from smarig.rig.rig import Rig
from smarig.sample import Sample

_ROUNDING = 1e-9


class Guard:
    """A rig that refuses what its limits forbid; ``input_K`` is the predicted hysteresis input."""

    def __init__(self, rig: Rig, limits: LimitsFile, actuator: Actuator) -> None:
        self.rig, self.limits = rig, limits
        self.heating = Heating(actuator, rig.period_s)
        self.tripped = ""
        self._last_A = 0.0
        self._step_A = limits.current_rate_A_per_s * rig.period_s + _ROUNDING

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.rig.period_s

    @property
    def input_K(self) -> float:
        """Predicted hysteresis input now: kelvin above ambient, T₁ − T₂ for two wires."""
        return self.heating.input_K

    def to_go_K(self, current_A: float) -> float:
        """How far the heating model still is from its steady state at a current, kelvin."""
        return abs(self.heating.source(current_A) - self.heating.input_K)

    def step(self, current_A: float) -> list[tuple[Sample, float]]:
        """Check, apply, and pair each sample with the predicted input at its tick.

        A temperature trip makes the rig safe at once and is left in ``tripped``, so that the samples that
        show it are still recorded; every later step is refused.
        """
        self.raise_if_tripped()
        self._check(current_A)
        self._last_A = current_A
        heat, limit = self.heating, self.limits.temperature_max_K
        answer = []
        for sample in self.rig.step(current_A):
            answer.append((sample, heat.step(sample.current_A)))
            if not (heat.wire_K[0] <= limit and heat.wire_K[1] <= limit):  # NaN is no temperature to rely on
                self.tripped = (
                    f"Predicted wire temperature {max(heat.wire_K):.1f} K above ambient exceeds the limit "
                    f"temperature_max_K = {limit:g}; the current is at zero."
                    if heat.wire_K[0] + heat.wire_K[1] < math.inf
                    else f"The measured current reads {sample.current_A} A; the current is at zero."
                )
                self.safe()
        return answer

    def raise_if_tripped(self) -> None:
        """LimitExceeded if a limit has tripped."""
        if self.tripped:
            raise LimitExceeded(self.tripped)

    def _check(self, current_A: float) -> None:
        limits = self.limits
        low, high = limits.current_min_A - _ROUNDING, limits.current_max_A + _ROUNDING
        if not low <= current_A <= high:
            raise LimitExceeded(
                f"Current {current_A:g} A is outside the limits {limits.current_min_A:g}…{limits.current_max_A:g} A."
            )
        if math.fabs(current_A - self._last_A) > self._step_A:
            rate = abs(current_A - self._last_A) / self.period_s
            raise LimitExceeded(
                f"A step from {self._last_A:g} A to {current_A:g} A is {rate:.3g} A/s, above the limit "
                f"current_rate_A_per_s = {limits.current_rate_A_per_s:g}."
            )

    def zero(self) -> None:
        """Zero the encoder."""
        self.rig.zero()

    def safe(self) -> None:
        """Current to zero, whatever it was."""
        self.rig.safe()
        self._last_A = 0.0

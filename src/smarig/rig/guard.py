"""Host-side limits, checked on every tick, around any rig: current, its rate, predicted temperature.

The prediction is the heating model (5.1) driven by the measured current; it is also what the record
calls ``input``. The device's own limits come first; these are the second layer. Never reshapes a
command: what is not allowed is refused, and the rig made safe.
"""

import math

from smarig.config import LimitsFile
from smarig.core import LimitExceeded, Quality, Sample
from smarig.plant import Actuator, JouleHeating
from smarig.rig.plausibility import Plausibility
from smarig.rig.rig import Alarm, Rig

_ROUNDING = 1e-9
_STALE = int(Quality.STALE)  # a plain integer: an enum's & costs a µs a tick


class Guard:
    """A rig that refuses what its limits forbid; ``input_K`` is the predicted hysteresis input."""

    def __init__(
        self, rig: Rig, limits: LimitsFile, actuator: Actuator, plausibility: Plausibility | None = None
    ) -> None:
        self.rig, self.limits, self._plausibility = rig, limits, plausibility
        self._alarms: list[Alarm] = []
        self._last_tick = rig.tick
        self.heating = JouleHeating(actuator, rig.period_s)
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

    def steady_input_K(self, current_A: float) -> float:
        """Where the heating model comes to rest at a current, kelvin."""
        return self.heating.source(current_A)

    def step(self, current_A: float, at_most: int = 1) -> list[tuple[Sample, float]]:
        """Check, apply, and pair each sample with the predicted input at its tick.

        A temperature trip makes the rig safe at once and is left in ``tripped``, so that the samples that
        show it are still recorded; every later step is refused.
        """
        self.raise_if_tripped()
        self._check_command(current_A)
        self._last_A = current_A
        heat, limit = self.heating, self.limits.temperature_max_K
        answer = []
        for sample in self.rig.step(current_A, at_most):
            heating_A = self._heating_current_A(sample)
            for _ in range(self._last_tick + 1, sample.tick):  # lost ones: the wire was heated all the same
                heat.step(heating_A)
            self._last_tick = sample.tick
            answer.append((sample, heat.step(heating_A)))
            self._check_plausibility(sample)
            if not (heat.wire_K[0] <= limit and heat.wire_K[1] <= limit):  # NaN is no temperature to rely on
                self.tripped = (
                    f"Predicted wire temperature {max(heat.wire_K):.1f} K above ambient exceeds the limit "
                    f"temperature_max_K = {limit:g}. The current is at zero."
                    if heat.wire_K[0] + heat.wire_K[1] < math.inf
                    else f"The measured current reads {sample.current_A} A. The current is at zero."
                )
                self.safe()
        return answer

    def _heating_current_A(self, sample: Sample) -> float:
        """The measured current; where there is none, what was set or measured last, whichever heats more."""
        if not sample.quality & _STALE:
            return sample.current_A
        return max(self._last_A, sample.current_A, key=abs)

    def _check_plausibility(self, sample: Sample) -> None:
        """Trip on readings that cannot be."""
        for alarm in self._plausibility.check(sample, self.heating.input_K) if self._plausibility else ():
            self._alarms.append(alarm)
            if alarm.level == "error" and not self.tripped:
                self.tripped = f"{alarm.text} The current is at zero."
                self.safe()

    def alarms(self) -> list[Alarm]:
        """The rig's, and what its readings gave away."""
        own, self._alarms = self._alarms, []
        return [*self.rig.alarms(), *own]

    def raise_if_tripped(self) -> None:
        """LimitExceeded if a limit has tripped."""
        if self.tripped:
            raise LimitExceeded(self.tripped)

    def _check_command(self, current_A: float) -> None:
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
        if self._plausibility:
            self._plausibility.zeroed()

    def safe(self) -> None:
        """Current to zero, whatever it was."""
        self.rig.safe()
        self._last_A = 0.0

    def arm(self) -> None:
        """Clear a latched trip, the device's and our own; the current stays at zero until the next step."""
        self.rig.arm()
        self.tripped = ""
        self._last_A = 0.0
        if self._plausibility:
            self._plausibility.rearmed()

"""Limits on the host around any rig, checked at every tick: current, its rate, predicted and measured temperature.

The prediction is the heating model (5.1) driven by the measured current; the record calls it ``input``. These limits
are the second layer after the device's own. The guard never changes a command: it refuses a forbidden command and
makes the rig safe.
"""

import math
from collections.abc import Sequence

from smarig.config import LimitsFile
from smarig.core import LimitExceeded, Quality, Sample
from smarig.device import NO_MEASURED_CURRENT, AbsoluteZero
from smarig.plant import Actuator, JouleHeating
from smarig.rig.plausibility import REST_TAUS, Plausibility
from smarig.rig.rig import Alarm, Rig
from smarig.rig.room_temperature import RoomTemperature
from smarig.rig.shutdown import after_shutdown, confirm_zero
from smarig.rig.stress_limit import StressLimit

_ROUNDING = 1e-9
_STALE, _SUSPECT = int(Quality.STALE), int(Quality.SUSPECT)  # plain: the & of an enum costs 1 µs per tick


class Guard:
    """A rig that refuses forbidden commands. ``input_K`` is the predicted hysteresis input."""

    def __init__(
        self,
        rig: Rig,
        limits: LimitsFile,
        actuator: Actuator,
        plausibility: Plausibility | None = None,
        stress: StressLimit | None = None,
        room: RoomTemperature | None = None,
    ) -> None:
        self.rig, self.limits, self._plausibility, self._stress = rig, limits, plausibility, stress
        self._room = room
        self._alarms: list[Alarm] = []
        self._first_tick = self._last_tick = rig.tick
        self._unsure_until = rig.tick  # the assumed start of the prediction is forgotten at this tick
        self.heating = JouleHeating(actuator, rig.period_s)
        self.tripped = ""
        self._last_A = 0.0
        self._step_A = limits.current_rate_A_per_s * rig.period_s + _ROUNDING

    def start_hot(self, wire_K: Sequence[float]) -> None:
        """Start the prediction with wires that may be this hot, in place of cold ones. After the first step it is known
        better, and nothing changes.

        At most at the limit: from there, whatever heats a wire trips at once, and the current that cools it is allowed.
        """
        if self._last_tick != self._first_tick or not any(hot > 0 for hot in wire_K):
            return
        limit, heat = self.limits.temperature_max_K, self.heating
        heat.wire_K = [min(max(before, hot), limit) for before, hot in zip(heat.wire_K, wire_K)]
        if self._stress is not None:
            self._stress.start_hot(heat.wire_K)
        self._unsure_until = self._last_tick + math.ceil(REST_TAUS * heat.tau_s / self.period_s)

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.rig.period_s

    @property
    def input_K(self) -> float:
        """The present predicted hysteresis input: kelvin above ambient, T₁ − T₂ for two wires."""
        return self.heating.input_K

    def steady_input_K(self, current_A: float) -> float:
        """The steady state of the heating model at a current, in kelvin."""
        return self.heating.source(current_A)

    def step(self, current_A: float, at_most: int = 1) -> list[tuple[Sample, float]]:
        """Check the command, apply it, and pair each sample with the predicted input at its tick.

        A temperature trip makes the rig safe at once and sets ``tripped``, so that the samples that show it are
        still recorded. Every later step is refused.
        """
        self.raise_if_tripped()
        self._check_command(current_A)
        if self._stress is not None and (reason := self._stress.refusal(self.heating, current_A)):
            self._trip(reason)
            self.raise_if_tripped()
        self._last_A = current_A
        heat, limit = self.heating, self.limits.temperature_max_K
        answer = []
        for sample in self.rig.step(current_A, at_most):
            heating_A = self._heating_current_A(sample)
            # Lost samples: the wire was heated nevertheless.
            for _ in range(self._last_tick + 1, sample.tick):
                heat.step(heating_A)
            self._last_tick = sample.tick
            input_K = heat.step(heating_A)
            ambient_degC = self._ambient_degC(sample)
            answer.append((self._marked(sample, ambient_degC, heating_A, input_K), input_K))
            if self._stress is not None:
                self._stress.update(heat.wire_K)
            hottest_K = max(heat.wire_K)
            if not hottest_K <= limit or heat.wire_K[1] != heat.wire_K[1]:  # also trips on NaN
                self._trip_on_prediction(hottest_K, sample.current_A)
            elif sample.temperature_degC - ambient_degC > limit:
                self._trip(
                    f"The measured wire temperature {sample.temperature_degC:.1f} °C is "
                    f"{sample.temperature_degC - ambient_degC:.1f} K above ambient and exceeds the limit "
                    f"temperature_max_K = {limit:g}."
                )
        return answer

    def _trip_on_prediction(self, hottest_K: float, current_A: float) -> None:
        if math.isfinite(self.input_K):
            self._trip(
                f"Predicted wire temperature {hottest_K:.5g} K above ambient exceeds the limit "
                f"temperature_max_K = {self.limits.temperature_max_K:g}."
            )
        elif self.tripped:
            return  # by the sample whose current was no number: no later prediction is one
        elif math.isnan(current_A):
            self._trip(f"The measured current reads {current_A} A. {NO_MEASURED_CURRENT}")
        else:
            self._trip(f"The measured current reads {current_A} A.")

    def _trip(self, text: str) -> None:
        """Make the rig safe at once and keep the reason."""
        self.safe()
        self.tripped = text

    def _heating_current_A(self, sample: Sample) -> float:
        """The measured current. If it is stale, the larger of the commanded and the last measured current."""
        if not sample.quality & _STALE:
            return sample.current_A
        return max(self._last_A, sample.current_A, key=abs)

    def _ambient_degC(self, sample: Sample) -> float:
        """The ambient temperature on which limits rest: as it is measured, if a room can have it."""
        if self._room is None:
            return sample.ambient_degC
        room, reading_degC = self._room, sample.ambient_degC
        self._alarms += room.add(reading_degC, sample.tick)
        return room.degC if room.suspect or math.isnan(reading_degC) else reading_degC

    def _marked(self, sample: Sample, ambient_degC: float, heating_A: float, input_K: float) -> Sample:
        """The sample, marked if it is implausible; trips on errors."""
        is_number = math.isfinite(input_K)
        other_room = self._room is not None and self._room.suspect
        suspect = other_room or not is_number
        if self._plausibility is None or not is_number:  # of a current that is none, no model can tell more
            return sample._replace(quality=sample.quality | _SUSPECT) if suspect else sample
        checked = sample._replace(ambient_degC=ambient_degC) if other_room else sample
        for alarm in self._plausibility.check(checked, input_K, heating_A):
            self._alarms.append(alarm)
            if alarm.level == "error" and not self.tripped:
                self._trip(alarm.text)
        suspect = suspect or self._plausibility.suspect
        if self._last_tick < self._unsure_until:
            self._plausibility.input_unsure()
        return sample._replace(quality=sample.quality | _SUSPECT) if suspect else sample

    def alarms(self) -> list[Alarm]:
        """Alarms of the rig and of the plausibility checks since the last call."""
        own, self._alarms = self._alarms, []
        return [*self.rig.alarms(), *own]

    def raise_if_tripped(self) -> None:
        """Raise LimitExceeded if a limit has tripped."""
        if self.tripped:
            raise after_shutdown(LimitExceeded(self.tripped), self.rig)

    def _check_command(self, current_A: float) -> None:
        limits = self.limits
        low, high = limits.current_min_A - _ROUNDING, limits.current_max_A + _ROUNDING
        if not low <= current_A <= high:
            raise LimitExceeded(outside_limits_text(current_A, limits))
        if math.fabs(current_A - self._last_A) > self._step_A:
            rate = abs(current_A - self._last_A) / self.period_s
            raise LimitExceeded(
                f"A step from {self._last_A:g} A to {current_A:g} A is {rate:.3g} A/s. The limit is "
                f"current_rate_A_per_s = {limits.current_rate_A_per_s:g}."
            )

    def zero(self) -> None:
        """Zero the encoder."""
        self.rig.zero()
        if self._plausibility:
            self._plausibility.zeroed()

    @property
    def absolute_zero(self) -> AbsoluteZero | None:
        """The zero of a sensor that keeps it through a restart; None for others."""
        return getattr(self.rig, "absolute_zero", None)

    def safe(self) -> None:
        """Set the current to zero."""
        self.rig.safe()
        self._last_A = 0.0

    def confirm_zero(self) -> str:
        """After ``safe``: a sentence if a current is still measured."""
        return confirm_zero(self.rig)

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why the source may still be on after ``safe``; "" if it is off."""
        return self.rig.shutdown_unconfirmed

    @property
    def has_lease(self) -> bool:
        """Whether the source switches itself off when the host stops communicating."""
        return getattr(self.rig, "has_lease", True)

    def arm(self) -> None:
        """Clear a latched trip of the device and of the guard; the current stays at zero until the next step."""
        self.rig.arm()
        self.tripped = ""
        self._last_A = 0.0
        if self._plausibility:
            self._plausibility.rearmed()


def outside_limits_text(current_A: float, limits: LimitsFile) -> str:
    """The sentence about a current that the limits do not allow, with the key of the one that refuses it."""
    way = "above limits.current_max_A" if current_A > limits.current_max_A else "below limits.current_min_A"
    allowed = f"{limits.current_min_A:g}…{limits.current_max_A:g} A"
    return f"Current {current_A:g} A is outside the limits {allowed}: it is {way}."

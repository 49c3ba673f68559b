"""Position, voltage, current and thermometer against what a wire within the tolerance of its file can do.

| channel | quantity | predicted | constant | tolerance | step |
|---|---|---|---|---|---|
| position | counts | position bounds | zero of the encoder | g/2 of the stroke | 0.015 of the stroke |
| voltage | ln V/I, of each wire | resistance bounds | ln of its resistance | r | 0.05 |
| current | I − command, of the largest current | 0 | its offset | 0.03 | 0.03 |
| thermometer | kelvin above ambient | temperature bounds | its offset | 0.03 of the range | 0.03 of the range |

g: ``limits.model_tolerance``. r: 0.03 of a simulated wire, which follows its file and is read at ticks,
``limits.resistance_tolerance`` of others. ``ChannelCheck`` says what cannot be.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from smarig.config import RigFile
from smarig.core import Quality, Sample
from smarig.plant import Actuator, load_of
from smarig.rig.channel import ChannelCheck
from smarig.rig.direction import Direction
from smarig.rig.least_motion import LeastMotion
from smarig.rig.resistance_motion import ResistanceMotion
from smarig.rig.response import MIN_TRAVEL, UNIT_REMEDY
from smarig.rig.rig import Alarm
from smarig.rig.wire_bounds import WireBounds

SIMULATED_TOLERANCE, HARDWARE_TOLERANCE = 0.1, 0.3  # without limits.model_tolerance
ZERO_SHARE = 0.5  # of the tolerance: uncertainty of the zero
COUNT_STEP, KELVIN_STEP = 0.015, 0.03  # of stroke and range, besides what the wire moves
FLICKERS_COUNTS = 0.3  # noise with which 300 equal samples do not occur
LEAST_STEP_COUNTS = 4  # what the last digit flickers
OHM_TOLERANCE, TWIN_OHM_TOLERANCE, OHM_STEP = 0.03, 0.06, 0.05  # effects of a twin change its resistance
AMPERE_TOLERANCE, AMPERE_STEP = 0.03, 0.03  # of the largest current
THERMOMETER_TOLERANCE = 0.03  # of the range
MIN_SHARE = 0.15  # of the largest current: a smaller one does not determine a ratio
SLOW_SHARE = 0.05  # of the command from tick to tick
STEADY_TICKS = 3  # of the command, until current and voltage have followed it
DRIFT = 0.005  # of the stroke: by how much the zero may walk while the temperature crosses its range
MOVED_SHARE = 0.02  # of the range: the wire has changed
MISSING_S = 5.0  # without a reading of a thermometer that gave some
WARN_S = 60.0  # between two warnings of jumps
_SATURATED = int(Quality.SATURATED)
UNKNOWN_OHM = -20.0  # ln of a resistance that is none


def tolerance_of(rig: RigFile) -> float:
    """``limits.model_tolerance``, or its default: simulated wires follow their files, others must be measured first."""
    if rig.limits.model_tolerance is not None:
        return rig.limits.model_tolerance
    return SIMULATED_TOLERANCE if is_simulated(rig) else HARDWARE_TOLERANCE


def is_simulated(rig: RigFile) -> bool:
    """Whether its wire and instruments are those of its files."""
    return rig.kind == "twin" or rig.simulator is not None


@dataclass(frozen=True)
class RigReadings:
    """What is known of the readings of a rig besides its file."""

    own_wire: bool = True
    """Whether the wire is that of the actuator file, and not a model that replaces it."""
    noise: bool = True
    """Whether simulated instruments have the noise of the rig file."""
    counter: bool = True
    """Whether positions are counts at the ticks of a device; else each is a reading of its own, as late as the host."""
    absolute: bool = False
    """Whether the zero of the position is that of the sensor, so that a wrong reading leaves those after it right."""


AS_IN_FILES = RigReadings()


class ChannelChecks:
    """``check`` returns the alarms of a sample; ``suspect`` tells whether it contradicts the wire or those before."""

    def __init__(self, rig: RigFile, actuator: Actuator, readings: RigReadings = AS_IN_FILES) -> None:
        limits, period_s = rig.limits, rig.period_s
        load = load_of(rig, actuator)
        force_N = load.force()(0.0) if load else None
        self.tolerance = tolerance_of(rig)
        self._name = actuator.name
        self._bounds = WireBounds(
            actuator, period_s, actuator.resolution(rig.encoder), self.tolerance, rig.ambient_degC, force_N
        )
        surface = actuator.hysteresis
        self._range_K, self._stroke = surface.upper - surface.lower, self._bounds.stroke
        self._moved_K = MOVED_SHARE * self._range_K
        self._drift_per_K = DRIFT * self._stroke / self._range_K
        zero = ZERO_SHARE * self.tolerance
        step = max(COUNT_STEP * self._stroke, LEAST_STEP_COUNTS)
        # the file states the noise of a simulated encoder; that of others is not known
        flickers = readings.noise and rig.encoder.noise_counts >= FLICKERS_COUNTS and is_simulated(rig)
        # the models of Brinson's wire do not enclose other time constants; the tolerance of the zero stands for them
        margin = step if actuator.file.thermomechanical is None else 2 * zero * self._stroke
        self._motion = LeastMotion(margin)
        self._position = ChannelCheck(
            zero * self._stroke,
            step,
            period_s,
            counter=readings.counter,
            kinds=self._bounds.kinds,
            flickers=flickers,
            motion=self._motion,
        )
        self._direction = Direction(
            self._bounds.counts_per_K, self._bounds.temperature.least_K, zero * self._stroke, self._bounds.lag
        )
        self._thermometer = ChannelCheck(
            THERMOMETER_TOLERANCE * self._range_K, KELVIN_STEP * self._range_K, period_s
        )
        ohm = OHM_TOLERANCE if is_simulated(rig) and readings.counter else limits.resistance_tolerance
        if rig.kind == "twin":
            ohm = TWIN_OHM_TOLERANCE
        self._voltages = [ChannelCheck(ohm, OHM_STEP, period_s, moves=False) for _ in range(2)]
        self._current = ChannelCheck(AMPERE_TOLERANCE, AMPERE_STEP, period_s)
        self._all = {
            "position": self._position,
            "thermometer": self._thermometer,
            "voltage": self._voltages[0],
            "voltage of wire 2": self._voltages[1],
            "current": self._current,
        }
        self._one_wire = not actuator.two_wire
        self._position_known = readings.own_wire and (load is None or not load.changes)
        low, high = actuator.resistance_range_ohm
        self._ohm_per_stroke = math.log(high / low)
        # of two wires, one lengthens by what the other shortens; a load that changes moves a wire at any phase
        range_ln = self._ohm_per_stroke if self._one_wire and self._position_known else 0.0
        self.transformation = ResistanceMotion(range_ln, MIN_TRAVEL * self._stroke, self._moved_K)
        self._largest_A = max(limits.current_max_A, -limits.current_min_A)
        self._min_A = MIN_SHARE * self._largest_A
        self._follows_file = is_simulated(rig)
        self._wire_known, self._absolute = readings.own_wire, readings.absolute
        self._ticks, self._may_change_K = 0, 0.0  # since the last sample
        self._electrical_ticks, self._electrical_share = 0, 0.0  # since the last beat
        self._steady, self._command_A = 0, 0.0
        self._changed_from_K = dict.fromkeys(self._all, 0.0)
        self._missing, self._warn_from = 0, 0
        self._missing_ticks, self._warn_ticks = round(MISSING_S / period_s), round(WARN_S / period_s)
        self.suspect = False

    def pass_ticks(self, heating_A: float, ticks: int) -> None:
        """Time in which the wire carried a current, up to the tick of the next sample."""
        bounds, kelvin = self._bounds, self._may_change_K
        for _ in range(ticks):
            kelvin += bounds.step(heating_A)
        self._may_change_K = kelvin
        self._ticks += ticks

    def check(self, s: Sample, input_K: float) -> list[Alarm]:
        """Alarms of a sample after the ticks that were passed since the last one."""
        self.suspect = False
        ticks, kelvin = self._ticks, self._may_change_K
        self._ticks, self._may_change_K = 0, 0.0
        counts = self._bounds.counts_per_K * kelvin
        self._position.widen(self._drift_per_K * kelvin)
        found: list[Alarm] = []
        positions = self._bounds.positions
        beat = positions is not None
        if self._position_known:
            if beat:
                self._direction.add(self._bounds.temperature, s.counts)
            self._motion.add(s.counts, self._bounds.like_positions if beat else None, ticks)
            self.transformation.add_counts(s.counts, s.tick)
            found += self._of("position", s.counts, positions, counts, s.tick, ticks, input_K)
        if beat:
            found += self._check_transformation(s, input_K)
        self._steady = self._steady + ticks if s.current_command_A == self._command_A else 0
        self._command_A = s.current_command_A
        self._electrical_ticks += ticks
        self._electrical_share += counts / self._stroke
        if self._wire_known and beat:
            found += self._check_electrical(s, input_K)
        first, second = self._voltages
        if self._current.suspect or first.suspect or second.suspect:
            self.suspect = True
        measured = s.temperature_degC == s.temperature_degC  # no NaN
        if self._one_wire and (measured or self._thermometer.flicker.n):
            found += self._check_thermometer(s, kelvin, ticks, input_K)
        return found

    def _check_electrical(self, s: Sample, input_K: float) -> list[Alarm]:
        """At every beat: what happens faster, ``ElectricalPlausibility`` sees."""
        ticks, share = self._electrical_ticks, self._electrical_share
        self._electrical_ticks, self._electrical_share = 0, 0.0
        known = min(abs(s.current_command_A), abs(s.current_A)) >= self._min_A
        if self._steady < STEADY_TICKS or not known:
            for channel in (*self._voltages, self._current):
                channel.pause()
            return []
        found = []
        if not s.quality & _SATURATED:
            value = (abs(s.current_A) - abs(s.current_command_A)) / self._largest_A
            found += self._of("current", value, [(0.0, 0.0)], 0.0, s.tick, ticks, input_K)
        second = s.current_A < 0 and not self._one_wire
        ohm = s.voltage_V / s.current_A
        if not math.isnan(ohm):
            low, high = self._bounds.resistance_ohm(s.current_A)
            rate = share * self._ohm_per_stroke
            value = math.log(ohm) if ohm > 0 else UNKNOWN_OHM
            name = "voltage of wire 2" if second else "voltage"
            found += self._of(name, value, [(math.log(low), math.log(high))], rate, s.tick, ticks, input_K)
        return found

    def _check_transformation(self, s: Sample, input_K: float) -> list[Alarm]:
        """At a beat, at currents that change slowly enough for a voltage and a current read one after the other."""
        slowly = abs(s.current_command_A - self._command_A) <= SLOW_SHARE * abs(s.current_command_A)
        known = slowly and s.current_A >= self._min_A and not s.quality & _SATURATED
        if not known or not s.voltage_V > 0:  # nor NaN
            return []
        unmoved = self.transformation.unmoved
        self.transformation.add(math.log(s.voltage_V / s.current_A), input_K)
        self.suspect |= self.transformation.unmoved
        if unmoved or not self.transformation.unmoved:
            return []
        text = (
            f"The resistance of the wire changed by {100 * math.expm1(self.transformation.changed):.0f} %, as by a "
            f"transformation, and the position hardly moved: one of them is wrong. Check {_REMEDY['position']}; "
            f"and {_REMEDY['voltage']}."
        )
        return [Alarm("error", "still", text, self.transformation.from_tick)]

    def _check_thermometer(self, s: Sample, rate_K: float, ticks: int, input_K: float) -> list[Alarm]:
        measured_K = s.temperature_degC - s.ambient_degC
        if math.isnan(measured_K):
            given = self._thermometer.flicker.n > 0
            self._missing += ticks if given else 0
            self.suspect |= given
            if self._missing - ticks < self._missing_ticks <= self._missing:
                return [
                    Alarm(
                        "error",
                        "lost",
                        f"The thermometer has given no reading for {MISSING_S:g} s. Check its line.",
                    )
                ]
            return []
        self._missing = 0
        t = self._bounds.temperature
        bounds = [t.between(1 - self.tolerance, 1 + self.tolerance)]
        return self._of("thermometer", measured_K, bounds, rate_K, s.tick, ticks, input_K)

    def _of(
        self,
        name: str,
        value: float,
        bounds: Sequence[tuple[float, float]] | None,
        rate: float,
        tick: int,
        ticks: int,
        input_K: float,
    ) -> list[Alarm]:
        """The alarms of one channel."""
        channel = self._all[name]
        if channel.flicker.run == 0:  # the reading has just changed
            self._changed_from_K[name] = input_K
        changes = abs(input_K - self._changed_from_K[name]) > self._moved_K
        against = name == "position" and self._direction.against
        must_move = self.transformation.must_move if name == "position" and not self._follows_file else True
        channel.add(value, bounds, rate, ticks=ticks, changes=changes, against=against, must_move=must_move)
        if not channel.suspect and not channel.fault:
            return []
        self.suspect = self.suspect or channel.suspect
        if channel.fault:
            doubtful_from = tick - channel.doubtful_ticks
            return [Alarm("error", channel.fault, self._text(name, channel), doubtful_from)]
        if channel.stands and not must_move and tick >= self._warn_from:
            self._warn_from = tick + self._warn_ticks
            return [
                Alarm("warning", "frozen", f"{self._text_of_frozen(name)} Its readings are marked meanwhile.")
            ]
        if channel.jump and tick >= self._warn_from:
            self._warn_from = tick + self._warn_ticks
            which = "Readings from here on" if name == "position" and not self._absolute else "This reading"
            text = f"{self._jump_text(name, channel)} {which} may be off by as much."
            return [Alarm("warning", "jump", text)]
        return []

    def _jump_text(self, name: str, channel: ChannelCheck) -> str:
        whole = f" (its stroke is {self._stroke:.0f} counts)" if name == "position" else ""
        time = "one tick" if channel.ticks == 1 else f"{channel.ticks} ticks"
        return f"The {name} jumped by {self._amount(name, channel.jump)} in {time}, faster than the wire can{whole}."

    def _text(self, name: str, channel: ChannelCheck) -> str:
        check = f" Check {_REMEDY[name]}."
        if channel.fault == "jump":
            return self._jump_text(name, channel) + check
        if channel.fault == "frozen":
            return self._text_of_frozen(name)
        if channel.fault == "reversed":
            return f"The {name} moves in the other direction than the wire can.{check}"
        return (
            f"The {name} is {self._amount(name, channel.gap)} away from all that a wire within "
            f"limits.model_tolerance = {self.tolerance:g} of {self._name} can have here, after the readings before."
            f"{check} If they are in order, calibrate the wire, or raise that limit."
        )

    def _text_of_frozen(self, name: str) -> str:
        """Of a wire that is not simulated, it need not be the sensor."""
        text = f"The {name} stays the same to the last digit while the temperature of the wire changes."
        text += f" Check {_REMEDY[name]}."
        if name != "position" or self._follows_file:
            return text
        return f"{text} If they are in order, the wire rests here and its model does not: raise limits.model_tolerance."

    def _amount(self, name: str, by: float) -> str:
        if name == "position":
            return f"{by:.0f} counts"
        if name == "thermometer":
            return f"{by:.1f} K"
        return f"{by * self._largest_A:.3g} A" if name == "current" else f"{100 * math.expm1(by):.0f} %"

    def forget(self) -> None:
        """The constants are others now: the encoder was zeroed, or the wire may be in another state than assumed."""
        self._direction.forget()
        self.transformation.forget()
        for channel in self._all.values():
            channel.forget()

    def zeroed(self) -> None:
        """The encoder was zeroed."""
        self._direction.forget()
        self.transformation.forget()
        self._position.forget()

    def rearmed(self) -> None:
        """A trip was cleared: what persists must trip again."""
        self._direction.forget()
        self.transformation.forget()
        for channel in self._all.values():
            channel.rearm()


_REMEDY = {
    "position": f"encoder, coupling, cable and wire, {UNIT_REMEDY}",
    "thermometer": "thermometer, shunt and cooling",
    "voltage": "clamps, voltage leads and shunt",
    "voltage of wire 2": "clamps, voltage leads and shunt",
    "current": "amplifier and shunt",
}

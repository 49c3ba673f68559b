"""The bench: a current source and an encoder on separate lines, joined by their ticks into samples.

    source tick of encoder tick k = k + offset        offset: read when both are opened, then followed

In lock-step (simulated devices) a request lets time pass; on hardware the bench waits for the next tick.
"""

import contextlib
import math
import time
from collections.abc import Callable

from smarig.config import RigFile
from smarig.core import LeaseExpired, Quality, RigFault, Sample, renew_watch
from smarig.device import (
    OFF_PAUSE_S,
    AbsoluteZero,
    CurrentReading,
    CurrentSource,
    Garbled,
    PositionReading,
    PositionSensor,
    Silent,
    number_from,
)
from smarig.plant import Actuator
from smarig.rig.electrical_plausibility import read_back_tolerance_A
from smarig.rig.force_check import ForceCheck
from smarig.rig.force_statistics import ForceStatistics
from smarig.rig.further_sensors import FurtherSensors
from smarig.rig.order_record import OrderRecord
from smarig.rig.rig import Alarm
from smarig.rig.room_temperature import RoomTemperature
from smarig.rig.shutdown import after_shutdown
from smarig.rig.source_shutdown import SourceShutdown

CLOCK_CHECK_TICKS = 300  # ticks between two comparisons of both clocks
CLOCK_READS = 6  # attempts to read both clocks within one tick, and the same twice
MAX_BLOCK_TICKS = 12  # largest number of samples of one request: one window of the amplifier
MAX_TICK_GAP = 1_000_000  # a larger gap means wrong ticks, not a late host
SENSOR_TIMEOUT_S = 2.0  # without a sample; after that the sensor counts as lost
_OVER = int(Quality.TRIPPED | Quality.STALE)


class Bench:
    """A rig made of instruments.

    ``speed``: device seconds per second of the clock; 0 if the devices wait for the host (lock-step).
    """

    def __init__(
        self,
        rig: RigFile,
        actuator: Actuator,
        source: CurrentSource,
        sensor: PositionSensor,
        further: FurtherSensors | None = None,
        *,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.file, self.actuator = rig, actuator
        self.source, self.sensor = source, sensor
        self.further = further or FurtherSensors()
        self._has_further = self.further.present
        self.force, self._force_check = ForceStatistics(), ForceCheck(actuator, rig.period_s)
        self.counts_ticks = True  # whether the source tells when it switched itself off
        self.position_per_count = actuator.resolution(rig.encoder)
        self.lock_step = speed == 0
        self._tick_s = 0.0 if self.lock_step else rig.period_s / speed
        lease = round(rig.lease_s / rig.period_s)
        self._block = max(1, min(MAX_BLOCK_TICKS, lease - 1))  # ticks that may pass without a command
        self._clock, self._sleep = clock, sleep
        self.tick = sensor.tick()
        self._offset = self._ticks_apart()
        self._next_clock_check = self.tick + CLOCK_CHECK_TICKS
        self._due_s = clock()
        self._command_A = 0.0
        self._orders = OrderRecord()
        self._last: CurrentReading | None = None
        self._room = RoomTemperature(rig)
        self._alarms: list[Alarm] = []
        self._reconnections = {"amplifier": 0, "encoder": 0}  # reported so far
        self._pending_readings: list[PositionReading] = []  # read before a zero and not yet returned
        self._fault: RigFault | None = None  # after a trip
        self._sampled = False
        self._shutdown = SourceShutdown(
            source,
            read_back_tolerance_A(rig.limits, rig.amplifier),
            lambda: self._sleep(max(OFF_PAUSE_S, self._tick_s)),  # the next reading is another one
        )

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.file.period_s

    @property
    def has_lease(self) -> bool:
        """Whether the source switches itself off when the host stops communicating."""
        return self.source.has_lease

    @property
    def holds_wire_limit(self) -> bool:
        """Whether the source measures the wire temperature and can limit it by itself."""
        return getattr(self.source, "holds_wire_limit", False)

    @property
    def measures_ambient(self) -> bool:
        """Whether the ambient temperature of the samples is measured; else it is that of the rig file."""
        return self.further.room is not None or getattr(self.sensor, "measures_ambient", False)

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Apply a current from the next tick on. Returns the samples since the last call, at least one."""
        if self._fault is not None:
            raise self._fault
        renew_watch()
        if current_A != self._command_A:
            self._set(current_A)
        positions = self._read_positions(min(at_most, self._block))
        currents = self._read_currents(positions)
        self.tick = positions[-1].tick
        if self._tick_s and self.tick >= self._next_clock_check:
            self._update_offset()
        samples = tuple(self._join(p, c) for p, c in zip(positions, currents))
        last_quality = samples[-1].quality
        if self._has_further:
            samples = self._with_force(self.further.added_to(samples))
        self._room.add(samples[-1].ambient_degC, samples[-1].tick)  # the guard warns
        if self._command_A and getattr(self.source, "lacks_wire_limit", False):
            self._limit_late()
        self._note_fault(last_quality)  # after it, all samples before a trip are returned
        return samples

    def _with_force(self, samples: tuple[Sample, ...]) -> tuple[Sample, ...]:
        """The samples, marked if no wire carries the force that is measured with them."""
        force_N = self.further.force_N()
        self._alarms += self._force_check.add(force_N, samples[-1].tick)
        if self._force_check.suspect:
            return tuple(s._replace(quality=s.quality | int(Quality.SUSPECT)) for s in samples)
        self.force.add(force_N)
        return samples

    def _note_fault(self, last_quality: int) -> None:
        """Keep why the next step is refused. A device that drives something else is switched off."""
        if self._orders.contradiction or (self.source.tripped and last_quality & Quality.SUSPECT):
            reason = self.source.tripped or self._orders.contradiction  # the device's own comes first
            self.safe()
            self._fault = after_shutdown(RigFault(reason), self)
            self._alarms.append(Alarm("error", "contradiction", str(self._fault)))
        elif self.source.tripped and last_quality & _OVER:
            self._fault = LeaseExpired(self.source.tripped)

    def _set(self, current_A: float) -> None:
        """Send a current and keep the one before: samples that are still to be read belong to it."""
        limit = getattr(self.source, "limit_wire_temperature", None)
        if limit is not None and self.holds_wire_limit:
            self._hand_over_wire_limit(limit)
        last = self.source.set(current_A)
        self.counts_ticks = last is not None
        if last is not None:
            self._orders.changed(self._command_A, last)
        self._command_A = current_A

    def _limit_late(self) -> None:
        """Arm again, with the limit of a thermometer that gave its first reading after arming. The present command is
        the first, which the rate limit allows from zero.
        """
        command_A = self._command_A
        self.source.arm()
        self._orders.changed(command_A, self.source.tick())
        self._command_A = 0.0
        self._set(command_A)

    def _hand_over_wire_limit(self, limit_wire_temperature: Callable[[float], None]) -> None:
        """Let the source hold ``temperature_max_K`` as well, above the ambient temperature of this moment."""
        if not self._room.known:  # no sample yet
            ambient_degC = next((p.ambient_degC for p in self.sensor.since(self.tick, 1)), math.nan)
            if self.further.room:
                ambient_degC = number_from(self.further.room, "temperature_degC")
            self._room.add(ambient_degC, self.tick)
        limit_wire_temperature(self._room.degC + self.file.limits.temperature_max_K)

    def _read_positions(self, at_most: int) -> list[PositionReading]:
        """Readings of the encoder since the last call; on hardware, waits for its next tick."""
        if self._pending_readings:
            found, self._pending_readings = self._pending_readings, []
            return found
        wanted = at_most if self.lock_step else self._block
        self._due_s += self._tick_s
        wait_s = self._due_s - self._clock()
        if wait_s > 0:
            self._sleep(wait_s)
        give_up_s = self._clock() + SENSOR_TIMEOUT_S
        while True:
            found = self.sensor.since(self.tick + 1, wanted)
            if found:
                break
            if self._clock() > give_up_s:
                raise Silent(
                    f"The encoder returned no new sample within {SENSOR_TIMEOUT_S:g} s. {Silent.remedy}"
                )
            self._due_s = self._clock() + self._tick_s / 8  # its clock is slightly late: adjust to it
            self._sleep(self._tick_s / 8)
        lost = found[0].tick - self.tick - 1
        if lost > MAX_TICK_GAP:
            raise Garbled(
                f"The encoder's tick jumped by {lost}. Its ticks are not reliable. {Garbled.remedy}"
            )
        if lost and self._sampled:  # before the first sample nothing was recorded that could be lost
            count = "1 sample was" if lost == 1 else f"{lost} samples were"
            text = f"{count} lost because the position was not read in time. If this repeats, raise period_s."
            self._alarms.append(Alarm("warning", "lost", text))
        self._sampled = True
        return found

    def _read_currents(self, positions: list[PositionReading]) -> list[CurrentReading]:
        """Readings of the source at the same ticks. A missing reading repeats the last one, marked as stale."""
        first = positions[0].tick + self._offset
        by_tick: dict[int, CurrentReading] = {}
        for attempt in range(3):
            more = self.source.since(first + len(by_tick), len(positions) - len(by_tick))
            by_tick |= {c.tick - self._offset: c for c in more}
            if all(p.tick in by_tick for p in positions) or not self._tick_s:
                break
            self._sleep(self._tick_s / 4 if attempt < 2 else 0)
        found = []
        for p in positions:
            reading = by_tick.get(p.tick)
            if reading is None:
                last = self._last or CurrentReading(0, float("nan"), float("nan"), float("nan"), Quality.GOOD)
                reading = last._replace(quality=last.quality | Quality.STALE)
            self._last = reading
            found.append(reading)
        if any(p.tick not in by_tick for p in positions):
            self._offset = min(self._ticks_apart(), self._offset)  # the source's clock is slower
        self._orders.read_until(found[-1].tick)
        return found

    def _ticks_apart(self) -> int:
        """The source's tick minus the encoder's at one moment. A late or changed reply would join different ticks."""
        found: list[int] = []
        for _ in range(CLOCK_READS):
            before, sensor, after = self.source.tick(), self.sensor.tick(), self.source.tick()
            found.append(after - sensor)
            if before == after and found.count(after - sensor) > 1:
                return after - sensor
        return min(found, key=lambda apart: (-found.count(apart), apart))  # too slow for that

    def _update_offset(self) -> None:
        """Adjust the offset when the clocks drift; one tick of difference comes from the two reads."""
        self._next_clock_check = self.tick + CLOCK_CHECK_TICKS
        ahead = self._ticks_apart() - self._offset
        if abs(ahead) > 1:
            self._offset += ahead - (1 if ahead > 0 else -1)

    def _join(self, p: PositionReading, c: CurrentReading) -> Sample:
        command_A, agrees = self._orders.at(c, self._command_A)
        return Sample(
            tick=p.tick,
            t_s=p.tick * self.file.period_s,
            current_command_A=command_A,
            current_A=c.current_A,
            voltage_V=c.voltage_V,
            temperature_degC=c.temperature_degC,
            counts=p.counts,
            position=p.counts * self.position_per_count,
            ambient_degC=p.ambient_degC,
            quality=int(p.quality | c.quality) | (0 if agrees else int(Quality.SUSPECT)),
        )

    def alarms(self) -> list[Alarm]:
        """Alarms since the last call."""
        self._note_reconnections()
        alarms, self._alarms = self._alarms, []
        return alarms

    def _note_reconnections(self) -> None:
        """A line that comes back is reported. Drivers need not count."""
        for name, device in (("amplifier", self.source), ("encoder", self.sensor)):
            count = getattr(device, "reconnections", 0)
            if count != self._reconnections[name]:
                self._reconnections[name] = count
                text = f"The line to the {name} was lost and opened again. Check cable and supply."
                self._alarms.append(Alarm("warning", "reconnected", text))

    def zero(self) -> None:
        """Zero the encoder at its present position; readings not yet returned are converted to the new zero."""
        pending = [] if self.lock_step else self._read_positions(self._block)
        self.sensor.zero()
        self._pending_readings = [p._replace(counts=p.counts - pending[-1].counts) for p in pending]

    @property
    def timed_by_host(self) -> bool:
        """Whether the position is read when the host asks, not at a tick of the device."""
        return getattr(self.sensor, "timed_by_host", False)

    @property
    def absolute_zero(self) -> AbsoluteZero | None:
        """The zero of a sensor that keeps it through a restart; None for others."""
        return getattr(self.sensor, "absolute_zero", None)

    def idle(self, seconds: float) -> None:
        """Send the source no command for this time, so that its lease expires. Later steps return the samples."""
        if self.lock_step:
            self._let_pass(round(seconds / self.period_s))
        else:
            self._sleep(seconds * self._tick_s / self.period_s)
        self._due_s = self._clock()

    def _let_pass(self, ticks: int) -> None:
        """In lock-step, let ticks pass by requesting samples; the encoder's ring keeps them."""
        last = self.tick
        end = max(last, self.sensor.tick()) + ticks
        while last < end:
            found = self.sensor.since(last + 1, min(MAX_BLOCK_TICKS, end - last))
            if not found:
                raise Silent(f"The encoder returned no new sample. {Silent.remedy}")
            last = found[-1].tick

    def identity(self) -> list[str]:
        """One line for each instrument, also if it has several roles."""
        sensor = getattr(self.sensor, "instrument", self.sensor.identity)
        return list(dict.fromkeys([self.source.identity, sensor, *self.further.identities()]))

    def arm(self) -> None:
        """Clear a trip; the output stays at zero until the next step."""
        self.source.arm()
        self._orders.changed(self._command_A, self.source.tick())
        self._command_A, self._fault, self._orders.contradiction = 0.0, None, ""

    def safe(self) -> None:
        """Set the current to zero. Never raises; without a connection the lease does it."""
        before_A, self._command_A = self._command_A, 0.0
        if self._shutdown.order_off():
            with contextlib.suppress(BaseException):
                self._orders.changed(before_A, self.source.tick())

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why the source may still be on; "" if it is off."""
        return self._shutdown.unconfirmed

    def confirm_zero(self) -> str:
        """After ``safe``: measure whether the current has ended. Never raises. Lock-step has no time to wait for."""
        return "" if self.lock_step else self._shutdown.measure()

    def close(self) -> None:
        """Close all lines."""
        self.source.close()
        self.sensor.close()
        self.further.close()

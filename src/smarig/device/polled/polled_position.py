"""A position that is queried, as the position sensor of a bench: sampled by the host's clock, in counts of the rig."""

import math

from smarig.config import RigFile
from smarig.core import NAN, ConfigError, Quality, one_line
from smarig.device.encoding.link_faults import Garbled
from smarig.device.links.query import LARGEST
from smarig.device.polled.host_clock import HostClock
from smarig.device.polled.line_counts import garbled_remedy, reconnections_of, repeats_of
from smarig.device.polled.readings import number_from
from smarig.device.roles.polled import PositionInput, TemperatureInput
from smarig.device.roles.ticked import AbsoluteZero, PositionReading
from smarig.plant import Actuator

LONGEST_GAP_S = 2.0  # without a valid reading; after it the sensor counts as lost
_LONGEST_UNIT = 40  # of another driver's, in a message
REPEATS_AT_START = 3  # readings tried before the first position is known


class PolledPosition:
    """``count = round((y − y₀)/resolution)``: the resolution is ``[encoder] resolution`` of the rig file.

    A tick has one reading, taken when it is queried for; ticks that the host missed have none. A late reply belongs to
    the tick in which it came: the query may have been repeated. ``room``: a thermometer
    of the room; without one, the rig file's ``ambient_degC`` is recorded.
    """

    timed_by_host = True  # a reading is as late as the host, and wrong by itself only

    def __init__(
        self,
        sensor: PositionInput,
        rig: RigFile,
        clock: HostClock | None = None,
        room: TemperatureInput | None = None,
    ) -> None:
        self.sensor, self._room, self._clock = sensor, room, clock or HostClock(rig)
        self._per_count, self._ambient_degC = _per_count(sensor, rig), rig.ambient_degC
        self._gap = max(1, round(LONGEST_GAP_S / rig.period_s))
        self._zero = self._raw = 0
        self._missing = 0
        self._repeats = repeats_of(sensor)
        for _ in range(REPEATS_AT_START):
            if self._update():
                break
        else:
            raise Garbled(
                f"{sensor.identity} gives no position. Check that its target is in range. {garbled_remedy(sensor)}"
            )

    @property
    def instrument(self) -> str:
        """The sensor, whatever counts its ticks."""
        return self.sensor.identity

    @property
    def identity(self) -> str:
        """The sensor, and the clock that counts its ticks."""
        return f"{self.sensor.identity}, {self._clock.started}"

    @property
    def measures_ambient(self) -> bool:
        """Whether a thermometer of the room gives the ambient temperature."""
        return self._room is not None

    @property
    def absolute_zero(self) -> AbsoluteZero | None:
        """The count of an absolute sensor at which the position is 0; None if the sensor is not absolute."""
        if not getattr(self.sensor, "absolute", False):
            return None
        return AbsoluteZero(self.sensor.identity, self._zero)

    @property
    def reconnections(self) -> int:
        """How often its line was lost and opened again, if it counts that."""
        return reconnections_of(self.sensor)

    def since(self, tick: int, at_most: int) -> list[PositionReading]:
        """The reading of the present tick, which is that of its reply, if it is not earlier than ``tick``."""
        if self._clock.tick() < tick or at_most < 1:
            return []
        quality = Quality.GOOD if self._update() else Quality.SUSPECT
        now = self._clock.tick()
        if repeats_of(self.sensor) != self._repeats:
            self._repeats, quality = repeats_of(self.sensor), quality | Quality.RETRIED
        room_degC = number_from(self._room, "temperature_degC") if self._room else NAN
        return [
            PositionReading(
                now,
                self._raw - self._zero,
                room_degC if math.isfinite(room_degC) else self._ambient_degC,
                quality,
            )
        ]

    def tick(self) -> int:
        """The present tick of the host."""
        return self._clock.tick()

    def zero(self) -> None:
        """Count from the present position on."""
        if not self._update():
            raise Garbled(
                f"{self.sensor.identity} gives no position to start from. {garbled_remedy(self.sensor)}"
            )
        self._zero = self._raw

    def close(self) -> None:
        """Close the lines."""
        self.sensor.close()
        if self._room is not None:
            self._room.close()

    def _update(self) -> bool:
        """Read; a reading that does not exist or is larger than any keeps the last one. Raises Garbled after
        ``LONGEST_GAP_S`` of them.
        """
        counts = number_from(self.sensor, "position") / self._per_count
        if abs(counts) < LARGEST:  # false for NaN
            self._raw, self._missing = round(counts), 0
            return True
        self._missing += 1
        if self._missing > self._gap:
            raise Garbled(
                f"{self.sensor.identity} has given no position for {LONGEST_GAP_S:g} s. Check that its target is in "
                f"range. {garbled_remedy(self.sensor)}"
            )
        return False


def _per_count(sensor: PositionInput, rig: RigFile) -> float:
    """The size of a count in the sensor's own unit. Raises ConfigError if rig file and sensor do not fit."""
    if sensor.unit == "count":
        return 1.0
    unit = Actuator.named(rig.actuator).unit
    if sensor.unit != unit:
        measured = one_line(str(sensor.unit), _LONGEST_UNIT)
        raise ConfigError(
            f"{sensor.identity} measures in {measured}, but the wire of rig '{rig.name}' moves in {unit}. "
            f"Name a rig whose wire moves in {measured}."
        )
    if rig.encoder.resolution is None:
        raise ConfigError(
            f"{sensor.identity} measures in {unit}. Give encoder.resolution in the file of rig '{rig.name}', in "
            f"{unit}: three to five times the noise of a reading, and no less than the smallest step of the sensor."
        )
    return rig.encoder.resolution

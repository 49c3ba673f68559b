"""The temperature of the room as far as a room can have it: limits above ambient rest on it, not on any reading.

    |reading − ambient_degC of the rig file| ≤ 30 K        else the reading is that of no room with this rig file
    |reading − θ| ≤ 5 K                                    θ: follows the readings by 3 K/min at most

A reading that is neither is suspect. θ follows it downwards only, so that no such reading makes a limit higher.
"""

import math

from smarig.config import RigFile
from smarig.rig.rig import Alarm

FROM_FILE_K = 30.0  # 22 °C in a file is any room in which people work; a chamber has its own rig file
CHANGE_K_PER_S = 0.05  # a chamber at 3 K/min; rooms change more slowly
LAG_K = 5.0  # of θ: a draught, the warmth of a hand, the noise of a thermometer
WARN_S = 60.0  # between two warnings


class RoomTemperature:
    """``add`` takes a reading; ``suspect`` tells whether no room can have it, and ``degC`` is θ."""

    def __init__(self, rig: RigFile) -> None:
        self.degC = self._file_degC = rig.ambient_degC
        self._period_s = rig.period_s
        self._tick: int | None = None  # of the last reading that a room can have; None before the first
        self._warn_from = -math.inf
        self.suspect = False

    @property
    def known(self) -> bool:
        """Whether it was measured; else it is that of the rig file."""
        return self._tick is not None

    def add(self, reading_degC: float, tick: int) -> list[Alarm]:
        """A reading, NaN if there is none. The warning that it is the first to justify, as a list."""
        change_K = reading_degC - self.degC
        self.suspect = abs(reading_degC - self._file_degC) > FROM_FILE_K
        if not self.suspect and change_K == change_K:  # no NaN
            self._follow(change_K, tick)
        if not self.suspect or tick < self._warn_from:
            return []
        self._warn_from = tick + WARN_S / self._period_s
        text = (
            f"The thermometer of the room reads {reading_degC:.4g} °C, which a room of {self.degC:.1f} °C with "
            f"ambient_degC = {self._file_degC:g} in its rig file cannot have. Limits are those of a room of "
            f"{self.degC:.1f} °C. Check the thermometer; if it is right, correct ambient_degC and start again."
        )
        return [Alarm("warning", "room", text)]

    def _follow(self, change_K: float, tick: int) -> None:
        if self._tick is None:  # the file may be as far off
            self._tick, self.degC = tick, self.degC + change_K
            return
        most_K = CHANGE_K_PER_S * self._period_s * (tick - self._tick)
        self._tick = tick
        self.suspect = abs(change_K) > LAG_K + most_K
        if not self.suspect or change_K < 0:
            self.degC += change_K if -most_K <= change_K <= most_K else math.copysign(most_K, change_K)

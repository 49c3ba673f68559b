"""A reading of the load cell against the force at which the wire breaks: a larger one is none of this wire."""

import math

from smarig.plant import BREAKING_STRESS_MPA, Actuator
from smarig.rig.rig import Alarm

WARN_S = 60.0  # between two warnings


class ForceCheck:
    """``add`` takes a reading; ``suspect`` tells whether no wire carries it, whichever way round the cell is."""

    def __init__(self, actuator: Actuator, period_s: float) -> None:
        self._largest_N = BREAKING_STRESS_MPA * math.pi / 4 * actuator.file.wire.diameter.value**2
        self._warn_ticks, self._warn_from = WARN_S / period_s, -math.inf
        self.suspect = False

    def add(self, force_N: float, tick: int) -> list[Alarm]:
        """A reading, NaN if there is none. The warning that it is the first to justify, as a list."""
        self.suspect = abs(force_N) > self._largest_N
        if not self.suspect or tick < self._warn_from:
            return []
        self._warn_from = tick + self._warn_ticks
        text = (
            f"The load cell reads {force_N:.4g} N, but the wire breaks below {self._largest_N:.3g} N "
            f"({BREAKING_STRESS_MPA:g} MPa). The reading is not used. Check the load cell, its unit and wire.diameter."
        )
        return [Alarm("warning", "force", text)]

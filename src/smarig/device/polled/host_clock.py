"""Ticks of the host, for sensors that count none."""

import time
from collections.abc import Callable

from smarig.config import RigFile

ROUNDING = 1e-6  # of a tick


class HostClock:
    """Counts periods of the rig since it was made; ``started`` tells one clock from another.

    With ``[simulator] speed`` its seconds pass as much faster as those of the simulated devices.
    """

    def __init__(self, rig: RigFile, clock: Callable[[], float] = time.monotonic) -> None:
        speed = rig.simulator.speed if rig.simulator and rig.simulator.speed > 0 else 1.0
        self._tick_s, self._clock = rig.period_s / speed, clock
        self._begin_s = clock()
        self.started = f"clock of the host since {time.time():.3f}"

    def tick(self) -> int:
        """Complete periods since the start."""
        return int((self._clock() - self._begin_s) / self._tick_s + ROUNDING)

"""A rig held to real time × speed, for watching and for demonstrations; otherwise twins run free."""

import time
from collections.abc import Callable

from smarig.rig.rig import Rig
from smarig.sample import Sample


class Paced:
    """A rig whose ticks come no faster than period/speed on a clock that is injected."""

    def __init__(
        self,
        rig: Rig,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.rig, self._clock, self._sleep = rig, clock, sleep
        self._tick_s = rig.period_s / speed
        self._next_s = clock()

    @property
    def period_s(self) -> float:
        """Length of a tick in device time."""
        return self.rig.period_s

    def step(self, current_A: float) -> tuple[Sample, ...]:
        """Wait for the tick, then step; a late caller is not made to catch up."""
        now = self._clock()
        self._next_s = max(self._next_s + self._tick_s, now)
        if self._next_s > now:
            self._sleep(self._next_s - now)
        return self.rig.step(current_A)

    def zero(self) -> None:
        """Zero the encoder."""
        self.rig.zero()

    def safe(self) -> None:
        """Current to zero."""
        self.rig.safe()

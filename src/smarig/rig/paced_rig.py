"""A rig that runs at a given speed relative to real time, for watching and demonstrations."""

import time
from collections.abc import Callable

from smarig.core import Sample, UsageError
from smarig.rig.rig import Alarm, Rig

_SLOWEST, _FASTEST = 1e-3, 1e6


class PacedRig:
    """A rig whose ticks come no faster than period/speed on an injected clock."""

    def __init__(
        self,
        rig: Rig,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        while_waiting: Callable[[], None] = lambda: None,
    ) -> None:
        if not _SLOWEST <= speed <= _FASTEST:
            raise UsageError(
                f"Speed {speed:g} is outside the range {_SLOWEST:g}…{_FASTEST:g} (1 is real time)."
            )
        self.rig, self._clock, self._sleep = rig, clock, sleep
        self._while_waiting = while_waiting  # may raise, so that a stop does not wait for a slow tick
        self._tick_s = rig.period_s / speed
        self._next_s = clock()

    @property
    def period_s(self) -> float:
        """Length of a tick in device time."""
        return self.rig.period_s

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Wait for the tick, then step. A late caller does not catch up."""
        now = self._clock()
        self._next_s = max(self._next_s + self._tick_s, now)
        while self._next_s > now:
            self._while_waiting()
            self._sleep(min(self._next_s - now, 0.1))
            now = self._clock()
        return self.rig.step(current_A, at_most)

    @property
    def tick(self) -> int:
        """The tick of the last sample."""
        return self.rig.tick

    @property
    def position_per_count(self) -> float:
        """mm or degrees of one count."""
        return self.rig.position_per_count

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why a device may still be on; "" if it is off."""
        return self.rig.shutdown_unconfirmed

    def alarms(self) -> list[Alarm]:
        """Alarms of the rig since the last call."""
        return self.rig.alarms()

    def close(self) -> None:
        """Close the rig."""
        self.rig.close()

    def zero(self) -> None:
        """Zero the encoder."""
        self.rig.zero()

    def safe(self) -> None:
        """Set the current to zero."""
        self.rig.safe()

    def arm(self) -> None:
        """Clear a latched trip."""
        self.rig.arm()

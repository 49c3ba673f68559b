"""Has the host slept, or has somebody set its clock? Wall clock against steady clock, and against the device's.

The steady clock of a host stands still while the host is suspended and knows nothing of clocks that are set; the
device's ticks go on. Knows clocks only; refuses to know what is recorded.
"""

import time
from collections.abc import Callable

MIN_JUMP_S = 2.0  # a smaller jump is a clock that is being disciplined


class ClockWatch:
    """Asked now and then; ``real_time``: the device's seconds are ours, so its ticks can be compared, too."""

    def __init__(
        self,
        *,
        real_time: bool = False,
        wall: Callable[[], float] = time.time,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        self._real_time, self._wall, self._steady = real_time, wall, steady
        self._wall_offset_s = wall() - steady()
        self._device_offset_s: float | None = None

    def jump(self, device_s: float) -> str:
        """A sentence when the clocks have parted since the last time, else ""; each jump is told once."""
        wall, steady = self._wall(), self._steady()
        jumped_s, self._wall_offset_s = wall - steady - self._wall_offset_s, wall - steady
        previous_s, self._device_offset_s = self._device_offset_s, device_s - steady
        if abs(jumped_s) > MIN_JUMP_S:
            return (
                f"The host's clock went {jumped_s:+.1f} s against its own steady clock: the host was suspended, or its "
                "clock was set. Times of day before and after do not agree."
            )
        drift_s = 0.0 if previous_s is None or not self._real_time else device_s - steady - previous_s
        if abs(drift_s) > MIN_JUMP_S:
            return (
                f"The device's clock went {drift_s:+.1f} s against the host's: one of the two stood still, "
                "or samples were read late."
            )
        return ""

"""Detects that the host was suspended or its clock set, by comparing three clocks.

The steady clock of a host stops while the host is suspended, and does not change when the wall clock is set. The
device's ticks continue.
"""

import time
from collections.abc import Callable

MIN_JUMP_S = 2.0  # smaller jumps come from clock synchronisation


class ClockWatch:
    """Compares clocks when called. ``real_time``: device seconds equal host seconds, so ticks are compared too."""

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
        """A sentence if the clocks have diverged since the last call, else ""; each jump is reported once."""
        wall, steady = self._wall(), self._steady()
        jumped_s, self._wall_offset_s = wall - steady - self._wall_offset_s, wall - steady
        previous_s, self._device_offset_s = self._device_offset_s, device_s - steady
        if abs(jumped_s) > MIN_JUMP_S:
            return (
                f"The host's clock jumped by {jumped_s:+.1f} s against its steady clock: the host was suspended, or "
                "its clock was set. Times of day before and after do not agree."
            )
        drift_s = 0.0 if previous_s is None or not self._real_time else device_s - steady - previous_s
        if abs(drift_s) > MIN_JUMP_S:
            return (
                f"The device's clock jumped by {drift_s:+.1f} s against the host's: one of the two stopped, "
                "or samples were read late."
            )
        return ""

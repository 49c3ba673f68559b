"""The wire of a rig file in the time of the clock, for instruments that are queried at any moment."""

import threading
import time

from simulators.wire_quantities import WireQuantities
from smarig.config import RigFile
from smarig.rig import TwinSettings

IDLE_s = 0.02  # at most, between two looks at the clock


class WireByClock:
    """``drive`` sets the current; ``quantity`` is that of the last tick. ``speed``: its seconds per second."""

    def __init__(self, file: RigFile, settings: TwinSettings, speed: float) -> None:
        self.wire, self._speed, self._begin_s = WireQuantities(file, settings), speed, time.monotonic()
        self._current_A, self._tick = 0.0, 0
        self._lock = threading.Lock()

    def drive(self, current_A: float) -> None:
        """Set the current from now on."""
        self.advance()
        self._current_A = current_A

    def ohm(self) -> float:
        """The resistance of the wire at the present current."""
        return self.wire.specimen.plant.resistance_ohm(self._current_A)

    def quantity(self, name: str) -> float:
        """A quantity of the wire, as instruments read it (see WireQuantities)."""
        self.advance()
        return self.wire.quantity(name)

    def advance(self) -> None:
        """Let the time until now act on the wire."""
        with self._lock:
            due = int((time.monotonic() - self._begin_s) * self._speed / self.wire.file.period_s)
            for _ in range(self._tick, due):
                self.wire.advance(self._current_A)
            self._tick = max(self._tick, due)

    def pass_time_until(self, over: threading.Event) -> None:
        """Let time pass without requests, in a thread of its own."""
        idle_s = min(IDLE_s, self.wire.file.period_s / self._speed)

        def run() -> None:
            while not over.wait(idle_s):
                self.advance()

        threading.Thread(target=run, daemon=True).start()

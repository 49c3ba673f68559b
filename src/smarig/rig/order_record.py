"""The currents that a bench has ordered, by tick of its source, compared with what the source says it drove."""

from collections import deque

from smarig.core import Quality
from smarig.device import CurrentReading

KEPT = 256  # past currents
ROUNDING_A = 1.5e-6  # of a register in microamperes
_NOT_COMPARED = int(Quality.STALE | Quality.TRIPPED)


class OrderRecord:
    """``at`` tells the current that was ordered for a reading, and whether the source agrees.

    A command takes effect between two known ticks: the last one before it was sent, and the one of the reply. In
    between, the source may have driven either current. What it says it drove is then the command.
    """

    def __init__(self) -> None:
        self._past: deque[tuple[int, int, float]] = deque(
            maxlen=KEPT
        )  # sent after, valid after, current before
        self._read_until = 0
        self.contradiction = ""

    def changed(self, before_A: float, last_tick: int) -> None:
        """Another current was ordered; ``last_tick`` is the last tick of the source before the reply."""
        self._past.append((min(self._read_until, last_tick), last_tick, before_A))
        self._read_until = max(self._read_until, last_tick)

    def read_until(self, tick: int) -> None:
        """Readings up to this tick have arrived: no later order can change it."""
        self._read_until = max(self._read_until, tick)

    def at(self, c: CurrentReading, command_A: float) -> tuple[float, bool]:
        """The current that was ordered in the tick of a reading; ``command_A`` is the present one."""
        possible = self._possible(c.tick, command_A)
        if c.output_A is None or int(c.quality) & _NOT_COMPARED:
            return possible[0], True
        for ordered_A in possible:
            if abs(c.output_A - ordered_A) <= ROUNDING_A:
                return ordered_A, True
        self.contradiction = (
            f"The amplifier drove {c.output_A:.4g} A in its tick {c.tick}, but {possible[0]:.4g} A was ordered. "
            "Another program may use it, or its line changes words."
        )
        return possible[0], False

    def _possible(self, tick: int, command_A: float) -> list[float]:
        """The currents that may have been in effect in a tick, the most likely one first."""
        found = [command_A]
        for sent_after, valid_after, before_A in reversed(self._past):
            if valid_after < tick:
                break
            found = [before_A, *found] if tick > sent_after else [before_A]
        return found

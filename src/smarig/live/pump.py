"""Between a tick that must not wait and a viewer that may: a bounded queue and a thread of its own.

``put`` appends and returns: no lock is held while anything is drawn, nothing is computed. The thread takes all that
waits, now and then, and draws it as one batch. What does not fit drops the oldest; a batch ends before a gap, and
the next begins with how many were lost there. A drawing that fails ends the thread, is kept in ``failure`` and never
reaches the run. Knows neither samples nor viewers.
"""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

SIZE = 50_000  # items: more than an hour at 10 Hz, a second of a twin that runs free; about 20 MB
EVERY_S = 0.5
AFTER_S = 0.003  # after an item: the rest of its tick
LARGEST = 5_000  # items drawn at once: what a batch takes of the memory stays bounded

Draw = Callable[[list[Any], int], None]


class Pump:
    """Draws what one other thread puts into it: ``draw(items, lost_before_them)``, in order."""

    def __init__(self, draw: Draw, *, size: int = SIZE, every_s: float = EVERY_S) -> None:
        self._draw, self._every_s = draw, every_s
        self._waiting: deque[tuple[int, Any]] = deque(maxlen=size)
        self._number = self._next = 0
        self._after_gap: tuple[int, Any] | None = None
        self._closing, self._came = threading.Event(), threading.Event()
        self._listening = False
        self.dropped = 0
        self.failure: Exception | None = None
        self._thread = threading.Thread(target=self._pump, name="live view", daemon=True)
        self._thread.start()

    def put(self, item: Any) -> None:
        """Queue an item; at once, whatever the viewer does."""
        self._waiting.append((self._number, item))  # a full deque drops its oldest by itself
        self._number += 1
        if self._listening:
            self._listening = False
            self._came.set()

    def close(self, patience_s: float = 2.0) -> bool:
        """Draw what waits and end; False when the viewer did not let that happen in time."""
        self._closing.set()
        self._came.set()
        self._thread.join(patience_s)
        return not self._thread.is_alive() and self.failure is None

    def _pump(self) -> None:
        try:
            while not self._closing.wait(self._every_s):
                self._listen()
                self._empty()
            self._empty()
        except Exception as error:
            self.failure = error

    def _listen(self) -> None:
        """Wait for the next item, no longer than until the next turn: right after a tick the processor is free.

        Begun at any other time, the drawing would now and then be in the tick's way for some milliseconds: one
        interpreter serves both.
        """
        self._came.clear()
        self._listening = True
        self._came.wait(self._every_s)
        self._listening = False
        self._closing.wait(AFTER_S)

    def _empty(self) -> None:
        while True:
            items, lost = self._taken()
            if not items:
                return
            self.dropped += lost
            self._draw(items, lost)

    def _taken(self) -> tuple[list[Any], int]:
        """What waits, up to the next gap, and how many were lost before it."""
        items: list[Any] = []
        lost = 0
        while len(items) < LARGEST and (found := self._oldest()) is not None:
            number, item = found
            if number != self._next and items:
                self._after_gap = found
                break
            lost += number - self._next
            self._next = number + 1
            items.append(item)
        return items, lost

    def _oldest(self) -> tuple[int, Any] | None:
        found, self._after_gap = self._after_gap, None
        try:
            return found or self._waiting.popleft()
        except IndexError:
            return None

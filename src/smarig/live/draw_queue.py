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

QUEUE_SIZE = 50_000  # items: more than an hour at 10 Hz, a second of a twin that runs free; about 20 MB
DRAW_INTERVAL_S = 0.5
DRAW_DELAY_S = 0.003  # after an item: the rest of its tick
MAX_BATCH = 5_000  # items drawn at once: what a batch takes of the memory stays bounded

DrawBatch = Callable[[list[Any], int], None]


class DrawQueue:
    """Draws what one other thread puts into it: ``draw(items, lost_before_them)``, in order."""

    def __init__(self, draw: DrawBatch, *, size: int = QUEUE_SIZE, every_s: float = DRAW_INTERVAL_S) -> None:
        self._draw, self._every_s = draw, every_s
        self._queued: deque[tuple[int, Any]] = deque(maxlen=size)
        self._next_put = self._next_drawn = 0
        self._after_gap: tuple[int, Any] | None = None
        self._closing, self._item_added = threading.Event(), threading.Event()
        self._is_waiting = False
        self.dropped = 0
        self.failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="live view", daemon=True)
        self._thread.start()

    def put(self, item: Any) -> None:
        """Queue an item; at once, whatever the viewer does."""
        self._queued.append((self._next_put, item))  # a full deque drops its oldest by itself
        self._next_put += 1
        if self._is_waiting:
            self._is_waiting = False
            self._item_added.set()

    def close(self, timeout_s: float = 2.0) -> bool:
        """Draw what waits and end; False when the viewer did not let that happen in time."""
        self._closing.set()
        self._item_added.set()
        self._thread.join(timeout_s)
        return not self._thread.is_alive() and self.failure is None

    def _run(self) -> None:
        try:
            while not self._closing.wait(self._every_s):
                self._wait_for_item()
                self._drain()
            self._drain()
        except Exception as error:
            self.failure = error

    def _wait_for_item(self) -> None:
        """Wait for the next item, no longer than until the next turn: right after a tick the processor is free.

        Begun at any other time, the drawing would now and then be in the tick's way for some milliseconds: one
        interpreter serves both.
        """
        self._item_added.clear()
        self._is_waiting = True
        self._item_added.wait(self._every_s)
        self._is_waiting = False
        self._closing.wait(DRAW_DELAY_S)

    def _drain(self) -> None:
        while True:
            items, lost = self._next_batch()
            if not items:
                return
            self.dropped += lost
            self._draw(items, lost)

    def _next_batch(self) -> tuple[list[Any], int]:
        """What waits, up to the next gap, and how many were lost before it."""
        items: list[Any] = []
        lost = 0
        while len(items) < MAX_BATCH and (found := self._pop_oldest()) is not None:
            number, item = found
            if number != self._next_drawn and items:
                self._after_gap = found
                break
            lost += number - self._next_drawn
            self._next_drawn = number + 1
            items.append(item)
        return items, lost

    def _pop_oldest(self) -> tuple[int, Any] | None:
        found, self._after_gap = self._after_gap, None
        try:
            return found or self._queued.popleft()
        except IndexError:
            return None

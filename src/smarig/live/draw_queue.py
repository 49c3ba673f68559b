"""A bounded queue and a thread between the sampling loop, which must not wait, and a viewer, which may be
slow.

``put`` appends and returns. It computes nothing, and no lock is held while something is drawn. The thread takes the
queued items at intervals and draws them as one batch. If the queue is full, the oldest item is dropped. A batch ends
before a gap, and the next batch starts with the number of items lost there. If drawing fails, the thread ends and keeps
the error in ``failure``; the run is not affected. A batch starts right after an item: at any other time it would hold
the interpreter during the next tick for milliseconds.
"""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

QUEUE_SIZE = 50_000  # items: over an hour at 10 Hz, or a second of a free-running twin; about 20 MB
DRAW_INTERVAL_S = 0.5
DRAW_DELAY_S = 0.003  # after an item, for the rest of its tick
MAX_BATCH = 5_000  # items drawn at once; bounds the memory of a batch

DrawBatch = Callable[[list[Any], int], None]


class DrawQueue:
    """Draws what one other thread queues: ``draw(items, lost_before_them)``, in order."""

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
        """Queue an item without waiting for the viewer."""
        self._queued.append((self._next_put, item))  # a full deque drops its oldest item by itself
        self._next_put += 1
        if self._is_waiting:
            self._is_waiting = False
            self._item_added.set()

    def close(self, timeout_s: float = 2.0) -> bool:
        """Draw the queued items and end. Returns False if the viewer did not finish in time."""
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
        """Wait for the next item, or until the next batch is due: right after a tick the processor is idle.

        Both threads share one interpreter. Drawing that starts at another time would delay some ticks by
        milliseconds.
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
        """The queued items up to the next gap, and the number of items lost before them."""
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

"""Decouples a slow listener from the tick: a bounded queue with a thread of its own, whose oldest entries are dropped.

A viewer may stall or fail without effect on the tick. Samples, steps and events are queued alike. An exception of the
listener ends its thread, is kept in ``failure``, and never reaches the runner.
"""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from smarig.core import Sample, StepResult
from smarig.runner.listener import Listener


class BoundedListener:
    """Passes calls on to ``listener`` through a bounded queue; ``dropped`` counts the calls that did not fit."""

    def __init__(self, listener: Listener, size: int = 10_000) -> None:
        self._listener = listener
        self._queue: deque[Callable[[], None]] = deque()
        self._size = size
        self._wake = threading.Event()
        self._open = True
        self.dropped = 0
        self.failure: Exception | None = None
        self._thread = threading.Thread(target=self._forward, name="listener", daemon=True)
        self._thread.start()

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Queue a sample."""
        self._put(lambda: self._listener.sample(s, step, input_value))

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Queue a finished step."""
        self._put(lambda: self._listener.step(result, branch=branch, target=target))

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Queue an event."""
        self._put(lambda: self._listener.event(t_s, kind, text, level=level, **data))

    def close(self, timeout_s: float = 5.0) -> None:
        """Let the listener finish the queue, but wait no longer than ``timeout_s``."""
        self._open = False
        self._wake.set()
        self._thread.join(timeout_s)

    def _put(self, call: Callable[[], None]) -> None:
        if self.failure is not None:
            self.dropped += 1
            return
        if len(self._queue) >= self._size and self._pop_oldest() is not None:
            self.dropped += 1
        self._queue.append(call)
        self._wake.set()

    def _pop_oldest(self) -> Callable[[], None] | None:
        """The oldest queued call; None if the other thread has taken it."""
        try:
            return self._queue.popleft()
        except IndexError:
            return None

    def _forward(self) -> None:
        try:
            while self._open or self._queue:
                self._wake.wait()
                self._wake.clear()
                while (call := self._pop_oldest()) is not None:
                    call()
        except Exception as error:
            self.failure = error

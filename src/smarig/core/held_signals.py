"""Signals that end a process wait while something must not be cut off, such as the end of a current."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

from smarig.core.forced_end import ENDING, renew_watch


class HeldSignals:
    """A context in which ``hold`` makes signals wait until its end.

    If the context ends by an exception, the process is ending anyway, and what waited is dropped; else it is raised
    again. Only the main thread handles signals; in others ``hold`` does nothing.
    """

    def __init__(self) -> None:
        self._old: dict[int, Any] = {}
        self._waiting: list[int] = []

    def hold(self) -> None:
        """From here on signals wait."""
        if self._old or threading.current_thread() is not threading.main_thread():
            return
        for number in ENDING:
            if signal.getsignal(number) != signal.SIG_IGN:
                self._old[number] = signal.signal(number, self._note)

    def _note(self, number: int, _frame: FrameType | None) -> None:
        self._waiting.append(number)
        renew_watch(number)

    def __enter__(self) -> "HeldSignals":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, _error: BaseException | None, _at: TracebackType | None
    ) -> None:
        for number, handler in self._old.items():
            signal.signal(number, handler)
        self._old = {}
        if kind is None:
            for number in dict.fromkeys(self._waiting):
                signal.raise_signal(number)

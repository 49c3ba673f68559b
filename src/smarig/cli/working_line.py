"""A line at the terminal while a command computes: the time so far, and the time left where it is known.

It appears after three seconds, is rewritten in place, and is removed before anything else is printed.
"""

import contextlib
import os
import sys
import threading
import time
from collections.abc import Iterator

from smarig.core import share_done

APPEARS_S, _EVERY_S = 3.0, 0.5
COMPUTING = frozenset(
    (
        "benchmark",
        "calibrate",
        "certify",
        "diagnose",
        "export",
        "identify",
        "import",
        "report",
        "simulate",
        "study",
    )
) | {"transformation", "verify"}
_ERASE = "\r\x1b[K"


class WorkingLine:
    """The line of one command while it computes."""

    def __init__(self, name: str) -> None:
        self._name, self._began = name, time.monotonic()
        self._lock, self._ended, self._shown = threading.Lock(), threading.Event(), False
        self._loop_began: float | None = None
        self._paused = False

    def run(self) -> None:
        """Update the line until the end of the command."""
        if self._ended.wait(APPEARS_S):
            return
        while not self._ended.wait(_EVERY_S):
            with self._lock:
                if not (self._ended.is_set() or self._paused):
                    self._write(f"{_ERASE}{self.text(time.monotonic())}")
                    self._shown = True

    def text(self, now: float) -> str:
        """The words of the line at a time of the clock."""
        done, total = share_done()
        words = f"{self._name}: {_clock(now - self._began)}"
        if not total:
            self._loop_began = None
            return words
        if self._loop_began is None:
            self._loop_began = now
        share = f"{words}, {done} of {total} done"
        if not done:
            return share
        return f"{share}, about {_clock((now - self._loop_began) / done * (total - done))} left"

    def pause(self, paused: bool) -> None:
        """Remove the line and show none while paused, in one step: it may not come back in between."""
        with self._lock:
            self._paused = paused
            self._erase()

    def end(self) -> None:
        """Remove the line for good."""
        self._ended.set()
        with self._lock:
            self._erase()

    def _erase(self) -> None:
        if self._shown:
            self._write(_ERASE)
            self._shown = False

    def _write(self, text: str) -> None:
        with contextlib.suppress(OSError, ValueError):  # the terminal was closed
            sys.stderr.write(text)
            sys.stderr.flush()


_CURRENT: list[WorkingLine] = []


@contextlib.contextmanager
def working_line(name: str) -> Iterator[None]:
    """Show the line while a command runs, if stderr is a terminal and the command only computes."""
    if name not in COMPUTING or not _is_shown():
        yield
        return
    line = WorkingLine(name)
    _CURRENT.append(line)
    threading.Thread(target=line.run, daemon=True).start()
    try:
        yield
    finally:
        line.end()
        _CURRENT.remove(line)


def _is_shown() -> bool:
    """Whether stderr is a terminal that can erase a line; a closed stderr is none."""
    return (
        sys.stderr is not None
        and sys.stderr.isatty()
        and os.environ.get("TERM", "") not in ("", "dumb", "unknown")
    )


@contextlib.contextmanager
def without_line() -> Iterator[None]:
    """Leave the terminal to other output or a question: the line is removed, and comes back afterwards."""
    for line in _CURRENT:
        line.pause(True)
    try:
        yield
    finally:
        for line in _CURRENT:
            line.pause(False)


def _clock(seconds: float) -> str:
    """Seconds as "42 s" or "3:05 min"."""
    whole = round(seconds)
    return f"{whole} s" if whole < 60 else f"{whole // 60}:{whole % 60:02d} min"

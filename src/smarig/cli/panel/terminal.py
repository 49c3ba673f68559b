"""Access to standard error that does not block the run when the terminal is slow, stopped (Ctrl-S) or
closed.

Only dedicated threads write to it, through a descriptor of their own, so that a blocked thread holds no
shared lock.
"""

import contextlib
import os
import queue
import sys
import threading
from collections.abc import Callable

CLOSE_TIMEOUT_S = 2.0  # for the output that is left at the end
_SIZE = (80, 24)
_MAX_QUEUED_LINES = 2000  # that may wait to be read


class Terminal:
    """A file for rich and others. ``supports_panel``: whether it can be redrawn in place."""

    def __init__(self) -> None:
        self.encoding = getattr(sys.stderr, "encoding", None) or "utf-8"
        self._stream = sys.stderr
        try:
            self._file: int | None = os.dup(sys.stderr.fileno())
        except (OSError, ValueError, AttributeError):
            # It is not a file of the system: a notebook or a test.
            self._file = None

    @property
    def supports_panel(self) -> bool:
        """Whether it is a terminal with a movable cursor."""
        return self.isatty() and os.environ.get("TERM", "") not in ("", "dumb", "unknown")

    @property
    def plain(self) -> bool:
        """Whether it shows ASCII only."""
        return not self.encoding.lower().startswith("utf")

    def size(self) -> tuple[int, int]:
        """Columns and rows as the terminal reports them."""
        try:
            columns, rows = os.get_terminal_size(self.fileno())
        except OSError:  # the terminal was closed meanwhile
            return _SIZE
        return (columns, rows) if columns and rows else _SIZE  # a serial console may report zeros

    def isatty(self) -> bool:
        """Whether stderr is a terminal."""
        return self._file is not None and os.isatty(self._file)

    def fileno(self) -> int:
        """The descriptor. Raises OSError if there is none."""
        if self._file is None:
            raise OSError("no file")
        return self._file

    def write(self, text: str) -> int:
        """Write all of the text, however long it takes. Raises OSError if the terminal is closed."""
        if self._file is None:
            return self._stream.write(text)
        remaining = memoryview(text.encode(self.encoding, "replace"))
        while remaining:
            remaining = remaining[os.write(self._file, remaining) :]
        return len(text)

    def flush(self) -> None:
        """Nothing to do: writes are not buffered."""

    def close(self) -> None:
        """Close the descriptor."""
        if self._file is not None:
            file, self._file = self._file, None
            os.close(file)


class LineWriter:
    """A thread that writes lines. Lines that are not read in time are dropped and counted.

    ``dropped_text`` makes the line that reports the number of dropped lines.
    """

    def __init__(self, terminal: Terminal, dropped_text: Callable[[int], str]) -> None:
        self._terminal, self._dropped_text = terminal, dropped_text
        self._lines: queue.Queue[str | None] = queue.Queue(_MAX_QUEUED_LINES)
        self._dropped = 0
        self._thread = threading.Thread(target=self._write_lines, name="speaker", daemon=True)
        self._thread.start()

    def put(self, line: str) -> None:
        """Queue a line for writing; never waits."""
        try:
            if self._dropped:
                self._lines.put_nowait(self._dropped_text(self._dropped))
                self._dropped = 0
            self._lines.put_nowait(line)
        except queue.Full:
            self._dropped += 1

    def close(self) -> None:
        """Wait for the thread, up to a limit. A blocked thread is abandoned."""
        with contextlib.suppress(queue.Full):
            self._lines.put(None, timeout=CLOSE_TIMEOUT_S)
        self._thread.join(CLOSE_TIMEOUT_S)

    def _write_lines(self) -> None:
        with contextlib.suppress(OSError):  # the terminal is closed
            while (line := self._lines.get()) is not None:
                self._terminal.write(line + "\n")
        self._terminal.close()

"""Standard error as a thing that may be slow, stopped (Ctrl-S) or gone: only threads of ours wait for it.

Written to by a descriptor of its own, so that a thread that hangs in it holds no lock which the rest needs.
"""

import contextlib
import os
import queue
import sys
import threading
from collections.abc import Callable

CLOSE_TIMEOUT_S = 2.0  # at the end, for what is still to be written
_SIZE = (80, 24)
_MAX_QUEUED_LINES = 2000  # lines that may wait for a reader


class Terminal:
    """A file for rich and others; ``supports_panel`` where something can be drawn in place."""

    def __init__(self) -> None:
        self.encoding = getattr(sys.stderr, "encoding", None) or "utf-8"
        self._stream = sys.stderr
        try:
            self._file: int | None = os.dup(sys.stderr.fileno())
        except (OSError, ValueError, AttributeError):  # no file of the system's: a notebook, a test
            self._file = None

    @property
    def supports_panel(self) -> bool:
        """Whether it is a terminal that can move its cursor."""
        return self.isatty() and os.environ.get("TERM", "") not in ("", "dumb", "unknown")

    @property
    def plain(self) -> bool:
        """Whether it shows ASCII only."""
        return not self.encoding.lower().startswith("utf")

    def size(self) -> tuple[int, int]:
        """Columns and rows, asked of the terminal itself."""
        try:
            columns, rows = os.get_terminal_size(self.fileno())
        except OSError:  # it has gone meanwhile
            return _SIZE
        return (columns, rows) if columns and rows else _SIZE  # a serial console may not know

    def isatty(self) -> bool:
        """Whether a person sits there."""
        return self._file is not None and os.isatty(self._file)

    def fileno(self) -> int:
        """The descriptor; OSError without."""
        if self._file is None:
            raise OSError("no file")
        return self._file

    def write(self, text: str) -> int:
        """Write all of it, however long that takes; OSError when nobody is there."""
        if self._file is None:
            return self._stream.write(text)
        remaining = memoryview(text.encode(self.encoding, "replace"))
        while remaining:
            remaining = remaining[os.write(self._file, remaining) :]
        return len(text)

    def flush(self) -> None:
        """Nothing is kept back."""

    def close(self) -> None:
        """Give the descriptor back."""
        if self._file is not None:
            file, self._file = self._file, None
            os.close(file)


class LineWriter:
    """Lines written by a thread of their own; those that nobody reads in time are dropped, counted and told.

    ``dropped_text`` makes the line that tells how many.
    """

    def __init__(self, terminal: Terminal, dropped_text: Callable[[int], str]) -> None:
        self._terminal, self._dropped_text = terminal, dropped_text
        self._lines: queue.Queue[str | None] = queue.Queue(_MAX_QUEUED_LINES)
        self._dropped = 0
        self._thread = threading.Thread(target=self._write_lines, name="speaker", daemon=True)
        self._thread.start()

    def put(self, line: str) -> None:
        """Have a line written; never waits."""
        try:
            if self._dropped:
                self._lines.put_nowait(self._dropped_text(self._dropped))
                self._dropped = 0
            self._lines.put_nowait(line)
        except queue.Full:
            self._dropped += 1

    def close(self) -> None:
        """Let it finish, but not for ever: a thread that hangs is left hanging."""
        with contextlib.suppress(queue.Full):
            self._lines.put(None, timeout=CLOSE_TIMEOUT_S)
        self._thread.join(CLOSE_TIMEOUT_S)

    def _write_lines(self) -> None:
        with contextlib.suppress(OSError):  # nobody is there any more
            while (line := self._lines.get()) is not None:
                self._terminal.write(line + "\n")
        self._terminal.close()

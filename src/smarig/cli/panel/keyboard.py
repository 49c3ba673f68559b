"""Keys during a run at a terminal: p pauses, r resumes, s or q stops safely.

The terminal delivers single keys only while smarig is in its foreground. It is restored on every ending. The
suspend key is disabled, because a stopped host would let the lease of a heated wire expire. Without a
terminal on stdin, or without termios, there are no keys.
"""

import contextlib
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from smarig.core import Requester, at_forced_end

if TYPE_CHECKING:
    from smarig.runner import RunControl


KEYS_HELP = "Keys: p pauses (the current stays on), r resumes, s stops safely."
_POLL_INTERVAL_S = 0.1  # interval at which the end of the run is checked


@contextmanager
def keys(control: "RunControl") -> Iterator[bool]:
    """Pass the keys of the terminal on stdin to the control. Yields whether there is such a terminal."""
    with contextlib.ExitStack() as cleanup:
        file = _terminal()
        if file is not None:
            cleanup.enter_context(_single_keys(file))
            stop_event = threading.Event()
            listener = threading.Thread(
                target=_listen, args=(file, control, stop_event), name="keys", daemon=True
            )
            listener.start()
            cleanup.callback(listener.join)
            cleanup.callback(stop_event.set)
        yield file is not None


def press(control: "RunControl", key: str) -> None:
    """Act on a key. Other keys have no effect."""
    if key == "p":
        control.paused = True
    elif key == "r":
        control.paused = False
    elif key in ("s", "q"):
        control.stop(f"stopped by the operator (key {key})", Requester.USER)


def _terminal() -> int | None:
    """The descriptor of the terminal if smarig is in its foreground, else None."""
    try:
        file = sys.stdin.fileno()
        in_foreground = os.isatty(file) and os.tcgetpgrp(file) == os.getpgrp()
    except (OSError, ValueError, AttributeError):  # stdin closed, not a file, or no termios
        return None
    return file if in_foreground else None


@contextmanager
def _single_keys(file: int) -> Iterator[None]:
    """Deliver keys one by one without echo. No key suspends the process; other signal keys work as usual."""
    import termios

    old = termios.tcgetattr(file)
    new = termios.tcgetattr(file)
    new[3] &= ~(termios.ICANON | termios.ECHO)
    new[6] = [*new[6]]
    new[6][termios.VMIN], new[6][termios.VTIME] = 1, 0
    new[6][termios.VSUSP] = os.fpathconf(file, "PC_VDISABLE").to_bytes(1, "little", signed=False)
    termios.tcsetattr(file, termios.TCSANOW, new)

    def restore() -> str:
        with contextlib.suppress(OSError, termios.error):  # the terminal may be closed
            termios.tcsetattr(file, termios.TCSANOW, old)
        return ""

    try:
        with at_forced_end(restore):
            yield
    finally:
        restore()


def _listen(file: int, control: "RunControl", stop_event: threading.Event) -> None:
    import selectors

    with selectors.DefaultSelector() as selector, contextlib.suppress(OSError):
        selector.register(file, selectors.EVENT_READ)
        while not stop_event.is_set():
            if not selector.select(_POLL_INTERVAL_S):
                continue
            typed = os.read(file, 64)
            if not typed:
                return  # disconnected
            for key in typed.decode(errors="ignore").lower():
                press(control, key)

"""Signals become a safe stop: SIGINT, SIGTERM and SIGHUP ask the run to end; a second SIGINT insists.

The handler only sets a flag that the runner reads on its next tick: nothing is torn in the middle.
Only the main thread may install handlers; elsewhere this does nothing.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from smarig.runner.control import Control

_WORDS = {
    "SIGINT": "interrupted by the keyboard (Ctrl-C)",
    "SIGTERM": "terminated (SIGTERM)",
    "SIGHUP": "hung up (SIGHUP)",
}


@contextmanager
def safe_endings(control: Control) -> Iterator[None]:
    """Within: a signal stops the run safely. Afterwards: the old handlers are back."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def ask(number: int, _frame) -> None:
        if control.stopping and number == signal.SIGINT:
            raise KeyboardInterrupt
        control.stop(_WORDS[signal.Signals(number).name])

    known = [getattr(signal, name) for name in _WORDS if hasattr(signal, name)]
    old = {number: signal.signal(number, ask) for number in known}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)

"""Signals become a safe stop: SIGINT, SIGTERM and SIGHUP ask the run to end; a second SIGINT insists.

The handler only sets a flag that the runner reads on its next tick: nothing is torn in the middle. For a while after
such a stop, and after each that insisted, further signals are not heard, lest impatience (a key held down) tears what
is being put away; the ending is told as an interrupted run's, whichever of them it was. A protocol that computes and
does not come back is torn out of it, for no tick will ever read the flag. A signal that was ignored when
we came (nohup) stays ignored. Only the main thread may install handlers; elsewhere this does nothing.
"""

import _thread
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from smarig.errors import Interrupted
from smarig.runner.control import Control

INSISTS_S = 0.5  # after the first Ctrl-C: what comes sooner is the same wish
PUTTING_AWAY_S = 3.0
THINKING_S = 3.0  # that a protocol may go on computing after a stop was asked for
_WORDS = {
    "SIGINT": "interrupted by the keyboard (Ctrl-C)",
    "SIGTERM": "terminated (SIGTERM)",
    "SIGHUP": "hung up (SIGHUP)",
}


@contextmanager
def safe_endings(control: Control) -> Iterator[None]:
    """Within: a signal stops the run safely, as Interrupted. Afterwards: the old handlers are back."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    deaf_until_s = 0.0

    def listen() -> None:
        nonlocal deaf_until_s
        deaf_until_s = 0.0

    def ask(number: int, _frame) -> None:
        nonlocal deaf_until_s
        now_s = time.monotonic()
        if now_s < deaf_until_s:
            return
        if control.stopping and number == signal.SIGINT:
            deaf_until_s = now_s + PUTTING_AWAY_S
            raise KeyboardInterrupt
        deaf_until_s = now_s + INSISTS_S
        control.stop(_WORDS[signal.Signals(number).name])
        threading.Thread(
            target=_tear_out, args=(control, over, listen), name="impatience", daemon=True
        ).start()

    over = threading.Event()
    known = [getattr(signal, name) for name in _WORDS if hasattr(signal, name)]
    heard = [number for number in known if signal.getsignal(number) != signal.SIG_IGN]
    old = {number: signal.signal(number, ask) for number in heard}
    try:
        yield
    except KeyboardInterrupt:
        if not control.stopping:
            raise
        raise Interrupted(control.cause) from None
    finally:
        over.set()
        for number, handler in old.items():
            signal.signal(number, _patient(handler) if control.stopping else handler)


def _tear_out(control: Control, over: threading.Event, listen: Callable[[], None]) -> None:
    """Interrupt a protocol that does not come back, which is heard at once; nothing else is ever torn."""
    while not over.wait(0.2):
        since_s = control.waiting_since_s
        if since_s is not None and time.monotonic() - since_s > THINKING_S:
            listen()
            _thread.interrupt_main()
            return


def _patient(handler: Any) -> Any:
    """A handler that hears nothing for a while, and then is the old one again."""
    until = time.monotonic() + PUTTING_AWAY_S

    def wait(number: int, _frame: Any) -> None:
        if time.monotonic() >= until:
            signal.signal(number, handler)
            signal.raise_signal(number)

    return wait

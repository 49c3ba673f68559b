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

from smarig.core import Interrupted
from smarig.runner.run_control import RunControl

INSISTS_S = 0.5  # after the first Ctrl-C: what comes sooner is the same wish
SHUTDOWN_S = 3.0
THINKING_S = 3.0  # that a protocol may go on computing after a stop was asked for
_CAUSES = {
    "SIGINT": "interrupted by the keyboard (Ctrl-C)",
    "SIGTERM": "terminated (SIGTERM)",
    "SIGHUP": "hung up (SIGHUP)",
}


@contextmanager
def stop_on_signals(control: RunControl) -> Iterator[None]:
    """Within: a signal stops the run safely, as Interrupted. Afterwards: the old handlers are back."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    ignore_until_s = 0.0

    def accept_signals() -> None:
        nonlocal ignore_until_s
        ignore_until_s = 0.0

    def on_signal(number: int, _frame) -> None:
        nonlocal ignore_until_s
        now_s = time.monotonic()
        if now_s < ignore_until_s:
            return
        if control.stopping and number == signal.SIGINT:
            ignore_until_s = now_s + SHUTDOWN_S
            raise KeyboardInterrupt
        ignore_until_s = now_s + INSISTS_S
        control.stop(_CAUSES[signal.Signals(number).name])
        threading.Thread(
            target=_interrupt_stuck_protocol,
            args=(control, finished, accept_signals),
            name="impatience",
            daemon=True,
        ).start()

    finished = threading.Event()
    available = [getattr(signal, name) for name in _CAUSES if hasattr(signal, name)]
    handled = [number for number in available if signal.getsignal(number) != signal.SIG_IGN]
    old = {number: signal.signal(number, on_signal) for number in handled}
    try:
        yield
    except KeyboardInterrupt:
        if not control.stopping:
            raise
        raise Interrupted(control.cause) from None
    finally:
        finished.set()
        for number, handler in old.items():
            signal.signal(number, _delayed_handler(handler) if control.stopping else handler)


def _interrupt_stuck_protocol(
    control: RunControl, finished: threading.Event, accept_signals: Callable[[], None]
) -> None:
    """Interrupt a protocol that does not come back, which is heard at once; nothing else is ever torn."""
    while not finished.wait(0.2):
        since_s = control.waiting_since_s
        if since_s is not None and time.monotonic() - since_s > THINKING_S:
            accept_signals()
            _thread.interrupt_main()
            return


def _delayed_handler(handler: Any) -> Any:
    """A handler that hears nothing for a while, and then is the old one again."""
    until = time.monotonic() + SHUTDOWN_S

    def wait(number: int, _frame: Any) -> None:
        if time.monotonic() >= until:
            signal.signal(number, handler)
            signal.raise_signal(number)

    return wait

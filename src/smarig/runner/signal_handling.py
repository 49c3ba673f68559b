"""Turns signals into a safe stop: SIGINT, SIGTERM, SIGHUP and SIGQUIT request the end of a run; a second
SIGINT forces it.

The handler only sets a flag that the runner reads at its next tick, so no operation is cut off. For a while after such
a stop, and after each forced one, further signals are ignored, so that a key held down does not interrupt the closing.
In each case the end is reported as an interrupted run. A protocol that computes without returning is interrupted,
because no tick would read the flag. The creation and the closing of a run are bounded in time, and no signal
interrupts them. A main thread that does not come back is the matter of ``core/forced_end``. A signal that was ignored
at the start (nohup) stays ignored. Only the main thread may install handlers; elsewhere this does nothing.
"""

import _thread
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from smarig.core import Interrupted, Requester, SmarigError, renew_watch
from smarig.runner.run_control import RunControl

INSISTS_S = 0.5  # after the first Ctrl-C; an earlier one counts as the same request
SHUTDOWN_S = 3.0
THINKING_S = 3.0  # that a protocol may compute after a stop was requested
_CAUSES = {
    "SIGINT": "interrupted by the keyboard (Ctrl-C)",
    "SIGTERM": "terminated (SIGTERM)",
    "SIGHUP": "hung up (SIGHUP)",
    "SIGQUIT": "quit by the keyboard (Ctrl-\\, SIGQUIT)",
}


@contextmanager
def stop_on_signals(control: RunControl) -> Iterator[None]:
    """Stop the run safely at a signal, as Interrupted. The old handlers are restored afterwards."""
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
        renew_watch(number)
        if control.undisturbing:
            control.stop(_CAUSES[signal.Signals(number).name])
            return
        if now_s < ignore_until_s:
            return
        if control.stopping and number == signal.SIGINT:
            ignore_until_s = now_s + SHUTDOWN_S
            raise KeyboardInterrupt
        ignore_until_s = now_s + INSISTS_S
        by = Requester.USER if number == signal.SIGINT else Requester.SIGNAL
        control.stop(_CAUSES[signal.Signals(number).name], by)
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
    except KeyboardInterrupt as interrupt:
        before = interrupt.__context__
        if isinstance(before, SmarigError) and not isinstance(before, Interrupted):
            raise before from None  # the error that was on its way is not lost
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
    """Interrupt a protocol that does not return; this signal is not ignored. Nothing else is interrupted."""
    while not finished.wait(0.2):
        since_s = control.waiting_since_s
        if since_s is not None and time.monotonic() - since_s > THINKING_S:
            accept_signals()
            _thread.interrupt_main()
            return


def _delayed_handler(handler: Any) -> Any:
    """A handler that ignores its signal for a while and then restores the old handler."""
    until = time.monotonic() + SHUTDOWN_S

    def wait(number: int, _frame: Any) -> None:
        renew_watch(number)
        if time.monotonic() >= until:
            signal.signal(number, handler)
            signal.raise_signal(number)

    return wait

"""The end of a process whose main thread does not come back: a disk that does not answer, or a call that never returns.

Python handles signals in the main thread. While the kernel holds that thread (state D, a disk that does not answer),
Ctrl-C, SIGTERM, SIGHUP and SIGQUIT wait with it. A thread of its own therefore counts them. It ends the process

* ``INSISTED_S`` after the second Ctrl-C, whatever the main thread does;
* ``REQUESTED_S`` after any of the signals, if the main thread has not moved since;
* ``STALLED_S`` after the disk stopped answering it, without any signal (Linux, where the kernel tells).

Before that, what others registered (``at_forced_end``) is done: current to zero, terminal restored, words on what is
on disk. The locks of the process are given back, because a process of which the kernel holds a thread may outlive its
end. The exit is that of ``os._exit``: nothing may wait for the main thread any more.
"""

import _thread
import contextlib
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import NamedTuple, NoReturn

from smarig.core.errors import Interrupted, StorageError
from smarig.core.process_lock import give_back_locks

INSISTED_S = 5.0  # a healthy end of a run takes less
REQUESTED_S = 15.0  # longer than anything that the main thread waits for with a limit
STALLED_S = 60.0  # a slow disk may take that long to store much
ZERO_S = 3.0  # as above, until the current is set to zero
LAST_S = 2.0  # for what is done before the end, all at the same time
POLL_S = 0.2
ENDING = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
_FRAMES = 8  # in which the file that is waited for may be named
_UNFINISHED = (
    "A file that was being written is not there under its name; what had that name before is unchanged."
)


class LastAction(NamedTuple):
    """What is done before a forced end: an action that returns a sentence, and the sentence if it does not."""

    act: Callable[[], str]
    otherwise: str = ""
    zeroes: bool = False  # it takes the current away, so it is also done as soon as the disk stalls


_actions: list[LastAction] = []


@contextlib.contextmanager
def at_forced_end(act: Callable[[], str], otherwise: str = "", *, zeroes: bool = False) -> Iterator[None]:
    """While the context lasts, do this before a forced end. ``act`` runs in a thread of its own."""
    action = LastAction(act, otherwise, zeroes)
    _actions.append(action)
    try:
        yield
    finally:
        _actions.remove(action)


_wakeup: list[int] = []  # where the process writes its signals for the watch


def renew_watch(*signals: int) -> None:
    """Let signals reach the watch again: a library that ran an event loop has taken them away.

    ``signals`` are those that a handler has just taken, which the watch learns from it then. Main thread only.
    """
    if not _wakeup or threading.current_thread() is not threading.main_thread():
        return
    other = signal.set_wakeup_fd(_wakeup[-1], warn_on_full_buffer=False)
    if other == -1:
        os.write(_wakeup[-1], bytes(signals))
    elif other != _wakeup[-1]:
        signal.set_wakeup_fd(other)  # its loop is still open


@contextlib.contextmanager
def forced_end(write: Callable[[str, int], object]) -> Iterator[None]:
    """Force an end while the context lasts. ``write(sentence, exit_status)`` informs the user. Main thread only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    with contextlib.ExitStack() as stack:
        reader, writer = (stack.enter_context(end) for end in socket.socketpair())
        reader.setblocking(False)
        writer.setblocking(False)
        stack.callback(signal.set_wakeup_fd, signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False))
        _wakeup.append(writer.fileno())
        stack.callback(_wakeup.pop)
        over = threading.Event()
        watch = _Watch(reader, over, write)
        thread = threading.Thread(target=watch.run, name="forced end", daemon=True)
        thread.start()
        stack.callback(thread.join)
        stack.callback(over.set)
        yield


def exit_within(limit_s: float, status: int) -> None:
    """End the process after ``limit_s`` if threads and exit hooks that others left do not let it end before."""

    def end() -> NoReturn:
        time.sleep(limit_s)
        os._exit(status)

    threading.Thread(target=end, daemon=True).start()


class _Watch:
    """Counts the signals and looks at the main thread, a few times per second."""

    def __init__(
        self, reader: socket.socket, over: threading.Event, write: Callable[[str, int], object]
    ) -> None:
        self._reader, self._over, self._write = reader, over, write
        self._main = threading.main_thread()
        self._waiting: set[signal.Signals] = (
            set()
        )  # signals that the main thread has not taken at the last look
        self._first_s: float | None = None  # host time of the first signal
        self._insisted_s: float | None = None  # of the second Ctrl-C
        self._still_s: float | None = None  # since when the main thread has not moved
        self._stalled_s: float | None = None  # since when the kernel holds it
        self._keyboard = 0  # number of Ctrl-C
        self._position: tuple[FrameType, int] | None = None
        self._zeroed = False

    def run(self) -> None:
        """Look until the end of the context, or of the process."""
        if hasattr(signal, "pthread_sigmask"):  # so that a signal stays where it can be seen
            signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        while not self._over.wait(POLL_S):
            self._forward_untaken()
            self._count(time.monotonic())
            self._look(time.monotonic())

    def _forward_untaken(self) -> None:
        """Take a signal over that waits for a main thread which the kernel holds, and leave it to its handler."""
        if not hasattr(signal, "sigtimedwait"):
            return
        waiting = {number for number in ENDING if number in signal.sigpending()}
        for number in waiting & self._waiting:
            if signal.sigtimedwait([number], 0) is not None:
                _thread.interrupt_main(number)
        self._waiting = waiting - self._waiting

    def _count(self, now_s: float) -> None:
        with contextlib.suppress(BlockingIOError, InterruptedError):
            for number in self._reader.recv(4096):
                if number in ENDING:
                    self._first_s = self._first_s or now_s
                    self._keyboard += number == signal.SIGINT
        if self._keyboard > 1:
            self._insisted_s = self._insisted_s or now_s

    def _look(self, now_s: float) -> None:
        blocked = _held_by_kernel(self._main.native_id)
        if self._first_s is None and not blocked:  # nearly always
            self._stalled_s, self._position, self._zeroed = None, None, False
            return
        if self._moved():
            self._still_s, self._stalled_s, self._zeroed = now_s, None, False
        self._stalled_s = (self._stalled_s or now_s) if blocked else None
        if _past(self._stalled_s, ZERO_S, now_s) and not self._zeroed:
            self._zeroed = True
            _all_done([action for action in _actions if action.zeroes])
        if _past(self._insisted_s, INSISTED_S, now_s):
            self._end(f"Ctrl-C was pressed twice, and the command did not end within {INSISTED_S:g} s", True)
        if _past(self._first_s, REQUESTED_S, now_s) and _past(self._still_s, REQUESTED_S, now_s):
            self._end(f"The command was asked to end, and has not moved for {REQUESTED_S:g} s", True)
        if _past(self._stalled_s, STALLED_S, now_s):
            self._end(f"The command has waited for {STALLED_S:g} s", False)

    def _moved(self) -> bool:
        """Whether the main thread is elsewhere than at the last look."""
        frame = sys._current_frames().get(self._main.ident or 0)
        before, self._position = self._position, (frame, frame.f_lasti) if frame else None
        return before is None or self._position is None or before != self._position

    def _end(self, why: str, requested: bool) -> NoReturn:
        frame = self._position[0] if self._position else None
        waits = self._stalled_s is not None
        self._position = None
        named = f" ({path})" if waits and (path := _file_waited_for(frame)) else ""
        cause = f": a disk or network folder does not answer{named}" if waits else ""
        words = [*_all_done(_actions), _UNFINISHED]
        status = Interrupted.exit_status if requested else StorageError.exit_status
        sentence = f"{why}{cause}. It was ended. {' '.join(words)}"
        _done_in([give_back_locks, lambda: self._write(sentence, status)], LAST_S / 2)
        os._exit(status)


def _past(since_s: float | None, limit_s: float, now_s: float) -> bool:
    return since_s is not None and now_s - since_s >= limit_s


def _held_by_kernel(thread: int | None) -> bool:
    """Whether a thread sleeps uninterruptibly, which is what waiting for a disk is; False where nobody tells."""
    try:
        return Path(f"/proc/self/task/{thread}/stat").read_bytes().rpartition(b")")[2].split()[0] == b"D"
    except (OSError, IndexError):
        return False


def _file_waited_for(frame: FrameType | None) -> str:
    """The path in the innermost frame that has one; "" if none has."""
    for _ in range(_FRAMES):
        if frame is None:
            return ""
        paths = [value for value in frame.f_locals.values() if isinstance(value, Path)]
        if paths:
            return str(paths[0])
        frame = frame.f_back
    return ""


def _all_done(actions: list[LastAction]) -> list[str]:
    """What the actions write, in order, without empty words."""
    results = _done_in([action.act for action in actions], LAST_S)
    written = [words if words is not None else action.otherwise for action, words in zip(actions, results)]
    return [words for words in written if words]


def _done_in(work: list[Callable[[], object]], limit_s: float) -> list[str | None]:
    """The words that each has returned in time; None for one that failed or has not returned."""
    results: list[str | None] = [None] * len(work)

    def do(k: int) -> None:
        with contextlib.suppress(Exception):
            results[k] = str(work[k]() or "")

    threads = [threading.Thread(target=do, args=(k,), daemon=True) for k in range(len(work))]
    for thread in threads:
        thread.start()
    until_s = time.monotonic() + limit_s
    for thread in threads:
        thread.join(max(0.0, until_s - time.monotonic()))
    return list(results)

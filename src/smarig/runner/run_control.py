"""Requests to a running experiment: pause, resume, stop, record an event. The runner reads them at every tick."""

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from smarig.core import Interrupted, Requester


class RunControl:
    """Flags set by a signal handler, a key or another thread; plain attributes, so setting is atomic."""

    def __init__(self) -> None:
        self.paused = False
        self.undisturbing = False  # the run is being created or closed, which no signal interrupts
        self.waiting_since_s: float | None = None  # monotonic, while a protocol computes its next command
        self._stop_cause = ""
        self._stopped_by = Requester.PROGRAM
        self._reports: deque[tuple[str, str, str]] = deque()

    def report(self, kind: str, text: str, *, level: str) -> None:
        """Have an event recorded at the next tick, from any thread."""
        self._reports.append((kind, text, level))

    def reports(self) -> Sequence[tuple[str, str, str]]:
        """Kind, text and level of the events since the last call."""
        if not self._reports:  # nearly always: this is asked in every tick
            return ()
        return [self._reports.popleft() for _ in range(len(self._reports))]

    def stop(self, cause: str, by: Requester = Requester.PROGRAM) -> None:
        """Request a safe end of the run; the first cause is kept, and who asked."""
        if not self._stop_cause:
            self._stop_cause, self._stopped_by = cause, by

    @contextmanager
    def undisturbed(self) -> Iterator[None]:
        """Let no signal interrupt file work, which is bounded in time. A request to stop is kept."""
        before, self.undisturbing = self.undisturbing, True
        try:
            yield
        finally:
            self.undisturbing = before

    @property
    def cause(self) -> str:
        """The cause of a requested stop, "" if there is none."""
        return self._stop_cause

    @property
    def stopped_by(self) -> Requester | None:
        """Who requested the stop, None if nobody did."""
        return self._stopped_by if self._stop_cause else None

    @property
    def stopping(self) -> bool:
        """Whether a stop was requested."""
        return bool(self._stop_cause)

    def raise_if_stopped(self) -> None:
        """Raise Interrupted with the cause if a stop was requested."""
        if self._stop_cause:
            raise Interrupted(self._stop_cause)

"""Decides which events of a run are reported to ``--notify``, and hands them to a thread of its own.

The tick only puts a message into a bounded queue. A command that fails, hangs or does not exist becomes an event of the
run and a warning, and has no other consequence.
"""

import threading
import time
from collections import deque
from collections.abc import Callable
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, NamedTuple

from smarig.cli.notify_command import Notification, NotifyCommand
from smarig.core import Sample, Severity, StepResult, StepVerdict, highest_severity, severity_of

if TYPE_CHECKING:
    from smarig.runner import RunControl

FAILED = "notify"  # kind of the event of a failed call
ALWAYS = frozenset({"resumed", "reconnected", "timed_out"})  # recoveries and stalls, whatever their severity
QUEUE = 32  # messages that may wait
REPEAT_S = 60.0  # host time within which a kind of event is reported once
PENDING_S = 3.0  # how long the end waits for earlier messages


class Notifier:
    """Runs the command for messages in their order, without blocking the caller of ``post``."""

    def __init__(self, command: NotifyCommand, on_failure: Callable[[str], None]) -> None:
        self.command, self._on_failure = command, on_failure
        self._waiting: deque[Notification] = deque()
        self._wake, self._idle = threading.Event(), threading.Event()
        self._thread: threading.Thread | None = None
        self._open = True
        self.undelivered = 0
        self.failures: list[str] = []

    def post(self, message: Notification) -> None:
        """Queue a message. A message that does not fit is counted and dropped."""
        if len(self._waiting) >= QUEUE:
            self.undelivered += 1
            return
        self._idle.clear()
        self._waiting.append(message)
        self._wake.set()
        if self._thread is None:
            self._thread = threading.Thread(target=self._deliver_all, name="notify", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Wait for a few seconds until all messages are delivered; then count and drop the rest."""
        if self._thread is None:
            return
        self._idle.wait(PENDING_S)
        self._open = False
        self.undelivered += len(self._waiting)
        self._waiting.clear()
        self.command.stop()
        self._wake.set()
        self._thread.join(PENDING_S)

    def deliver(self, message: Notification) -> None:
        """Run the command for a message in this thread."""
        failure = self.command.deliver(message)
        if failure:
            self.failures.append(failure)
            self._on_failure(f"--notify: '{self.command.text}' failed: {failure}.")

    def _deliver_all(self) -> None:
        while self._open:
            self._wake.wait()
            self._wake.clear()
            while self._open and self._waiting:
                self.deliver(self._waiting.popleft())
            if not self._waiting:
                self._idle.set()


class Subject(NamedTuple):
    """What a message is about; ``run`` is a run file, or the folder of several."""

    wire: str
    rig: str
    protocol: str
    run: str
    unit: str = ""


class NotificationListener:
    """A listener that posts what somebody should know: events of a severity, time-outs of settling, recoveries."""

    def __init__(
        self,
        notifier: Notifier,
        subject: Subject,
        least: Severity,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._notifier, self._subject, self._least, self._clock = notifier, subject, least, clock
        self._posted_s: dict[str, float] = {}  # host time of the last message of each kind
        self.highest = Severity.NONE

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Ignore samples."""

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Post a step that did not settle in time."""
        del target
        if result.verdict == StepVerdict.TIMED_OUT:
            name = f"Step {result.index + 1}{f' ({branch})' if branch else ''}"
            where = f"{result.position:+.3f} {self._subject.unit}"
            self._post("timed_out", Severity.MINOR, f"{name} did not settle in time. It is at {where}.")

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Post an event if its severity or its kind demands it."""
        del t_s
        severity = severity_of(kind, level, data)
        self.highest = highest_severity((self.highest, severity))
        if kind in ALWAYS or (severity.reaches(self._least) and kind != FAILED):
            self._post(kind, severity, text)

    def _post(self, kind: str, severity: Severity, text: str) -> None:
        now_s = self._clock()
        if now_s - self._posted_s.get(kind, -REPEAT_S) < REPEAT_S:
            return
        self._posted_s[kind] = now_s
        self._notifier.post(message_of(self._subject, kind, severity, text))


def message_of(subject: Subject, kind: str, severity: Severity, text: str) -> Notification:
    """A message about a run, of now."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return Notification(*subject[:4], now, severity, kind, text)


def report_to(control: "RunControl") -> Callable[[str], None]:
    """A function that has a failure recorded as an event of the run."""
    return lambda text: control.report(FAILED, text, level="warning")

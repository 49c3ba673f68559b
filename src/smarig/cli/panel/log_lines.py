"""Events of a run as lines: text for people, or one JSON object per line for programs.

At a terminal without a panel, there is one line per step and one for each kind of event within it; elsewhere, one line
per run. The JSON lines are complete.
"""

import time
from collections.abc import Callable
from dataclasses import asdict
from types import TracebackType
from typing import Any, Self

from smarig.cli.output import as_json
from smarig.cli.panel.keyboard import KEYS_HELP
from smarig.cli.panel.panel_layout import clock_text, summary
from smarig.cli.panel.terminal import LineWriter, Terminal
from smarig.core import Hold, Sample, Severity, StepResult, Waveform, severity_of
from smarig.runner import SettleWindow, end_severity
from smarig.running import RunStatus

_PROGRESS_S = 600.0


class _StatusUpdates:
    """Listener methods for which neither kind of line prints anything."""

    _status: RunStatus

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Print nothing: samples are in the run file."""
        self._status.sample(s, step, input_value)

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """Print nothing: a step is printed at its end."""
        self._status.begin(step, command, window)


class _TextLines(_StatusUpdates):
    """Lines of text, with the summary of the run at the end."""

    def __init__(self, status: RunStatus, terminal: Terminal) -> None:
        self._status, self._plain = status, terminal.plain
        self._writer = LineWriter(
            terminal, lambda n: f"{n} lines were dropped because they were not read in time."
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._status.end(error)
        self._writer.put(summary(self._status, plain=self._plain).plain)
        self._writer.close()


class LogLines(_TextLines):
    """Plain log lines: ``with LogLines(status, terminal) as listener``."""

    def __init__(self, status: RunStatus, terminal: Terminal) -> None:
        super().__init__(status, terminal)
        self._event_counts: dict[str, int] = {}  # events of each kind since the last step

    def __enter__(self) -> Self:
        run_info = self._status.run_info
        place = f" ({run_info.place})" if run_info.place else ""
        self._writer.put(
            f"{run_info.protocol}{place} on {run_info.rig} ({run_info.label}), wire {run_info.wire}: "
            f"{run_info.steps} steps, "
            f"about {clock_text(self._status.left_s)}.{' ' + KEYS_HELP if self._status.keys else ''}"
        )
        return self

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Print one line for the step."""
        number, run_info = self._status.step_number, self._status.run_info
        self._status.step(result, branch=branch, target=target)
        to = f" to {target:+.1f} K" if target is not None else ""
        repeated = ", ".join(f"{n - 1} more '{kind}'" for kind, n in self._event_counts.items() if n > 1)
        self._event_counts.clear()
        self._writer.put(
            f"{self._at(result.t_end_s)} step {number} of {run_info.steps} {branch}{to}: {result.verdict} at "
            f"{result.position:+.3f} {run_info.unit}, about {clock_text(self._status.left_s)} left"
            f"{f' ({repeated})' if repeated else ''}"
        )

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Print one line, for the first event of its kind in a step."""
        self._status.event(t_s, kind, text, level=level, **data)
        self._event_counts[kind] = self._event_counts.get(kind, 0) + 1
        if self._event_counts[kind] == 1:
            severity = severity_of(kind, level, data)
            word = f"{severity.upper()} " if severity != Severity.NONE else ""
            self._writer.put(f"{self._at(t_s)} {word}{kind}: {text}")

    def _at(self, t_s: float) -> str:
        return clock_text(self._status.since_s(t_s))


class SummaryLine(_TextLines):
    """One line per run, for pipes and files; besides, alarms, and a line of progress every ten minutes of the clock."""

    def __init__(
        self, status: RunStatus, terminal: Terminal, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(status, terminal)
        self._clock = clock
        self._next_s = clock() + _PROGRESS_S
        self._reported: set[str] = set()  # kinds of events

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Print a line of progress if the last one is long ago."""
        number = self._status.step_number
        self._status.step(result, branch=branch, target=target)
        self._show_progress(number)

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """The same: a sweep of hours is one step."""
        self._status.sample(s, step, input_value)
        self._show_progress(self._status.step_number)

    def _show_progress(self, number: int) -> None:
        if self._clock() < self._next_s:
            return
        self._next_s = self._clock() + _PROGRESS_S
        run_info = self._status.run_info
        left = f"about {clock_text(self._status.left_s)} left"
        self._writer.put(f"{run_info.protocol}: step {number} of {run_info.steps}, {left}")

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Print the first event of each kind that has a severity."""
        self._status.event(t_s, kind, text, level=level, **data)
        severity = severity_of(kind, level, data)
        if severity != Severity.NONE and kind not in self._reported:
            self._reported.add(kind)
            self._writer.put(f"{clock_text(self._status.since_s(t_s))} {severity.upper()} {kind}: {text}")


class JsonLogLines(_StatusUpdates):
    """JSON lines, {"event": …} and {"step": …}: ``with JsonLogLines(status, terminal) as listener``."""

    def __init__(self, status: RunStatus, terminal: Terminal) -> None:
        self._status = status
        self._writer = LineWriter(terminal, dropped_lines_json)

    def __enter__(self) -> "JsonLogLines":
        self._event(
            self._t_s,
            "start",
            "info",
            f"Run of {self._status.run_info.protocol} started.",
            asdict(self._status.run_info),
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._status.end(error)
        ending = self._status.ending
        cause = (ending.text or ending.word) if ending else ""
        failed = ending is not None and ending.kind in ("fault", "refused")
        level = "info" if error is None else "error" if failed else "warning"
        facts: dict[str, Any] = {"out": self._status.run_info.out, "steps": self._status.finished}
        refused = ending is not None and ending.kind == "refused"
        severity = Severity.NONE if refused else end_severity(error)
        facts |= {"severity": severity, "highest_severity": self._status.severity}
        self._event(self._t_s, "end", level, f"Run ended: {cause}", facts)
        self._writer.close()

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Print one object for the step."""
        number = self._status.step_number
        self._status.step(result, branch=branch, target=target)
        found = asdict(result) | {"verdict": str(result.verdict), "branch": branch, "target": target}
        place = {"number": number, "of": self._status.run_info.steps, "unit": self._status.run_info.unit}
        self._writer.put(as_json({"step": found | place | {"left_s": self._status.left_s}}))

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Print one object for the event."""
        self._status.event(t_s, kind, text, level=level, **data)
        self._event(t_s, kind, level, text, data)

    @property
    def _t_s(self) -> float:
        s = self._status.last_sample
        return s.t_s if s else 0.0

    def _event(self, t_s: float, kind: str, level: str, text: str, data: dict[str, Any]) -> None:
        self._writer.put(_event_line(t_s, kind, level, text, data))


def _event_line(t_s: float, kind: str, level: str, text: str, data: dict[str, Any]) -> str:
    severity = severity_of(kind, level, data)
    event = {"t_s": t_s, "kind": kind, "level": level, "severity": severity, "text": text, "data": data}
    return as_json({"event": event})


def dropped_lines_json(n: int) -> str:
    """The JSON line that reports how many lines were dropped."""
    return _event_line(
        0.0,
        "lost",
        "warning",
        f"{n} lines were dropped because they were not read in time.",
        {"lines": n, "severity": Severity.MINOR},  # the record has them
    )

"""What happens in a run, line by line: for people who read a log, and one JSON object a line for programs.

A log gets one line a step and one for each kind of event in a step; JSON lines leave out nothing.
"""

from dataclasses import asdict
from types import TracebackType
from typing import Any

from smarig.cli._keys import HELP
from smarig.cli._output import as_json
from smarig.cli._panel import clock_text, summary
from smarig.cli._situation import Situation
from smarig.cli._terminal import Speaker, Terminal
from smarig.command import Hold, StepResult, Waveform
from smarig.runner.settling import SettleWindow
from smarig.sample import Sample


class _Quiet:
    """What both kinds of lines only listen to: samples and beginnings."""

    _now: Situation

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Nothing to say: samples are in the run file."""
        self._now.sample(s, step, input_value)

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """Nothing to say: a step is told at its end."""
        self._now.begin(step, command, window)


class Lines(_Quiet):
    """``with Lines(situation, terminal) as listener``: plain lines."""

    def __init__(self, now: Situation, terminal: Terminal) -> None:
        self._now, self._plain = now, terminal.plain
        self._speaker = Speaker(terminal, lambda n: f"{n} lines were dropped: nobody read them in time.")
        self._told: dict[str, int] = {}  # events of each kind since the last step

    def __enter__(self) -> "Lines":
        about = self._now.about
        place = f" ({about.place})" if about.place else ""
        self._speaker.say(
            f"{about.protocol}{place} on {about.rig} ({about.label}), wire {about.wire}: {about.steps} steps, "
            f"about {clock_text(self._now.left_s)}.{' ' + HELP if self._now.keys else ''}"
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._now.end(error)
        self._speaker.say(summary(self._now, plain=self._plain).plain)
        self._speaker.close()

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """One line."""
        number, about = self._now.step_number, self._now.about
        self._now.step(result, branch=branch, target=target)
        to = f" to {target:+.1f} K" if target is not None else ""
        more = ", ".join(f"{n - 1} more '{kind}'" for kind, n in self._told.items() if n > 1)
        self._told.clear()
        self._speaker.say(
            f"{self._at(result.t_end_s)} step {number} of {about.steps} {branch}{to}: {result.verdict} at "
            f"{result.position:+.3f} {about.unit}, about {clock_text(self._now.left_s)} left"
            f"{f' ({more})' if more else ''}"
        )

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """One line, the first time in a step."""
        self._now.event(t_s, kind, text, level=level, **data)
        self._told[kind] = self._told.get(kind, 0) + 1
        if self._told[kind] == 1:
            word = f"{level.upper()} " if level != "info" else ""
            self._speaker.say(f"{self._at(t_s)} {word}{kind}: {text}")

    def _at(self, t_s: float) -> str:
        return clock_text(self._now.since_s(t_s))


class JsonLines(_Quiet):
    """``with JsonLines(situation, terminal) as listener``: {"event": …} and {"step": …}, one a line."""

    def __init__(self, now: Situation, terminal: Terminal) -> None:
        self._now = now
        self._speaker = Speaker(terminal, lost)

    def __enter__(self) -> "JsonLines":
        self._event(
            self._t_s, "start", "info", f"Run of {self._now.about.protocol} started.", asdict(self._now.about)
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._now.end(error)
        ending = self._now.ending
        cause = (ending.text or ending.word) if ending else ""
        level = "info" if error is None else "error" if ending and ending.kind == "fault" else "warning"
        facts = {"out": self._now.about.out, "steps": self._now.finished}
        self._event(self._t_s, "end", level, f"Run ended: {cause}", facts)
        self._speaker.close()

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """One object."""
        number = self._now.step_number
        self._now.step(result, branch=branch, target=target)
        found = asdict(result) | {"verdict": str(result.verdict), "branch": branch, "target": target}
        place = {"number": number, "of": self._now.about.steps, "unit": self._now.about.unit}
        self._speaker.say(as_json({"step": found | place | {"left_s": self._now.left_s}}))

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """One object."""
        self._now.event(t_s, kind, text, level=level, **data)
        self._event(t_s, kind, level, text, data)

    @property
    def _t_s(self) -> float:
        s = self._now.sample_now
        return s.t_s if s else 0.0

    def _event(self, t_s: float, kind: str, level: str, text: str, data: dict[str, Any]) -> None:
        self._speaker.say(_event_line(t_s, kind, level, text, data))


def _event_line(t_s: float, kind: str, level: str, text: str, data: dict[str, Any]) -> str:
    return as_json({"event": {"t_s": t_s, "kind": kind, "level": level, "text": text, "data": data}})


def lost(n: int) -> str:
    """The JSON line that tells how many lines nobody read."""
    return _event_line(
        0.0, "lost", "warning", f"{n} lines were dropped: nobody read them in time.", {"lines": n}
    )

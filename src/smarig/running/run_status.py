"""The state of a run for its displays, collected by a listener.

During a tick only values are stored. Figures are computed when they are read.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from smarig.config import RigFile
from smarig.core import (
    Hold,
    Interrupted,
    RigFault,
    Sample,
    Settled,
    Severity,
    SmarigError,
    StepResult,
    Waveform,
    highest_severity,
    severity_of,
)
from smarig.device import LinkFault
from smarig.plant import Actuator
from smarig.runner import RE_ESTABLISH, Preview, RunControl, SettleWindow, end_severity

_SILENT_S = 2.0  # without a sample, besides two ticks, until a device is said not to answer
_MIN_OBSERVED_S = 2.0  # of observation, before the speed factor is computed


@dataclass(frozen=True)
class PanelRunInfo:
    """Facts about a run that are known at its start. ``done_…``: what a resumed run had finished before.

    ``limits``: those in force that are set, by the names of the rig file. ``kind``: "run", or "check" for the bring-up
    of a rig, which has no steps and writes no file. ``folder``: the one that it belongs to; that of ``out`` for a run.
    ``rig_kind``: that of the rig file, "twin" or "bench"; simulated devices are a bench whose ``source`` is "twin".
    """

    protocol: str
    rig: str
    wire: str
    source: str
    two_wire: bool
    unit: str
    period_s: float
    steps: int
    duration_s: float
    out: Path
    place: str = ""
    done_steps: int = 0
    done_s: float = 0.0
    limits: Mapping[str, float] = field(default_factory=dict)
    kind: str = "run"
    folder: Path | None = None
    rig_kind: str = ""

    @property
    def label(self) -> str:
        """TWIN or BENCH: the source of the data."""
        return self.source.upper()


class LogEntry(NamedTuple):
    """An event as it was reported."""

    t_s: float
    level: str
    kind: str
    text: str
    severity: Severity


class SettlingProgress(NamedTuple):
    """Progress of a hold: share of its window, spread and band in counts (None: a hold of fixed duration),
    least time left and time to the time-out in seconds."""

    share: float
    spread_counts: float | None
    band_counts: float | None
    min_time_left_s: float
    timeout_s: float


class RunEnding(NamedTuple):
    """The end of a run: kind (done, stopped, fault or refused), a word and a sentence."""

    kind: str
    word: str
    text: str


def run_info(
    file: RigFile,
    expected: Preview,
    out: Path,
    *,
    wire: str,
    source: str,
    place: str = "",
    done_steps: int = 0,
    done_s: float = 0.0,
) -> PanelRunInfo:
    """The facts about a run on a rig, with the figures of its preview."""
    actuator = Actuator.named(file.actuator)
    rig = (file.name, wire, source, actuator.two_wire, actuator.unit, file.period_s)
    cost = (expected.steps, expected.duration_s)
    limits = file.limits.model_dump(exclude_none=True)
    done = (done_steps, done_s)
    return PanelRunInfo(expected.protocol, *rig, *cost, out, place, *done, limits, rig_kind=file.kind)


def check_info(file: RigFile, folder: Path) -> PanelRunInfo:
    """The facts about the bring-up of a bench; ``folder``: that of its rig file, or else that it is started in."""
    actuator = Actuator.named(file.actuator)
    rig = (file.name, file.wire, "bench", actuator.two_wire, actuator.unit, file.period_s)
    limits = file.limits.model_dump(exclude_none=True)
    none = {"steps": 0, "duration_s": 0.0, "out": Path()}
    return PanelRunInfo("check", *rig, **none, limits=limits, kind="check", folder=folder, rig_kind="bench")


class RunStatus:
    """A listener whose figures may be read from another thread at any time."""

    def __init__(
        self,
        run_info: PanelRunInfo,
        control: RunControl | None = None,
        *,
        keys: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.run_info, self.keys = run_info, keys
        self._control = control or RunControl()
        self._clock, self._started_s = clock, clock()
        self.last_sample: Sample | None = None
        self.samples = self.lost_samples = 0
        self._sampled_s = self._started_s  # by the host's clock
        self.input_K = 0.0
        self.command: Hold | Waveform | None = None
        self.finished = 0
        self.resumed = False
        self.done_steps, self.done_s = run_info.done_steps, run_info.done_s  # before it was resumed
        self.last_event: LogEntry | None = None
        self.error: LogEntry | None = None
        self.severity = Severity.NONE  # the highest so far
        self.ending: RunEnding | None = None
        self._window: SettleWindow | None = None
        self._first_s: float | None = None
        self._paused_ticks = self._restoring_ticks = self._step_ticks = 0

    # --- called by the runner -----------------------------------------------------------------------

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Store the sample."""
        del step
        if self._first_s is None:
            self._first_s = s.t_s - self.run_info.period_s
        if self.last_sample is not None:  # ticks of a device that was restarted begin again
            self.lost_samples += max(0, s.tick - self.last_sample.tick - 1)
        self.samples += 1
        self.last_sample, self.input_K = s, input_value
        self._sampled_s = self._clock()
        if self._control.paused:
            self._paused_ticks += 1
        else:
            self._step_ticks += 1
            self._restoring_ticks += self.branch == RE_ESTABLISH

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """Store the command of the step."""
        del step
        self._window, self._step_ticks, self.command = window, 0, command

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Count the step, unless it restores the state of a resumed run."""
        del result, target
        self.finished += branch != RE_ESTABLISH
        self.command = None

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Store the last event, the last error, the highest severity, and what was done before the run was resumed."""
        severity = severity_of(kind, level, data)
        self.last_event = entry = LogEntry(t_s, level, kind, text, severity)
        self.severity = highest_severity((self.severity, severity))
        if level == "error":
            self.error = entry
        if kind == "resumed":
            self.resumed = True
            self.done_steps = data.get("done_steps", self.done_steps)
            self.done_s = data.get("done_s", self.done_s)

    def end(self, error: BaseException | None) -> None:
        """Store how the run ended. An error of the user or the disk before the first sample is no fault of the rig."""
        if self.last_sample is None and _is_refusal(error):
            self.ending = RunEnding("refused", "NOT STARTED", str(error))
            return
        self.ending = _ending(error)
        self.severity = highest_severity((self.severity, end_severity(error)))

    # --- read by displays ---------------------------------------------------------------------------

    @property
    def step_number(self) -> int:
        """The number of the present step, or of the last one; from 1."""
        done = self.done_steps + self.finished
        return done + 1 if done < self.run_info.steps else max(done, 1)

    @property
    def branch(self) -> str:
        """The branch of the present step."""
        command = self.command
        return command.branch if command is not None else ""

    @property
    def target_K(self) -> float | None:
        """The hysteresis input that the step goes to."""
        return self.command.target if isinstance(self.command, Hold) else None

    @property
    def paused(self) -> bool:
        """Whether the run is paused."""
        return self._control.paused

    @property
    def stopping(self) -> bool:
        """Whether a stop was requested."""
        return self._control.stopping

    @property
    def elapsed_s(self) -> float:
        """Rig time since the start of the run, or since it was resumed."""
        return self.since_s(self.last_sample.t_s) if self.last_sample is not None else 0.0

    def since_s(self, t_s: float) -> float:
        """The device time ``t_s`` counted from the start of this run."""
        return max(t_s - self._first_s, 0.0) if self._first_s is not None else 0.0

    @property
    def left_s(self) -> float:
        """Rig time left according to the preview. It stays at 0 when the run takes longer than the preview.

        Pauses and the way back of a resumed run, which the preview does not know, do not shorten it.
        """
        unplanned_s = (self._paused_ticks + self._restoring_ticks) * self.run_info.period_s
        return max(self.run_info.duration_s - self.done_s - self.elapsed_s + unplanned_s, 0.0)

    @property
    def share(self) -> float:
        """The elapsed share of the expected duration, 0…1."""
        return 1 - self.left_s / self.run_info.duration_s if self.run_info.duration_s > 0 else 1.0

    @property
    def silent_s(self) -> float:
        """Seconds since the last sample, if a device of a bench does not answer; else 0. Steps must be left to do."""
        if self.last_sample is None or self.run_info.source != "bench" or self.ending is not None:
            return 0.0
        silent_s = self._clock() - self._sampled_s
        late = silent_s > _SILENT_S + 2 * self.run_info.period_s
        working = self.command is not None or self.finished + self.done_steps < self.run_info.steps
        return silent_s if late and working else 0.0

    @property
    def speed_factor(self) -> float:
        """Rig seconds per second of real time; 1 until it is known."""
        wall_time_s = self._clock() - self._started_s
        return self.elapsed_s / wall_time_s if wall_time_s > _MIN_OBSERVED_S and self.elapsed_s > 0 else 1.0

    @property
    def settling(self) -> SettlingProgress | None:
        """The progress of the hold; None between steps, in closed loops and at the end."""
        if self.ending is not None:
            return None
        command, window, elapsed_in_step_s = (
            self.command,
            self._window,
            self._step_ticks * self.run_info.period_s,
        )
        if command is None or window is None:
            return None
        if isinstance(command, Waveform):
            return _fixed_duration(len(command.currents_A) * command.period_s, elapsed_in_step_s)
        if not isinstance(command.until, Settled):
            return _fixed_duration(command.until.seconds, elapsed_in_step_s)
        min_time_left_s = window.min_ticks_left * self.run_info.period_s
        spread = window.spread_counts if window.progress > 0 else None
        left_s = max(command.until.timeout_s - elapsed_in_step_s, 0.0)
        return SettlingProgress(window.progress, spread, window.band_counts, min_time_left_s, left_s)


def _fixed_duration(whole_s: float, elapsed_in_step_s: float) -> SettlingProgress:
    left_s = max(whole_s - elapsed_in_step_s, 0.0)
    return SettlingProgress(1 - left_s / whole_s if whole_s > 0 else 1.0, None, None, left_s, left_s)


def _is_refusal(error: BaseException | None) -> bool:
    return isinstance(error, SmarigError) and not isinstance(error, RigFault | Interrupted)


def _ending(error: BaseException | None) -> RunEnding:
    if error is None:
        return RunEnding("done", "done", "")
    text = str(error) or type(error).__name__
    if isinstance(error, Interrupted | KeyboardInterrupt):
        return RunEnding("stopped", "STOPPED", text)
    tripped = isinstance(error, RigFault) and not isinstance(error, LinkFault)
    return RunEnding("fault", "TRIP" if tripped else "FAULT", text)

"""Where an experiment stands, for whoever shows it: a listener that keeps what a person wants to know.

In the tick it only remembers; every figure is worked out when somebody looks. Refuses to know how it is shown.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from smarig.command import Hold, Settled, StepResult, Waveform
from smarig.config import RigFile
from smarig.errors import Interrupted, RigFault
from smarig.model.actuator import Actuator
from smarig.runner.control import Control
from smarig.runner.preview import Preview
from smarig.runner.resumption import RE_ESTABLISH
from smarig.runner.settling import SettleWindow
from smarig.sample import Sample
from smarig.wire.blame import LinkFault

_STEADY_S = 2.0  # of watching, before a pace is worth telling


@dataclass(frozen=True)
class About:
    """What is run on what, known from the beginning; ``done_…``: what a run that goes on had finished before."""

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

    @property
    def label(self) -> str:
        """TWIN or BENCH: whose data these will be."""
        return self.source.upper()


class Told(NamedTuple):
    """An event as it was told."""

    t_s: float
    level: str
    kind: str
    text: str


class Settling(NamedTuple):
    """How far a hold is: share of its window, spread and band in counts (None: it just lasts), seconds to go at the
    earliest, seconds until it is given up."""

    share: float
    spread_counts: float | None
    band_counts: float | None
    soonest_s: float
    timeout_s: float


class Ending(NamedTuple):
    """How it ended: done, stopped or fault; a word and a sentence."""

    kind: str
    word: str
    text: str


def about(
    file: RigFile,
    expected: Preview,
    out: Path,
    *,
    wire: str,
    source: str,
    place: str = "",
    done_steps: int = 0,
    done_s: float = 0.0,
) -> About:
    """An experiment on a rig, with what its preview expects."""
    actuator = Actuator.named(file.actuator)
    rig = (file.name, wire, source, actuator.two_wire, actuator.unit, file.period_s)
    cost = (expected.steps, expected.duration_s)
    return About(expected.protocol, *rig, *cost, out, place, done_steps, done_s)


class Situation:
    """A listener; its figures may be read from another thread at any time."""

    def __init__(
        self,
        about: About,
        control: Control | None = None,
        *,
        keys: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.about, self.keys = about, keys
        self._control = control or Control()
        self._clock, self._began_s = clock, clock()
        self.sample_now: Sample | None = None
        self.input_K = 0.0
        self.command: Hold | Waveform | None = None
        self.finished = 0
        self.event_now: Told | None = None
        self.error: Told | None = None
        self.ending: Ending | None = None
        self._window: SettleWindow | None = None
        self._first_s: float | None = None
        self._paused_ticks = self._step_ticks = 0

    # --- told in the tick -------------------------------------------------------------------------

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Remember the sample."""
        del step
        if self._first_s is None:
            self._first_s = s.t_s - self.about.period_s
        self.sample_now, self.input_K = s, input_value
        if self._control.paused:
            self._paused_ticks += 1
        else:
            self._step_ticks += 1

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """Remember what the step is to be."""
        del step
        self._window, self._step_ticks, self.command = window, 0, command

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Count it, unless it was on the way back to where a run goes on."""
        del result, target
        self.finished += branch != RE_ESTABLISH
        self.command = None

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Remember the last one, and the last error."""
        del data
        self.event_now = told = Told(t_s, level, kind, text)
        if level == "error":
            self.error = told

    def end(self, error: BaseException | None) -> None:
        """It is over, by itself or by an error."""
        self.ending = _ending(error)

    # --- for who looks ----------------------------------------------------------------------------

    @property
    def step_number(self) -> int:
        """The step that is on, or the last one, from 1."""
        done = self.about.done_steps + self.finished
        return done + 1 if done < self.about.steps else max(done, 1)

    @property
    def branch(self) -> str:
        """The name of the stretch of the protocol."""
        command = self.command
        return command.branch if command is not None else ""

    @property
    def target_K(self) -> float | None:
        """The hysteresis input that the step goes to."""
        return self.command.target if isinstance(self.command, Hold) else None

    @property
    def paused(self) -> bool:
        """Whether a person holds it."""
        return self._control.paused

    @property
    def stopping(self) -> bool:
        """Whether it has been asked to end."""
        return self._control.stopping

    @property
    def gone_s(self) -> float:
        """Rig time since it began."""
        return self.since_s(self.sample_now.t_s) if self.sample_now is not None else 0.0

    def since_s(self, t_s: float) -> float:
        """A time of the device's, from the beginning of this run."""
        return max(t_s - self._first_s, 0.0) if self._first_s is not None else 0.0

    @property
    def left_s(self) -> float:
        """Rig time still to come by the preview; not below zero, where the wire takes longer than the twin did."""
        spent_s = self.about.done_s + self.gone_s - self._paused_ticks * self.about.period_s
        return max(self.about.duration_s - spent_s, 0.0)

    @property
    def share(self) -> float:
        """Of the expected duration, 0…1."""
        return 1 - self.left_s / self.about.duration_s if self.about.duration_s > 0 else 1.0

    @property
    def pace(self) -> float:
        """Rig seconds in a second of ours; 1 until it is known."""
        waited_s = self._clock() - self._began_s
        return self.gone_s / waited_s if waited_s > _STEADY_S and self.gone_s > 0 else 1.0

    @property
    def settling(self) -> Settling | None:
        """How far the hold is; None between steps, in closed loops and at the end."""
        if self.ending is not None:
            return None
        command, window, spent_s = self.command, self._window, self._step_ticks * self.about.period_s
        if command is None or window is None:
            return None
        if isinstance(command, Waveform):
            return _lasting(len(command.currents_A) * command.period_s, spent_s)
        if not isinstance(command.until, Settled):
            return _lasting(command.until.seconds, spent_s)
        soonest_s = window.soonest * self.about.period_s
        spread = window.spread_counts if window.progress > 0 else None
        left_s = max(command.until.timeout_s - spent_s, 0.0)
        return Settling(window.progress, spread, window.band_counts, soonest_s, left_s)


def _lasting(whole_s: float, spent_s: float) -> Settling:
    left_s = max(whole_s - spent_s, 0.0)
    return Settling(1 - left_s / whole_s if whole_s > 0 else 1.0, None, None, left_s, left_s)


def _ending(error: BaseException | None) -> Ending:
    if error is None:
        return Ending("done", "done", "")
    text = str(error) or type(error).__name__
    if isinstance(error, Interrupted | KeyboardInterrupt):
        return Ending("stopped", "STOPPED", text)
    tripped = isinstance(error, RigFault) and not isinstance(error, LinkFault)
    return Ending("fault", "TRIP" if tripped else "FAULT", text)

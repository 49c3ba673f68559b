"""The interface of listeners, and a listener made of functions. Listeners must not block the tick."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from smarig.core import Hold, Sample, StepResult, Waveform
from smarig.runner.settling_detection import SettleWindow


class Listener(Protocol):
    """Receives samples, steps and events of a run: the recorder, a progress line, a viewer."""

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """A sample, with its step and the predicted hysteresis input (kelvin)."""
        ...

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """A finished step."""
        ...

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """An event."""
        ...


@runtime_checkable
class StepStartListener(Protocol):
    """An optional method of a listener: it receives each step at its start, with the settle window."""

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """A step starts. ``window`` belongs to the runner and must not be changed."""
        ...


@runtime_checkable
class SuspectListener(Protocol):
    """An optional method of a listener: readings turned out to contradict each other."""

    def suspect(self, from_s: float) -> None:
        """The readings since then contradict each other."""
        ...


def _ignore(*_: Any) -> None:
    """Do nothing."""


@dataclass(frozen=True)
class CallbackListener:
    """A listener made of functions: on_sample(s, step, input_K), on_step(result), on_event(kind, t_s)."""

    on_sample: Callable[[Sample, int | None, float], None] = _ignore
    on_step: Callable[[StepResult], None] = _ignore
    on_event: Callable[[str, float], None] = _ignore

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Pass a sample on."""
        self.on_sample(s, step, input_value)

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Pass a finished step on."""
        del branch, target
        self.on_step(result)

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Pass an event on."""
        del text, level, data
        self.on_event(kind, t_s)

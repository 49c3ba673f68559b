"""The items of the draw queue: samples, finished steps and events."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from smarig.core import Sample, Severity, StepResult, severity_of
from smarig.live.draw_queue import DrawQueue


class SampleItem(NamedTuple):
    """A sample with its step and predicted input."""

    sample: Sample
    step: int | None
    input_value: float


@dataclass(frozen=True, slots=True)
class StepItem:
    """A finished step."""

    t_start_s: float
    t_s: float
    index: int
    verdict: str
    branch: str
    target: float | None
    position: float | None


@dataclass(frozen=True, slots=True)
class EventItem:
    """An event."""

    t_s: float
    level: str
    kind: str
    text: str
    severity: Severity


LiveItem = SampleItem | StepItem | EventItem


class QueueListener:
    """The runner's listener. It queues everything and does nothing else within the tick."""

    def __init__(self, draw_queue: DrawQueue) -> None:
        self._put = draw_queue.put

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Queue a sample."""
        self._put(SampleItem(s, step, input_value))

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Queue a finished step."""
        verdict = str(result.verdict)
        self._put(
            StepItem(
                t_start_s=result.t_start_s,
                t_s=result.t_end_s,
                index=result.index,
                verdict=verdict,
                branch=branch,
                target=target,
                position=result.position,
            )
        )

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Queue an event."""
        self._put(EventItem(t_s, level, kind, text, severity_of(kind, level, data)))

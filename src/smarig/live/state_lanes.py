"""Lanes of states under the time series: step, direction of the current, verdicts of steps, state of the
run.

A change is a state with the time at which it starts.
"""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np

from smarig.core import Quality, Sample, Settled
from smarig.live import colours
from smarig.live.live_items import EventItem, LiveItem, SampleItem, StepItem
from smarig.live.primitives import Primitive, StateLane, StateLegend
from smarig.plant import Actuator
from smarig.runner import Approach, SettleWindow

RUN_STATES = {
    "start": "running",
    "paused": "paused",
    "unpaused": "running",
    "resumed": "running",
    "end": "ended",
}
STATE_COLOURS = {
    "lanes/direction": {"rising": colours.HEATING, "falling": colours.COOLING, "steady": colours.FAINT},
    "lanes/verdict": {
        "waiting": colours.FAINT,
        "settled": colours.GOOD,
        "elapsed": colours.SKY,
        "timed_out": colours.ORANGE,
        "interrupted": colours.BAD,
    },
    "lanes/run": {
        "running": colours.GOOD,
        "paused": colours.ORANGE,
        "tripped": colours.BAD,
        "trouble": colours.BAD,
        "ended": colours.FAINT,
    },
}


NAN = float("nan")


class StateTracker:
    """Follows a run and draws the changes of its states."""

    def __init__(self) -> None:
        self._current: dict[str, str] = {}
        self._command_A = 0.0
        self._t_s = 0.0

    def legends(self) -> list[Primitive]:
        """Colours of the states that have a meaning."""
        return [StateLegend(path, dict(of)) for path, of in STATE_COLOURS.items()]

    def after(self, items: Sequence[LiveItem]) -> list[Primitive]:
        """The changes within a batch."""
        found: dict[str, list[tuple[float, str]]] = {}
        for item in items:
            for path, t_s, state in self._changes(item):
                if self._current.get(path) != state:
                    self._current[path] = state
                    found.setdefault(path, []).append((t_s, state))
        return [
            StateLane(path, np.array([t for t, _ in changes]), tuple(s for _, s in changes))
            for path, changes in found.items()
        ]

    def _changes(self, item: LiveItem) -> Sequence[tuple[str, float, str]]:
        if isinstance(item, SampleItem):
            return self._sample_changes(item)
        self._t_s = item.t_s
        if isinstance(item, StepItem):
            # A verdict is known only at the end of its step, so its lane is written backwards over the whole
            # step.
            return [("lanes/verdict", item.t_start_s, item.verdict), ("lanes/verdict", item.t_s, "waiting")]
        return self._event_changes(item)

    def _event_changes(self, item: EventItem) -> Sequence[tuple[str, float, str]]:
        if item.level == "error":
            return [("lanes/run", item.t_s, "trouble")]
        return [("lanes/run", item.t_s, RUN_STATES[item.kind])] if item.kind in RUN_STATES else []

    def _sample_changes(self, item: SampleItem) -> Sequence[tuple[str, float, str]]:
        s, changes = item.sample, []
        name = f"step {item.step}" if item.step is not None else "between"
        t_s = s.t_s if s.t_s == s.t_s else float(s.tick)
        if self._current.get("lanes/step") != name:
            changes.append(("lanes/step", t_s, name))
        if s.current_command_A != self._command_A:
            direction = "rising" if s.current_command_A > self._command_A else "falling"
            changes.append(("lanes/direction", t_s, direction))
            self._command_A = s.current_command_A
        if s.quality & Quality.TRIPPED:
            changes.append(("lanes/run", t_s, "tripped"))
        elif "lanes/run" not in self._current:
            changes.append(("lanes/run", t_s, "running"))
        return changes


class SettlingMonitor:
    """Follows the samples of holds. ``after`` gives (counts from the window's mean, least seconds left)."""

    def __init__(self, until: Settled, actuator: Actuator, period_s: float) -> None:
        self._until, self._actuator, self._period_s = until, actuator, period_s
        self.band_counts = until.band_counts
        self._size = max(1, round(until.window_s / period_s))
        self._step: int | None = None
        self._input_K = 0.0
        self._begin(0.0)

    def _begin(self, current_A: float) -> None:
        self._window = SettleWindow(self._until, self._period_s)
        distance_K = self._actuator.input_for(current_A) - self._input_K
        decay = math.exp(-self._period_s / self._actuator.tau_s)
        self._approach = Approach(distance_K, self._until.approach_K, decay)
        self._counts: deque[int] = deque()
        self._sum = 0

    def after(self, s: Sample, step: int | None, input_K: float) -> tuple[float, float]:
        """Values for the step of the sample; NaN between steps."""
        if step != self._step:
            self._step = step
            self._begin(s.current_command_A)
        arrived = self._approach.passed()
        self._input_K = input_K
        if step is None:
            return NAN, NAN
        self._window.add(s.counts, arrived)
        self._counts.append(s.counts)
        self._sum += s.counts
        if len(self._counts) > self._size:
            self._sum -= self._counts.popleft()
        left_s = 0.0 if self._window.settled else self._window.min_ticks_left * self._period_s
        return s.counts - self._sum / len(self._counts), left_s

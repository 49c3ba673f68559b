"""Lanes of states under the time series: which step, where the current goes, how steps ended, how the run goes.

A change is a state with the time it begins at. Knows no viewer.
"""

from collections.abc import Sequence

import numpy as np

from smarig.live import colours
from smarig.live.marks import Lane, LaneLegend, Mark
from smarig.live.seen import Seen, Stepped, Ticked, Told
from smarig.sample import Quality

RUN = {
    "start": "running",
    "paused": "paused",
    "unpaused": "running",
    "resumed": "running",
    "end": "ended",
}
COLOURS = {
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


class Lanes:
    """Follows a run and tells changes of state."""

    def __init__(self) -> None:
        self._now: dict[str, str] = {}
        self._command_A = 0.0
        self._t_s = 0.0

    def legends(self) -> list[Mark]:
        """Colours of the states that have a meaning."""
        return [LaneLegend(path, dict(of)) for path, of in COLOURS.items()]

    def after(self, items: Sequence[Seen]) -> list[Mark]:
        """What changed in a batch."""
        found: dict[str, list[tuple[float, str]]] = {}
        for item in items:
            for path, t_s, state in self._changes(item):
                if self._now.get(path) != state:
                    self._now[path] = state
                    found.setdefault(path, []).append((t_s, state))
        return [
            Lane(path, np.array([t for t, _ in changes]), tuple(s for _, s in changes))
            for path, changes in found.items()
        ]

    def _changes(self, item: Seen) -> Sequence[tuple[str, float, str]]:
        if isinstance(item, Ticked):
            return self._at_sample(item)
        self._t_s = item.t_s
        if isinstance(item, Stepped):
            # known only now, drawn over the whole step: a lane may be written backwards
            return [("lanes/verdict", item.t_start_s, item.verdict), ("lanes/verdict", item.t_s, "waiting")]
        return self._at_event(item)

    def _at_event(self, item: Told) -> Sequence[tuple[str, float, str]]:
        if item.level == "error":
            return [("lanes/run", item.t_s, "trouble")]
        return [("lanes/run", item.t_s, RUN[item.kind])] if item.kind in RUN else []

    def _at_sample(self, item: Ticked) -> Sequence[tuple[str, float, str]]:
        s, changes = item.sample, []
        name = f"step {item.step}" if item.step is not None else "between"
        t_s = s.t_s if s.t_s == s.t_s else float(s.tick)
        if self._now.get("lanes/step") != name:
            changes.append(("lanes/step", t_s, name))
        if s.current_command_A != self._command_A:
            way = "rising" if s.current_command_A > self._command_A else "falling"
            changes.append(("lanes/direction", t_s, way))
            self._command_A = s.current_command_A
        if s.quality & Quality.TRIPPED:
            changes.append(("lanes/run", t_s, "tripped"))
        elif "lanes/run" not in self._now:
            changes.append(("lanes/run", t_s, "running"))
        return changes

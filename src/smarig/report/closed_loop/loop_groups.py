"""Closed loops put in groups in which they can be compared: along one reference, or at one set-point disturbed alike.

Knows runs and what their loops did; refuses to know tables and figures.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from smarig.record import Run
from smarig.report.closed_loop.loop_result import LoopSegment, RegulationResult, TrackingResult

Found = TypeVar("Found", TrackingResult, RegulationResult)
_EMPTY_SEGMENT = LoopSegment(*(np.empty(0) for _ in range(5)), count=0.0)


@dataclass(frozen=True, eq=False)
class ComparedLoop(Generic[Found]):
    """The loop of a run among others; ``k`` is the run's colour on the page."""

    k: int
    name: str
    run: Run
    result: Found

    @property
    def loop(self) -> LoopSegment:
        """Its samples; none where it was never closed."""
        return self.result.loop or _EMPTY_SEGMENT

    @property
    def count(self) -> float:
        """One count in the run's unit; 0 where the loop was never closed, or the run does not say."""
        return self.loop.count

    @property
    def drawn(self) -> bool:
        """Whether there is a loop to draw."""
        return self.loop.t_s.size >= 2

    @property
    def lead_s(self) -> float | None:
        """How far its controller looks ahead, where the record says so."""
        try:
            return float(self.run.info.settings["lead_s"])
        except (KeyError, TypeError, ValueError):
            return None


ComparedTracking = ComparedLoop[TrackingResult]
ComparedRegulation = ComparedLoop[RegulationResult]


def group_by_reference(loops: Sequence[ComparedTracking]) -> list[list[ComparedTracking]]:
    """Those that followed the same positions at the same times, whatever the references are called."""
    return _grouped(loops, [(r.t_s, r.position, r.held) for r in (each.result.reference for each in loops)])


def group_by_setpoint(loops: Sequence[ComparedRegulation]) -> list[list[ComparedRegulation]]:
    """Those that held the same set-point against the same disturbance."""
    return _grouped(
        loops, [(each.result.setpoint_data["setpoint"], each.result.disturbance_K) for each in loops]
    )


def _grouped(
    loops: Sequence[ComparedLoop[Found]], keys: Sequence[Hashable]
) -> list[list[ComparedLoop[Found]]]:
    groups: dict[Hashable, list[ComparedLoop[Found]]] = {}
    for each, key in zip(loops, keys):
        groups.setdefault(key, []).append(each)
    return list(groups.values())

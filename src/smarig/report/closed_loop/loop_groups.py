"""Groups of comparable closed loops: the same reference, or the same set-point and disturbance."""

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
    """A closed loop in a comparison; ``k`` is the colour index of its run on the page."""

    k: int
    name: str
    run: Run
    result: Found

    @property
    def loop(self) -> LoopSegment:
        """The samples of the loop; none if it was never closed."""
        return self.result.loop or _EMPTY_SEGMENT

    @property
    def count(self) -> float:
        """One count in the run's unit; 0 if the loop was never closed or the count size is unknown."""
        return self.loop.count

    @property
    def drawn(self) -> bool:
        """Whether the loop has enough samples to draw."""
        return self.loop.t_s.size >= 2

    @property
    def lead_s(self) -> float | None:
        """The preview time of its controller, None if the record does not contain it."""
        try:
            return float(self.run.info.settings["lead_s"])
        except (KeyError, TypeError, ValueError):
            return None


ComparedTracking = ComparedLoop[TrackingResult]
ComparedRegulation = ComparedLoop[RegulationResult]


def group_by_reference(loops: Sequence[ComparedTracking]) -> list[list[ComparedTracking]]:
    """Group loops with the same positions at the same times, independent of the reference's name."""
    return _grouped(loops, [(r.t_s, r.position, r.held) for r in (each.result.reference for each in loops)])


def group_by_setpoint(loops: Sequence[ComparedRegulation]) -> list[list[ComparedRegulation]]:
    """Group loops with the same set-point and the same disturbance."""
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

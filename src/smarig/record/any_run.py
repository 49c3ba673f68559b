"""What a run in memory (``Run``) and a run in its file (``StoredRun``) have in common."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from functools import cached_property
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.core import Array, Severity, highest_severity
from smarig.record.recording_lock import is_recording
from smarig.record.run_info import RunInfo
from smarig.record.stopped_by import StoppedBy

_NEVER_CLOSED = "the run was never closed"
MAY_FLOW = "Its source has no lease: its current may still be on. Make sure that it is switched off."

if TYPE_CHECKING:
    from smarig.record.run import Event, Step

_ENDS = ("end", "interrupted")  # kinds of events at the end of an attempt
BLOCK_ROWS = 50_000  # of the blocks that large runs are written in


class AnyRun(ABC):
    """A run: its description, steps and events, and its columns by name. ``len`` is the number of samples."""

    path: Path
    meta: dict[str, Any]
    steps: "tuple[Step, ...]"
    events: "tuple[Event, ...]"

    @abstractmethod
    def __getitem__(self, name: str) -> Array:
        """A column (n,), NaN where absent."""

    @abstractmethod
    def __len__(self) -> int:
        """Number of samples."""

    @abstractmethod
    def has(self, name: str) -> bool:
        """Whether a channel was measured."""

    @abstractmethod
    def blocks(self, names: Sequence[str], rows: int = BLOCK_ROWS) -> Iterator[dict[str, Array]]:
        """The named columns in blocks of that many rows, in order."""

    @abstractmethod
    def extremes(self, name: str) -> tuple[float, float] | None:
        """The smallest and the largest value of a channel; None if it was not measured."""

    @abstractmethod
    def marked(self, *marks: int) -> tuple[int, ...]:
        """The number of samples with each of these quality marks."""

    @property
    @abstractmethod
    def span_s(self) -> float:
        """Time from the first to the last sample that has one; 0 if none has."""

    @cached_property
    def info(self) -> RunInfo:
        """The description, typed."""
        return RunInfo.of(self.meta, self.path.name)

    @property
    def name(self) -> str:
        """The name of the file without the endings of run files: "qv.first3" for qv.first3.run.sqlite."""
        return self.path.name.removesuffix(".sqlite").removesuffix(".run")

    @property
    def complete(self) -> bool:
        """Whether the run was closed (kill -9 and power cuts leave it open)."""
        return self.info.has("end")

    @property
    def cause(self) -> str:
        """Why the run ended: 'done', what interrupted it, or that it was never closed."""
        end = self.info.end
        return f"incomplete: {self._not_closed}" if end is None or end.cause is None else end.cause

    @property
    def past_cause(self) -> str:
        """The cause for the record of what followed: what may have flowed then has been ordered to zero since."""
        end = self.info.end
        return f"incomplete: {_NEVER_CLOSED}" if end is None or end.cause is None else end.cause

    @property
    def early_end(self) -> str:
        """Why the run did not end as planned, as a clause; "" if it did."""
        if self.cause == "done":
            return ""
        end = self.info.end
        return self._not_closed if end is None or end.cause is None else end.cause.rstrip(".")

    @property
    def may_flow(self) -> bool:
        """Whether its current may have stayed on: it was cut off, and the source has no lease."""
        return not self.complete and self.meta.get("has_lease") is False and not is_recording(self.path)

    @property
    def _not_closed(self) -> str:
        if is_recording(self.path):
            return "the run is still being recorded"
        return f"{_NEVER_CLOSED}{f'. {MAY_FLOW}' if self.may_flow else ''}".rstrip(".")

    @property
    def stopped_by(self) -> StoppedBy | None:
        """Who asked for the end; None if nobody did, or if it was not recorded."""
        return self.info.end.stopped_by if self.info.end is not None else None

    @property
    def severity(self) -> Severity:
        """The highest severity of its events."""
        return highest_severity(e.severity for e in self.events)

    @property
    def remaining_severity(self) -> Severity:
        """The highest severity of the events that no resumption has made good: their steps were repeated."""
        resumed = [e for e in self.events if e.kind == "resumed"]
        over_s = max((e.t_s for e in resumed if e.data.get("start_over") is True), default=-inf)
        last_s = max((e.t_s for e in resumed), default=-inf)
        remaining = [e for e in self.events if e.t_s >= (last_s if e.kind in _ENDS else over_s)]
        return highest_severity(e.severity for e in remaining)

    @property
    def twin(self) -> bool:
        """Whether the run was made on a twin."""
        return self.info.source == "twin"

    @property
    def unit(self) -> str:
        """Unit of position."""
        return self.info.output.unit

    @property
    def input_unit(self) -> str:
        """Unit of the hysteresis input."""
        return self.info.input.unit

    @cached_property
    def settled(self) -> "tuple[Step, ...]":
        """Valid steps with a target and a position, in order: the points (T_i, p_i) of §5.2.1."""
        return tuple(s for s in self.steps if not s.void and s.target is not None and s.position is not None)

    def points(self) -> tuple[Array, Array]:
        """Settled inputs and outputs, each (k,); those of every sample if there are no steps."""
        if self.settled:
            return (
                np.array([s.target for s in self.settled], dtype=float),
                np.array([s.position for s in self.settled], dtype=float),
            )
        u, y = self["input"], self["position"]
        known = np.isfinite(u) & np.isfinite(y)
        return u[known], y[known]

    def __repr__(self) -> str:
        kind = "twin" if self.twin else self.info.text_of("source", "?")
        return (
            f"Run({self.info.text_of('protocol', '?')} on {self.info.text_of('rig', '?')} ({kind}), "
            f"{len(self)} samples, {self.span_s / 3600:.2f} h, {len(self.steps)} steps, {self.cause})"
        )

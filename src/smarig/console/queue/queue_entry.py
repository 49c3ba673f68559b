"""An entry of the queue as it is stored: what was requested, its place, its state and its outcome."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from smarig.console.queue.entry_request import EntryRequest


class EntryState(StrEnum):
    """What has become of an entry."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    STOPPED = "stopped"  # by a person, or not continued after an interruption
    FAILED = "failed"  # its command ended with an error
    INTERRUPTED = "interrupted"  # its process is gone without an outcome: killed, or the machine restarted
    REMOVED = "removed"


CONTINUABLE = (EntryState.INTERRUPTED, EntryState.STOPPED, EntryState.FAILED)
ENDED = (EntryState.DONE, *CONTINUABLE)
COLUMNS = (
    "id",
    "request",
    "state",
    "place",
    "added",
    "started",
    "ended",
    "exit_status",
    "sentence",
    "duration_s",
    "expected_s",
    "continued",
    "pid",
)


@dataclass(frozen=True)
class QueueEntry:
    """One entry. Times are seconds since 1970.

    ``duration_s`` is the predicted time of its runs, ``expected_s`` the time that they take on the clock (a twin may
    run faster). ``continued``: it continues what was interrupted. ``pid``: the process of its last start.
    """

    id: int
    request: EntryRequest
    state: EntryState
    place: int
    added: float
    started: float | None
    ended: float | None
    exit_status: int | None
    sentence: str
    duration_s: float
    expected_s: float
    continued: bool
    pid: int | None

    @classmethod
    def from_row(cls, row: tuple[Any, ...]) -> "QueueEntry":
        """From the columns ``COLUMNS``. Raises DataError for damaged arguments."""
        values = dict(zip(COLUMNS, row, strict=True))
        values["request"] = EntryRequest.from_json(values["request"])
        return cls(**values | {"state": EntryState(values["state"]), "continued": bool(values["continued"])})

    def left_s(self, now: float) -> float:
        """Expected time until it ends, if it is running or waits for nothing else."""
        passed = now - self.started if self.state is EntryState.RUNNING and self.started else 0.0
        return max(self.expected_s - max(passed, 0.0), 0.0)

"""The queue of a folder as people use it: runs and campaigns in order, changed while they wait."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from smarig.console.own_code import OwnCode
from smarig.console.queue.allowed_entries import AllowedEntries
from smarig.console.queue.entry_preview import EntryPreview, Previewer, preview_entry
from smarig.console.queue.entry_process import check_system
from smarig.console.queue.entry_request import EntryRequest, check_request
from smarig.console.queue.output_check import check_inside, check_no_other, with_checked_output
from smarig.console.queue.queue_entry import CONTINUABLE, ENDED, EntryState, QueueEntry
from smarig.console.queue.queue_file import QueueFile
from smarig.core import StorageError, UsageError

WAITING, RUNNING = EntryState.WAITING, EntryState.RUNNING


@dataclass(frozen=True)
class QueueState:
    """Whether the next entry will be started, and why not. ``paused_by``: the entry whose end paused the queue."""

    paused: bool
    sentence: str
    paused_by: int | None
    stop_after_this: bool


@dataclass(frozen=True)
class HeldEntry:
    """An entry with the own code that it runs, and the mark of both: it differs whenever one of them does."""

    entry: QueueEntry
    code: tuple[OwnCode, ...]
    mark: str


class Queue:
    """``with Queue.open(folder) as queue: queue.add(request); ensure_worker(folder)``.

    It only changes the file; the worker starts the entries that a person has asked for: by ``add``, ``edit``, ``allow``
    or ``continue_interrupted`` here, under this account of this computer (``AllowedEntries``). It may be used by
    several threads and processes at once.
    """

    def __init__(self, folder: Path, file: QueueFile, previewer: Previewer) -> None:
        self.folder, self._file, self._previewer = folder, file, previewer
        self._allowed = AllowedEntries(folder)

    @classmethod
    def open(cls, folder: Path, previewer: Previewer = preview_entry) -> Self:
        """The queue of a folder, which is made if it is missing. Raises DataError, StorageError or UsageError."""
        check_system()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"Folder {folder} cannot be used: {error.strerror or error}.") from None
        return cls(folder, QueueFile(folder), previewer)

    def close(self) -> None:
        """Close the file. Runs and the worker go on."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def add(self, request: EntryRequest) -> int:
        """Check, preview and add an experiment at the end; returns its number. Raises UsageError in one sentence."""
        request, preview = self._checked(request)
        with self._file.transaction():
            check_no_other(request, self._unfinished())
            place = self._file.place("max") + 1
            columns = _columns(request, preview)
            number = self._file.insert(state=WAITING, place=place, added=time.time(), **columns)
            self._allowed.allow(number, request)
        return number

    def edit(self, number: int, request: EntryRequest) -> None:
        """Replace what an entry that waits will do. Checked as in ``add``."""
        self._waiting(number)
        request, preview = self._checked(request)
        with self._file.transaction():
            if self._waiting(number).continued:
                raise UsageError(f"Entry {number} continues a run, so it cannot be edited. Add a new one.")
            check_no_other(request, [e for e in self._unfinished() if e.id != number])
            self._allowed.take(self._waiting(number))
            self._file.update(number, **_columns(request, preview))
            self._allowed.allow(number, request)

    def move(self, number: int, before: int | None = None) -> None:
        """Place an entry that waits before another that waits, or at the end."""
        with self._file.transaction():
            self._waiting(number)
            order = [e.id for e in self._file.entries(WAITING) if e.id != number]
            if before is not None and before != number:
                self._waiting(before)
                order.insert(order.index(before), number)
            elif before is None:
                order.append(number)
            else:
                return
            for place, one in enumerate(order, start=1):
                self._file.update(one, place=place)

    def remove(self, number: int) -> None:
        """Take an entry that waits out of the queue."""
        with self._file.transaction():
            self._allowed.take(self._waiting(number))
            self._file.update(number, state=EntryState.REMOVED, ended=time.time())

    def held(self) -> list[HeldEntry]:
        """The entries that wait for a person: those that came with the folder, or whose own code has changed since."""
        waiting = self._file.entries(WAITING)
        return [self._held(entry) for entry in waiting if not self._allowed.has(entry)]

    def held_entry(self, number: int) -> HeldEntry:
        """An entry with what a person must see before it is started."""
        return self._held(self._file.entry(number))

    def allow(self, number: int, mark: str) -> None:
        """Let the worker start an entry that waits, as it was shown with this mark. UsageError if it has changed."""
        with self._file.transaction():
            entry = self._waiting(number)
            if self._allowed.mark_of(number, entry.request) != mark:
                raise UsageError(f"Entry {number} has changed since it was shown. Look at it again.")
            if entry.continued:
                check_inside(entry.request, self.folder)
            else:
                with_checked_output(entry.request, self.folder)
            self._allowed.allow(number, entry.request, as_shown=True)

    def entry(self, number: int) -> QueueEntry:
        """One entry. Raises UsageError if there is none with this number."""
        return self._file.entry(number)

    def entries(self, newest: int | None = None) -> list[QueueEntry]:
        """Those that have ended, the one that runs, and those that wait, in order; of the ended only the ``newest``."""
        with self._file.transaction(reading=True):
            ended = self._file.entries(*ENDED, newest=newest)
            return [*ended, *self._file.entries(RUNNING), *self._file.entries(WAITING)]

    def state(self) -> QueueState:
        """Whether the queue is paused, and why."""
        paused = self._file.get("paused")
        stop_after_this = bool(self._file.get("stop_after_this"))
        if paused is None:
            return QueueState(False, "", None, stop_after_this)
        return QueueState(True, paused["sentence"], paused["by"], stop_after_this)

    def pause(self) -> None:
        """Start no further entry. The one that runs is not touched."""
        with self._file.transaction():
            self._file.set(paused={"sentence": "Paused by a person.", "by": None}, stop_after_this=None)

    def go_on(self) -> None:
        """Start entries again, one after the other."""
        with self._file.transaction():
            self._file.set(paused=None, stop_after_this=None)

    def stop_after_this(self) -> None:
        """Pause the queue when the entry that runs has ended. Raises UsageError if none runs."""
        with self._file.transaction():
            if not self._file.entries(RUNNING):
                raise UsageError("Nothing is running. Pause the queue instead.")
            self._file.set(stop_after_this=True)

    def continue_interrupted(self, number: int) -> None:
        """Continue an entry that was interrupted, stopped or tripped, as the next one.

        The queue goes on if this entry had paused it.
        """
        with self._decided(number) as entry:
            check_no_other(entry.request, [e for e in self._unfinished() if e.id != number])
            check_inside(entry.request, self.folder)
            self._allowed.allow(number, entry.request, as_shown=True)
            place = self._file.place("min") - 1
            cleared: dict[str, Any] = {"ended": None, "exit_status": None, "sentence": ""}
            self._file.update(number, state=WAITING, place=place, continued=1, **cleared)

    def skip_interrupted(self, number: int) -> None:
        """Leave an interrupted entry as it is. The queue goes on if this entry had paused it."""
        with self._decided(number) as entry:
            if entry.state is EntryState.INTERRUPTED:
                sentence = f"{entry.sentence} It was not continued."
                self._file.update(number, state=EntryState.STOPPED, sentence=sentence)

    def ends_at(self, now: float) -> float | None:
        """When everything will have ended, if the queue goes on now; None if nothing waits or runs."""
        left = [entry.left_s(now) for entry in self._unfinished()]
        return now + sum(left) if left else None

    @contextmanager
    def _decided(self, number: int) -> Iterator[QueueEntry]:
        with self._file.transaction():
            entry = self._file.entry(number)
            if entry.state not in CONTINUABLE:
                raise UsageError(f"Entry {number} is {entry.state}. There is nothing to continue or skip.")
            yield entry
            paused = self._file.get("paused")
            if paused is not None and paused["by"] == number:
                self._file.set(paused=None)

    def _checked(self, request: EntryRequest) -> tuple[EntryRequest, EntryPreview]:
        check_request(request)
        request = with_checked_output(request, self.folder)
        return request, self._previewer(request, self.folder)

    def _held(self, entry: QueueEntry) -> HeldEntry:
        code = self._allowed.code_of(entry.id, entry.request)
        return HeldEntry(entry, code, self._allowed.mark_of(entry.id, entry.request))

    def _unfinished(self) -> list[QueueEntry]:
        return self._file.entries(RUNNING, WAITING)

    def _waiting(self, number: int) -> QueueEntry:
        entry = self._file.entry(number)
        if entry.state is not WAITING:
            raise UsageError(f"Entry {number} is {entry.state}; only entries that wait can be changed.")
        return entry


def _columns(request: EntryRequest, preview: EntryPreview) -> dict[str, Any]:
    return {"request": request.to_json(), "duration_s": preview.duration_s, "expected_s": preview.expected_s}

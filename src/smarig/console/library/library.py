"""The library of a folder: found again by words, tags, wires and dates, years later.

Everything but tags and notes is read from the files; the library can be deleted at any time. Several processes may use
one library; one of them scans at a time. The methods may be called from any thread.

How the figures of a wire have changed over its runs.
"""

import contextlib
import json
import sqlite3
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.console.library.database import DamagedLibrary, Database
from smarig.console.library.entry_rows import entries, loop_of
from smarig.console.library.library_entry import MODEL, RUN, Entry, one_line
from smarig.console.library.library_search import Question, SearchPage, facets, search
from smarig.console.library.notes_file import (
    LONGEST_WHO,
    NOTES_FILE,
    Annotation,
    NotesFile,
    checked_note,
    checked_tags,
    is_taken_over,
    take_over,
    wrong_notes,
)
from smarig.console.library.result_content import ERROR
from smarig.console.library.scan import Progress, Scan, ScanResult
from smarig.core import Array, InUse, SmarigError, UsageError, process_lock

_OF_RUNS = ("stroke", "A_s", "A_f", "M_s", "M_f", "cycles")
QUANTITIES = {**dict.fromkeys(_OF_RUNS, RUN), ERROR: MODEL}


class Trend(NamedTuple):
    """Values (n,) at ``epochs`` (n,), seconds since 1970, with 95 % intervals (n, 2) or None, and the entries' ids."""

    epochs: Array
    values: Array
    intervals: Array | None
    unit: str
    ids: tuple[str, ...]


class _Point(NamedTuple):
    epoch: float
    value: float
    low: float | None
    high: float | None
    unit: str
    id: str


def trends(db: sqlite3.Connection, wire: str) -> dict[str, Trend]:
    """The trends of a wire by quantity: stroke, A_s, A_f, M_s, M_f, error_times_noise (of models), cycles (since the
    first run in the library).

    A quantity in several units has a trend in each: "A_s (degC)". Runs without a time, and copies, are left out.
    """
    points = list(_points(db, wire))
    found: dict[str, Trend] = {}
    for quantity in QUANTITIES:
        own = [point for name, point in points if name == quantity]
        units = list(dict.fromkeys(point.unit for point in own))
        for unit in units:
            name = quantity if len(units) == 1 else f"{quantity} ({unit})"
            found[name] = _trend([point for point in own if point.unit == unit], unit)
    if "cycles" in found:
        found["cycles"] = found["cycles"]._replace(values=np.cumsum(found["cycles"].values))
    return found


def _points(db: sqlite3.Connection, wire: str) -> Iterator[tuple[str, _Point]]:
    query = (
        "SELECT e.kind, e.began, e.id, c.figures FROM entry e JOIN content c ON c.place = e.place "
        "WHERE e.wire = ? AND e.began IS NOT NULL AND e.id = e.identity ORDER BY e.began, e.place"
    )
    for kind, epoch, id, figures in db.execute(query, (wire,)):
        for name, (value, low, high, unit) in json.loads(figures).items():
            if QUANTITIES.get(name) == kind:
                yield name, _Point(epoch, value, low, high, unit, id)


def _trend(points: list[_Point], unit: str) -> Trend:
    intervals = np.array([(p.low, p.high) for p in points], dtype=float)  # None becomes NaN
    return Trend(
        epochs=np.array([p.epoch for p in points]),
        values=np.array([p.value for p in points]),
        intervals=intervals if np.isfinite(intervals).any() else None,
        unit=unit,
        ids=tuple(p.id for p in points),
    )


class Library:
    """Every run, model, diagnosis, study and page of a folder; ``Library.open(folder)``."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._database = Database(self.folder)
        self._notes = NotesFile(self.folder)

    @classmethod
    def open(cls, folder: str | Path, *, rebuild: bool = False) -> "Library":
        """The library of a folder, empty until its first ``refresh``. A damaged one is made again.

        Raises UsageError if there is no such folder, DataError if a newer smarig made the library (``rebuild``
        replaces it), StorageError if the folder cannot be written.
        """
        if not Path(folder).is_dir():
            raise UsageError(f"There is no folder {folder}.")
        library = cls(Path(folder))
        library._database.prepare(replace=rebuild)
        return library

    def refresh(
        self, stop_event: threading.Event | None = None, progress: Progress | None = None
    ) -> ScanResult:
        """Read files that are new or have changed, and remove entries whose files are gone.

        ``progress(done, total)`` is called after each batch. Raises StorageError if the disk is full.
        """
        return self._scan(stop_event, progress, rebuild=False)

    def rebuild(
        self, stop_event: threading.Event | None = None, progress: Progress | None = None
    ) -> ScanResult:
        """Make the library again from its files and notes."""
        return self._scan(stop_event, progress, rebuild=True)

    def search(
        self,
        text: str = "",
        tags: Sequence[str] = (),
        wire: str | None = None,
        rig: str | None = None,
        protocol: str | None = None,
        kind: str | None = None,
        verdict: str | None = None,
        since: float | None = None,
        until: float | None = None,
        order: str = "newest",
        limit: int = 50,
        offset: int = 0,
    ) -> SearchPage:
        """Entries with all these words, tags and values, that began between two times (seconds since 1970)."""
        question = Question(text, tags, wire, rig, protocol, kind, verdict, since, until)
        self._take_over_notes()
        with self._database.reading() as db:
            return search(db, self.folder, question, order, limit, offset)

    def entry(self, id: str) -> Entry:
        """The entry of an id. Raises UsageError if there is none."""
        self._take_over_notes()
        with self._database.reading() as db:
            found = entries(db, self.folder, "WHERE e.id = ?", (id,))
        if not found:
            raise _unknown(id)
        return found[0]

    def loop(self, id: str) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Input and output (k,) of a small drawing of an entry, empty without one; units are in its ``details``."""
        with self._database.reading() as db:
            found = loop_of(db, id)
        if found is None:
            raise _unknown(id)
        return found

    def tag(self, id: str, tags: Sequence[str], who: str = "") -> Entry:
        """Give an entry and its copies these tags instead of those they had."""
        entry, wanted = self.entry(id), checked_tags(tuple(tags))
        had = {tag.casefold(): tag for tag in entry.tags}
        added = tuple(tag for tag in wanted if had.get(tag.casefold()) != tag)
        removed = tuple(had[folded] for folded in had.keys() - {tag.casefold() for tag in wanted})
        if added or removed:
            self._append(
                entry, Annotation(entry.identity, time.time(), _who(who), added, tuple(sorted(removed)))
            )
        return self.entry(id)

    def note(self, id: str, text: str, who: str = "") -> Entry:
        """Add a note to an entry and its copies. Notes are never changed."""
        entry = self.entry(id)
        self._append(entry, Annotation(entry.identity, time.time(), _who(who), note=checked_note(text)))
        return self.entry(id)

    def facets(self) -> dict[str, dict[str, int]]:
        """How many entries there are by kind, wire, rig, protocol, verdict and tag."""
        self._take_over_notes()
        with self._database.reading() as db:
            return facets(db)

    def trends(self, wire: str) -> dict[str, Trend]:
        """How stroke, A_s, A_f, M_s, M_f, error (times noise) and cycles of a wire have changed."""
        with self._database.reading() as db:
            return trends(db, wire)

    def _scan(self, stop: threading.Event | None, progress: Progress | None, *, rebuild: bool) -> ScanResult:
        remedy = "Wait until it has ended."
        lock = process_lock(
            f"library {self.folder}", f"Folder {self.folder} is being scanned", remedy, lasting=False
        )
        with contextlib.ExitStack() as held:
            try:
                held.enter_context(lock)
            except InUse:
                return ScanResult(elsewhere=True)
            if rebuild:
                self._database.start_again()
            scan = Scan(self.folder, self._database, stop or threading.Event(), progress or _silent)
            try:
                found = scan.run()
            except DamagedLibrary:  # since it was opened
                self._database.prepare()
                found = scan.run()
            return self._with_notes(found)

    def _with_notes(self, found: ScanResult) -> ScanResult:
        """The result with a sentence on notes that cannot be read."""
        try:
            with self._database.writing() as db:
                take_over(db, self._notes)
                wrong = wrong_notes(db)
        except SmarigError as error:
            return found.with_problem(str(error))
        sentence = f"{wrong} line(s) of {NOTES_FILE} are neither tags nor a note and are left out."
        return found.with_problem(sentence) if wrong else found

    def _take_over_notes(self) -> None:
        """Read notes that another process, or an editor, has written. Without them, the rest still answers."""
        with contextlib.suppress(SmarigError):
            with self._database.reading() as db:
                known = is_taken_over(db, self._notes)
            if not known:
                with self._database.writing() as db:
                    take_over(db, self._notes)

    def _append(self, entry: Entry, annotation: Annotation) -> None:
        self._notes.append(annotation, entry.place)


def _silent(done: int, total: int) -> None:
    del done, total


def _who(who: str) -> str:
    return one_line(who.strip(), LONGEST_WHO)


def _unknown(id: str) -> UsageError:
    return UsageError(f"The library has no entry {one_line(id, 60)}. Its file may have been removed.")

"""Brings the library to what the files of its folder hold. Only files that changed are read.

Each batch is stored in one transaction, so a scan that is killed has lost at most a batch, which the next one reads.

Reads a file of any kind into what the library keeps. Whatever the file holds, the result is an entry or nothing.
"""

import math
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from smarig.console.library.database import Database
from smarig.console.library.entry_rows import number_copies, remove, store
from smarig.console.library.found_files import FoundFile, LibraryFiles, file_now, found_files
from smarig.console.library.library_entry import (
    DIAGNOSIS,
    MODEL,
    RECORDING,
    RUN,
    UNREADABLE,
    Content,
    one_line,
    path_of,
    shown_place,
)
from smarig.console.library.result_content import (
    diagnosis_content,
    model_content,
    page_content,
    place_identity,
)
from smarig.console.library.run_content import is_recording, run_content
from smarig.core import SmarigError, error_text, printable

_LONGEST_ERROR = 1000
_LONGEST_LINE, _LONGEST_TEXT = 2000, 20_000  # characters
_MOST_VALUES = 1000  # of a table or list
_LINES = ("kind", "name", "wire", "rig", "protocol", "label", "sentence")


def read_content(folder: Path, found: FoundFile) -> Content | None:
    """The content of a file, with an error sentence if it cannot be read; None if it is no entry."""
    file = path_of(folder, found.place)
    try:
        with np.errstate(all="ignore"):
            content = _content(folder, file, found)
            return None if content is None else _storable(content)
    except SmarigError as error:
        sentence = str(error)
    except Exception as error:  # a file can be anything; the others must be listed all the same
        sentence = f"{shown_place(found.place)} cannot be read: {error_text(error)}."
    return Content(
        identity=place_identity(found.place),
        kind=found.kind,
        name=shown_place(os.path.basename(found.place)),  # noqa: PTH119 - bytes
        began=found.modified_ns / 1e9,
        verdict=UNREADABLE,
        error=one_line(sentence.replace(f"{folder}{os.sep}", ""), _LONGEST_ERROR),
    )


def _content(folder: Path, file: Path, found: FoundFile) -> Content | None:
    if found.kind == RUN:
        return run_content(file)
    if found.kind == MODEL:
        return model_content(file, folder)
    if found.kind == DIAGNOSIS:
        return diagnosis_content(file, found.place)
    return page_content(file, found.place)


def _storable(content: Content) -> Content:
    """The content with texts of one printable line, and numbers that JSON has."""
    lines: dict[str, Any] = {name: one_line(getattr(content, name), _LONGEST_LINE) for name in _LINES}
    finite = {name: each for name, each in content.figures.items() if math.isfinite(each[0])}
    return replace(content, **lines, details=_plain(content.details), figures=finite)


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return printable(value, _LONGEST_TEXT)
    if isinstance(value, dict):
        return {one_line(str(k), _LONGEST_LINE): _plain(v) for k, v in islice(value.items(), _MOST_VALUES)}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value[:_MOST_VALUES]]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int) else printable(str(value), _LONGEST_TEXT)


Progress = Callable[[int, int], object]  # files read, files to read
_BATCH_S = 0.5
_BATCH_FILES = 200
_FRESH_NS = 2_000_000_000  # a file that was written so recently may change again without another time


@dataclass(frozen=True)
class ScanResult:
    """What a scan did: files read, entries removed, files unchanged, and sentences on folders it could not read.

    ``stopped``: it was asked to end before its end. ``elsewhere``: another process scans; nothing was done.
    """

    read: int = 0
    removed: int = 0
    unchanged: int = 0
    problems: tuple[str, ...] = ()
    stopped: bool = False
    elsewhere: bool = False

    def with_problem(self, sentence: str) -> "ScanResult":
        """The result with one more sentence."""
        return replace(self, problems=(*self.problems, sentence))


@dataclass(frozen=True)
class Scan:
    """One scan of a folder, until ``stop`` is set."""

    folder: Path
    database: Database
    stop: threading.Event
    progress: Progress

    def run(self) -> ScanResult:
        """Read what is new or has changed, and remove what is gone."""
        found = found_files(self.folder)
        known = self._known()
        removed = [place for place in known if place not in found.files]
        self._remove(removed)
        changed = [file for file in found.files.values() if not self._is_known(file, known)]
        changed.sort(key=lambda file: -file.newest_ns)  # what a person looks for first
        read = 0
        for batch in self._batches(changed):
            self._store(batch)
            read += len(batch)
            self.progress(read, len(changed))
        return self._result(found, read, len(removed), len(changed))

    def _result(self, found: LibraryFiles, read: int, removed: int, changed: int) -> ScanResult:
        return ScanResult(
            read=read,
            removed=removed,
            unchanged=len(found.files) - changed,
            problems=found.problems,
            stopped=read < changed,
        )

    def _known(self) -> dict[bytes, tuple[str, bool]]:
        """State of each file when it was read, and whether it was being recorded."""
        with self.database.reading() as db:
            rows = db.execute("SELECT place, state, recording FROM seen").fetchall()
        return {place: (state, bool(recording)) for place, state, recording in rows}

    def _is_known(self, file: FoundFile, known: dict[bytes, tuple[str, bool]]) -> bool:
        """Whether a file is as it was. A recorder that was killed changes nothing in its file."""
        state, recording = known.get(file.place, ("", False))
        if state != file.state:
            return False
        return not recording or is_recording(path_of(self.folder, file.place))

    def _batches(self, files: list[FoundFile]) -> Iterator[list[tuple[FoundFile, str, Content | None]]]:
        """Files with their states and contents, read outside of any transaction."""
        batch: list[tuple[FoundFile, str, Content | None]] = []
        batch_start_s = time.monotonic()
        for file in files:
            if self.stop.is_set():
                break
            batch.append((file, *self._read(file)))
            if len(batch) >= _BATCH_FILES or time.monotonic() - batch_start_s > _BATCH_S:
                yield batch
                batch, batch_start_s = [], time.monotonic()
        if batch:
            yield batch

    def _read(self, file: FoundFile) -> tuple[str, Content | None]:
        """The state that was read, "" if the file may change without being noticed, and its content."""
        began_ns = time.time_ns()
        content = read_content(self.folder, file)
        now = file_now(self.folder, file.place, file.kind)
        same = now is not None and now.state == file.state
        fresh = abs(began_ns - file.newest_ns) < _FRESH_NS
        return (file.state if same and not fresh else ""), content

    def _store(self, batch: list[tuple[FoundFile, str, Content | None]]) -> None:
        touched: set[str] = set()
        with self.database.writing() as db:
            for file, state, content in batch:
                touched.add(remove(db, file.place))
                # a run without an entry is being recorded, and has no sample yet
                recording = file.kind == RUN if content is None else content.verdict == RECORDING
                db.execute("INSERT OR REPLACE INTO seen VALUES (?, ?, ?)", (file.place, state, recording))
                if content is not None:
                    store(db, file, content)
                    touched.add(content.identity)
            number_copies(db, touched)

    def _remove(self, places: list[bytes]) -> None:
        if not places:
            return
        with self.database.writing() as db:
            touched = {remove(db, place) for place in places}
            db.executemany("DELETE FROM seen WHERE place = ?", [(place,) for place in places])
            number_copies(db, touched)

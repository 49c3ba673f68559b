"""Entries as rows of the library's tables, and back."""

import json
import sqlite3
from array import array
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.console.library.found_files import FoundFile
from smarig.console.library.library_entry import Content, Entry, LibraryFigure, path_of, shown_place
from smarig.console.library.notes_file import notes_of, tags_of

COLUMNS = (
    *("place", "id", "identity", "kind", "name", "began", "duration_s", "wire", "rig", "protocol", "label"),
    *("verdict", "sentence", "error", "size_bytes", "modified"),
)
_MOST_WORDS = 20_000  # characters of a file that are searched
_INSERT = f"INSERT INTO entry ({','.join(COLUMNS)}, words) VALUES ({','.join('?' * (len(COLUMNS) + 1))})"


def store(db: sqlite3.Connection, found: FoundFile, content: Content) -> None:
    """Add the rows of an entry, without its id."""
    row = (
        *(found.place, None, content.identity, content.kind, content.name, content.began, content.duration_s),
        *(content.wire, content.rig, content.protocol, content.label),
        *(content.verdict, content.sentence, content.error, found.size, found.modified_ns / 1e9),
        _words(found, content),
    )
    db.execute(_INSERT, row)
    details = json.dumps(content.details, allow_nan=False)
    figures = json.dumps(content.figures, allow_nan=False)
    loop = array("f", (*content.u, *content.y)).tobytes()
    db.execute("INSERT INTO content VALUES (?, ?, ?, ?)", (found.place, details, figures, loop))


def remove(db: sqlite3.Connection, place: bytes) -> str:
    """Remove the rows of an entry; returns its identity, "" if there was none."""
    found = db.execute("SELECT identity FROM entry WHERE place = ?", (place,)).fetchone()
    db.execute("DELETE FROM entry WHERE place = ?", (place,))
    db.execute("DELETE FROM content WHERE place = ?", (place,))
    return found[0] if found else ""


def number_copies(db: sqlite3.Connection, identities: Iterable[str]) -> None:
    """Give the entries of these identities their ids: that of the first place is the identity, copies are numbered."""
    for identity in filter(None, identities):
        query = "SELECT place, id FROM entry WHERE identity = ? ORDER BY place"
        changed = [
            (new, place)
            for number, (place, old) in enumerate(db.execute(query, (identity,)).fetchall(), start=1)
            if (new := identity if number == 1 else f"{identity}-{number}") != old
        ]
        db.executemany("UPDATE entry SET id = ? WHERE place = ?", changed)


def entries(db: sqlite3.Connection, folder: Path, where: str, values: Iterable[object]) -> list[Entry]:
    """The entries that a condition (with order and limit) selects."""
    columns = ", ".join(f"e.{name}" for name in COLUMNS)
    query = f"SELECT {columns}, c.details, c.figures FROM entry e JOIN content c ON c.place = e.place {where}"
    return [_entry(db, folder, row) for row in db.execute(query, tuple(values)).fetchall()]


def loop_of(db: sqlite3.Connection, id: str) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
    """Input and output (k,) of the small drawing of an entry; None for an unknown id."""
    query = "SELECT c.loop FROM entry e JOIN content c ON c.place = e.place WHERE e.id = ?"
    found = db.execute(query, (id,)).fetchone()
    if found is None:
        return None
    points = np.frombuffer(found[0], dtype=np.float32)
    return points[: points.size // 2], points[points.size // 2 :]


def _entry(db: sqlite3.Connection, folder: Path, row: tuple) -> Entry:
    place, *rest = row[: len(COLUMNS)]
    named = dict(zip(COLUMNS[1:], rest))
    details, figures = (json.loads(text) for text in row[len(COLUMNS) :])
    return Entry(
        **named,
        place=shown_place(place),
        path=path_of(folder, place),
        details=details,
        figures={name: _figure(*values) for name, values in figures.items()},
        tags=tags_of(db, named["identity"]),
        notes=notes_of(db, named["identity"]),
    )


def _figure(value: float, low: float | None, high: float | None, unit: str) -> LibraryFigure:
    return LibraryFigure(value, None if low is None or high is None else (low, high), unit)


def _words(found: FoundFile, content: Content) -> str:
    """What is searched: everything that a person might remember of the file."""
    settings = content.details.get("settings") or {}
    parts = (
        *(content.name, shown_place(found.place), content.kind, content.protocol, content.rig, content.wire),
        *(content.label, content.sentence, content.error, content.details.get("notes", "")),
        *(content.details.get("cause", ""), content.details.get("source", "")),
        *(f"{key}={value}" for key, value in settings.items()),
        *(str(effect) for effect in content.details.get("effects", ())),
    )
    return " ".join(map(str, parts)).casefold()[:_MOST_WORDS]

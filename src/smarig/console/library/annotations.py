"""Tags and notes in the library's tables, as its file of notes holds them."""

import json
import sqlite3
from dataclasses import asdict

from smarig.console.library.library_entry import Note
from smarig.console.library.notes_file import Annotation, NotesFile, Reading, folded_tags

_KEY = "notes"


def take_over(db: sqlite3.Connection, file: NotesFile) -> None:
    """Bring the tables to what the file of notes holds now. Raises StorageError if it cannot be read."""
    found = file.read(_reading(db))
    if found.all:
        db.execute("DELETE FROM tag")
        db.execute("DELETE FROM note")
        db.execute("DELETE FROM meta WHERE key = 'wrong_notes'")
    _store(db, found.annotations)
    if found.wrong:
        db.execute(
            "INSERT INTO meta VALUES ('wrong_notes', ?) ON CONFLICT DO UPDATE SET value = value + excluded.value",
            (found.wrong,),
        )
    place = json.dumps({**asdict(found.reading), "tail": found.reading.tail.hex()})
    db.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (_KEY, place))


def is_taken_over(db: sqlite3.Connection, file: NotesFile) -> bool:
    """Whether the tables hold all that the file of notes holds."""
    known = _reading(db)
    return (known.inode, known.size) == file.state()


def wrong_notes(db: sqlite3.Connection) -> int:
    """The number of lines of the file that are neither tags nor a note."""
    found = db.execute("SELECT value FROM meta WHERE key = 'wrong_notes'").fetchone()
    return int(found[0]) if found else 0


def tags_of(db: sqlite3.Connection, identity: str) -> tuple[str, ...]:
    """The tags of an identity, in alphabetical order."""
    query = "SELECT tag FROM tag WHERE identity = ? ORDER BY folded"
    return tuple(tag for (tag,) in db.execute(query, (identity,)))


def notes_of(db: sqlite3.Connection, identity: str) -> tuple[Note, ...]:
    """The notes of an identity, in the order of writing."""
    query = "SELECT text, who, epoch FROM note WHERE identity = ? ORDER BY rowid"
    return tuple(Note(*row) for row in db.execute(query, (identity,)))


def _store(db: sqlite3.Connection, annotations: tuple[Annotation, ...]) -> None:
    for identity, folded, tag in folded_tags(annotations):
        if tag is None:
            db.execute("DELETE FROM tag WHERE identity = ? AND folded = ?", (identity, folded))
        else:
            db.execute("INSERT OR REPLACE INTO tag VALUES (?, ?, ?)", (identity, folded, tag))
    db.executemany(
        "INSERT INTO note VALUES (?, ?, ?, ?, ?)",
        [(a.identity, a.epoch, a.who, a.note, f"{a.who} {a.note}".casefold()) for a in annotations if a.note],
    )


def _reading(db: sqlite3.Connection) -> Reading:
    found = db.execute("SELECT value FROM meta WHERE key = ?", (_KEY,)).fetchone()
    if found is None:
        return Reading()
    stored = json.loads(found[0])
    return Reading(**stored | {"tail": bytes.fromhex(stored["tail"])})

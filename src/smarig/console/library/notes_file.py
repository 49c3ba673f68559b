"""The file ``library.notes.jsonl``: tags and notes of people, one line each, which nothing else in the folder holds.

Lines are only ever appended. A last line that was cut off, by a full disk or a power cut, is left out, and the next
one begins on a line of its own.

Tags and notes in the library's tables, as its file of notes holds them.
"""

import json
import os
import re
import sqlite3
import stat
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.console.library.library_entry import Note, one_line
from smarig.core import StorageError, UsageError, printable

NOTES_FILE = "library.notes.jsonl"
MOST_BYTES = 200_000_000
LONGEST_TAG, LONGEST_WHO, LONGEST_NOTE = 60, 100, 10_000
MOST_TAGS = 50  # of a run
_IDENTITY = re.compile("[0-9a-f]{8,64}")
_TAIL = 200  # bytes before the place up to which the file was read: it is the same file if they are the same


@dataclass(frozen=True)
class Annotation:
    """One line: tags that were added and removed, or a note, on what has this identity."""

    identity: str
    epoch: float
    who: str
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    note: str = ""

    def line(self, name: str) -> bytes:
        """The line of the file; ``name`` is for people who read it."""
        about = {"epoch": self.epoch, "who": self.who, "run": self.identity, "name": name}
        changed = {"note": self.note} if self.note else {"add": self.added, "remove": self.removed}
        return json.dumps(about | changed, ensure_ascii=False).encode() + b"\n"


@dataclass(frozen=True)
class Reading:
    """How far the notes were read: inode and size of the file then, the position, and the bytes before it."""

    inode: int = 0
    size: int = 0
    position: int = 0
    tail: bytes = b""


@dataclass(frozen=True)
class ReadNotes:
    """The annotations after a position; from the beginning, ``all``, if the file is another than before.

    ``wrong`` is the number of lines that are none.
    """

    annotations: tuple[Annotation, ...]
    all: bool
    wrong: int
    reading: Reading


class NotesFile:
    """The notes of a folder."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / NOTES_FILE

    def state(self) -> tuple[int, int]:
        """Inode and size; zeros without a file."""
        try:
            about = self.file.stat()
        except OSError:
            return 0, 0
        return about.st_ino, about.st_size

    def append(self, annotation: Annotation, name: str) -> None:
        """Add a line; it is on the disk when this returns. Raises StorageError if the disk refuses."""
        try:
            number = self._open(os.O_RDWR | os.O_APPEND | os.O_CREAT)
        except OSError as error:
            raise StorageError(f"{self.file} cannot be written: {error.strerror or error}.") from None
        try:
            line = annotation.line(name)
            if not _ends_whole(number):
                line = b"\n" + line
            written = os.write(number, line)  # one call: lines of two processes do not mix
            if written < len(line):
                raise OSError(0, "the disk is full")
            os.fsync(number)
        except OSError as error:
            raise StorageError(f"{self.file} cannot be written: {error.strerror or error}.") from None
        finally:
            os.close(number)

    def read(self, since: Reading) -> ReadNotes:
        """The annotations after ``since``. Raises StorageError if there is a file that cannot be read."""
        try:
            number = self._open(os.O_RDONLY)
        except FileNotFoundError:
            return ReadNotes((), since.position > 0, 0, Reading())
        except OSError as error:
            raise StorageError(f"{self.file} cannot be read: {error.strerror or error}.") from None
        with os.fdopen(number, "rb") as file:
            about = os.fstat(number)
            inode = about.st_ino
            file.seek(since.position - len(since.tail))
            same = inode == since.inode and file.read(len(since.tail)) == since.tail
            begin = since.position if same else 0
            file.seek(begin)
            content = file.read(min(about.st_size, MOST_BYTES))  # else a buffer of the most is made
        lines, used = _whole_lines(content)
        found = [_annotation(line) for line in lines if line.strip()]
        known = tuple(each for each in found if each is not None)
        before = (since.tail if same else b"") + content[:used]
        reading = Reading(inode, begin + len(content), begin + used, before[-_TAIL:])
        return ReadNotes(known, not same, len(found) - len(known), reading)

    def _open(self, flags: int) -> int:
        """The file as a number. Links are not followed, and pipes are not waited for."""
        safe = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        number = os.open(self.file, flags | safe, 0o666)
        if not stat.S_ISREG(os.fstat(number).st_mode):
            os.close(number)
            raise OSError(0, "it is not a regular file")
        return number


def checked_tags(tags: tuple[str, ...]) -> tuple[str, ...]:
    """The tags without spaces around them and without repetitions. Raises UsageError for one that is none."""
    found: dict[str, str] = {}
    for tag in tags:
        text = " ".join(tag.split())
        if not text or len(text) > LONGEST_TAG or not text.isprintable() or "," in text:
            raise UsageError(
                f"{one_line(tag, LONGEST_TAG)!r} is no tag: a tag has 1 to {LONGEST_TAG} printable characters and no "
                "comma."
            )
        found.setdefault(text.casefold(), text)
    if len(found) > MOST_TAGS:
        raise UsageError(f"A run can have at most {MOST_TAGS} tags.")
    return tuple(found.values())


def checked_note(text: str) -> str:
    """The text of a note. Raises UsageError if it is empty or too long."""
    found = text.strip()
    if not found or len(found) > LONGEST_NOTE:
        raise UsageError(f"A note has 1 to {LONGEST_NOTE} characters.")
    return printable(found, LONGEST_NOTE)


def _ends_whole(number: int) -> bool:
    """Whether the file is empty or ends with a line break."""
    size = os.fstat(number).st_size
    if not size:
        return True
    os.lseek(number, size - 1, os.SEEK_SET)
    return os.read(number, 1) == b"\n"


def _whole_lines(content: bytes) -> tuple[list[bytes], int]:
    """The lines, and how many bytes they take. A last line without an end counts if it is whole all the same."""
    used = content.rfind(b"\n") + 1
    lines = content[:used].split(b"\n")
    if _annotation(content[used:]) is not None:
        return [*lines, content[used:]], len(content)
    return lines, used


def _annotation(line: bytes) -> Annotation | None:
    try:
        about = json.loads(line)
        if not isinstance(about, dict):
            return None
        identity, epoch, who = about["run"], float(about["epoch"]), str(about.get("who", ""))
        added, removed = (checked_tags(_texts(about.get(key, ()))) for key in ("add", "remove"))
        note = about.get("note", "")
        if not _IDENTITY.fullmatch(identity) or not isinstance(note, str) or not abs(epoch) < 1e12:
            return None
        return Annotation(
            identity,
            epoch,
            one_line(who, LONGEST_WHO),
            added,
            removed,
            checked_note(note) if note else "",
        )
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError, UsageError):
        return None


def _texts(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or not all(isinstance(text, str) for text in value):
        raise TypeError
    return tuple(value)


def folded_tags(annotations: tuple[Annotation, ...]) -> Iterator[tuple[str, str, str | None]]:
    """Changes in order: identity, tag in lower case, and the tag, None if it was removed."""
    for each in annotations:
        yield from ((each.identity, tag.casefold(), tag) for tag in each.added)
        yield from ((each.identity, tag.casefold(), None) for tag in each.removed)


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

"""The file of a queue: one SQLite database that the console and the worker read and change at the same time.

Every change is one transaction that is on the disk when it returns (WAL, synchronous=FULL), so a power cut loses none.
"""

import contextlib
import json
import sqlite3
import threading
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Self

from smarig.console.queue.queue_entry import COLUMNS, EntryState, QueueEntry
from smarig.core import DataError, InUse, StorageError, UsageError, check_regular
from smarig.record import check_sidecars, restrict

NAME = "queue.sqlite"
VERSION = 1
_APPLICATION_ID = 0x736D7171  # "smqq": which program the file belongs to, in its header
_BUSY_S = 10.0  # another process writes for milliseconds
_STATES = ",".join(f"'{state}'" for state in EntryState)
_CREATE = f"""
CREATE TABLE queue (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE entry (
    id INTEGER PRIMARY KEY AUTOINCREMENT, request TEXT NOT NULL, state TEXT NOT NULL CHECK (state IN ({_STATES})),
    place INTEGER NOT NULL, added REAL NOT NULL, started REAL, ended REAL, exit_status INTEGER,
    sentence TEXT NOT NULL DEFAULT '', duration_s REAL NOT NULL, expected_s REAL NOT NULL,
    continued INTEGER NOT NULL DEFAULT 0, pid INTEGER);
CREATE INDEX entry_in_state ON entry (state, place);
PRAGMA application_id = {_APPLICATION_ID};
PRAGMA user_version = {VERSION};
"""
_SELECT = f"SELECT {','.join(COLUMNS)} FROM entry"
_SCHEMA = "SELECT type, name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite_%' ORDER BY type, name"
_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_SCHEMA, sqlite3.SQLITE_ERROR)
_BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)


@cache
def _own_schema() -> list[tuple[Any, ...]]:
    """The tables and indices of a queue; a file with others, or with computed columns, triggers or views, is none."""
    with contextlib.closing(sqlite3.connect(":memory:")) as db:
        db.executescript(_CREATE)
        return db.execute(_SCHEMA).fetchall()


class QueueFile:
    """Entries and keys of a queue. It may be used by several threads."""

    def __init__(self, folder: Path) -> None:
        """Open or create it. Raises DataError if it is damaged, UsageError for a later version, StorageError."""
        self.path = folder / NAME
        self._lock = threading.RLock()
        check_regular(self.path)
        if self.path.is_symlink():
            raise DataError(f"{self.path} is a link to another file. Remove it, or copy the queue itself.")
        check_sidecars(self.path)  # SQLite deletes the file that a journal of several databases names
        with self._explained():
            self._db = sqlite3.connect(
                self.path, timeout=_BUSY_S, isolation_level=None, check_same_thread=False
            )
            try:
                self._prepare()
            except BaseException:
                self._db.close()
                raise

    def close(self) -> None:
        """Close it. What was changed is stored already."""
        with self._lock:
            self._db.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    @contextlib.contextmanager
    def transaction(self, *, reading: bool = False) -> Iterator[None]:
        """All changes of the block, or none. Those of several processes follow each other.

        ``reading``: the block only reads, all of it from one moment, and waits for nobody.
        """
        with self._lock, self._explained():
            self._db.execute("BEGIN" if reading else "BEGIN IMMEDIATE")
            try:
                yield
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:  # a full disk has rolled back already
                    self._db.execute("ROLLBACK")
                raise

    def entries(self, *states: EntryState, newest: int | None = None) -> list[QueueEntry]:
        """The entries in these states: those that wait in their order, others in the order of their end.

        ``newest``: at most that many, those that ended last.
        """
        marks = ",".join("?" * len(states))
        order = "ORDER BY ended DESC, place DESC LIMIT ?"
        rows = self._rows(
            f"{_SELECT} WHERE state IN ({marks}) {order}", *states, -1 if newest is None else newest
        )
        return [QueueEntry.from_row(row) for row in reversed(rows)]

    def entry(self, number: int) -> QueueEntry:
        """One entry. Raises UsageError if there is none with this number."""
        rows = self._rows(f"{_SELECT} WHERE id = ?", number)
        if not rows:
            raise UsageError(f"The queue has no entry {number}.")
        return QueueEntry.from_row(rows[0])

    def insert(self, **columns: Any) -> int:
        """Add an entry; returns its number."""
        names, marks = ",".join(columns), ",".join("?" * len(columns))
        with self._lock, self._explained():
            done = self._db.execute(f"INSERT INTO entry ({names}) VALUES ({marks})", tuple(columns.values()))
            return done.lastrowid or 0

    def update(self, number: int, **columns: Any) -> None:
        """Change an entry."""
        names = ",".join(f"{name} = ?" for name in columns)
        self._rows(f"UPDATE entry SET {names} WHERE id = ?", *columns.values(), number)

    def place(self, aggregate: str) -> int:
        """The ``min`` or ``max`` of the places of those that wait; 0 if none does."""
        query = f"SELECT {aggregate}(place) FROM entry WHERE state = 'waiting'"
        return int(self._rows(query)[0][0] or 0)

    def get(self, key: str) -> Any:
        """A value of the queue itself; None if it is not set."""
        rows = self._rows("SELECT value FROM queue WHERE key = ?", key)
        try:
            return json.loads(rows[0][0]) if rows else None
        except ValueError:
            raise DataError(_damaged(self.path, f"its value '{key}' cannot be read")) from None

    def set(self, **values: Any) -> None:
        """Set values of the queue itself; None removes one."""
        for key, value in values.items():
            if value is None:
                self._rows("DELETE FROM queue WHERE key = ?", key)
            else:
                self._rows("INSERT OR REPLACE INTO queue VALUES (?, ?)", key, json.dumps(value))

    def _rows(self, query: str, *values: Any) -> list[tuple[Any, ...]]:
        with self._lock, self._explained():
            return self._db.execute(query, values).fetchall()

    def _prepare(self) -> None:
        restrict(self._db)
        self._db.execute("PRAGMA synchronous = FULL")
        if self._is_empty():
            self._db.execute("PRAGMA journal_mode = WAL")
            with self.transaction():
                if self._is_empty():  # another process may have created the tables meanwhile
                    for statement in filter(str.strip, _CREATE.split(";")):
                        self._db.execute(statement)
        if self._pragma("application_id") != _APPLICATION_ID:
            raise DataError(f"{self.path} is an SQLite database, but no queue of smarig. Move it elsewhere.")
        if (version := self._pragma("user_version")) > VERSION:
            raise UsageError(
                f"{self.path} has version {version}, and this smarig knows versions up to {VERSION}. Update smarig."
            )
        if self._db.execute(_SCHEMA).fetchall() != _own_schema():
            raise DataError(_damaged(self.path, "its tables are not those of a queue of smarig"))
        if (fault := self._pragma("quick_check")) != "ok":
            raise DataError(_damaged(self.path, str(fault)))

    def _is_empty(self) -> bool:
        return self._db.execute("SELECT count(*) FROM sqlite_schema").fetchone() == (0,)

    def _pragma(self, name: str) -> Any:
        return self._db.execute(f"PRAGMA {name}").fetchone()[0]

    @contextlib.contextmanager
    def _explained(self) -> Iterator[None]:
        """Errors of SQLite as sentences."""
        try:
            yield
        except sqlite3.Error as error:
            code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF  # without what extends it
            if code in _DAMAGED:
                raise DataError(_damaged(self.path, str(error))) from None
            if code in _BUSY:
                raise InUse(f"{self.path} is being changed by another process. Try again.") from None
            raise StorageError(f"{self.path} cannot be read or written: {error}.") from None


def _damaged(path: Path, why: str) -> str:
    return (
        f"{path} is damaged ({why}). Move it elsewhere to begin a new queue; the run files are not affected."
    )

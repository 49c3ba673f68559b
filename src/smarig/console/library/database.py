"""The file ``library.sqlite``: its tables, how it is opened, and what happens if it is damaged, foreign or newer.

Several processes may use it at once (write-ahead log); each use has a connection of its own, so a file that was
deleted or made again meanwhile is noticed at the next use.
"""

import contextlib
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path

from smarig.core import DataError, InUse, StorageError, UsageError, printable
from smarig.record import check_sidecars

LIBRARY_FILE = "library.sqlite"
DAMAGED_FILE = "library.damaged.sqlite"
VERSION = 1  # one more whenever the tables, or what is kept of the same file, are others
_APPLICATION = 0x736D6C62
_BUSY_S = 10.0
_SIDECARS = ("-wal", "-shm", "-journal")
TABLES = (
    "CREATE TABLE seen (place BLOB PRIMARY KEY, state TEXT NOT NULL, recording INTEGER NOT NULL) WITHOUT ROWID",
    "CREATE TABLE entry (place BLOB PRIMARY KEY, id TEXT, identity TEXT NOT NULL, kind TEXT NOT NULL, "
    "name TEXT NOT NULL, began REAL, duration_s REAL, wire TEXT NOT NULL, rig TEXT NOT NULL, "
    "protocol TEXT NOT NULL, label TEXT NOT NULL, verdict TEXT NOT NULL, sentence TEXT NOT NULL, "
    "error TEXT NOT NULL, size_bytes INTEGER NOT NULL, modified REAL NOT NULL, words TEXT NOT NULL)",
    "CREATE INDEX entry_identity ON entry (identity, place)",
    "CREATE INDEX entry_id ON entry (id)",
    "CREATE TABLE content (place BLOB PRIMARY KEY, details TEXT NOT NULL, figures TEXT NOT NULL, loop BLOB NOT NULL)",
    "CREATE TABLE tag (identity TEXT, folded TEXT, tag TEXT NOT NULL, PRIMARY KEY (identity, folded)) WITHOUT ROWID",
    "CREATE TABLE note (identity TEXT NOT NULL, epoch REAL NOT NULL, who TEXT NOT NULL, text TEXT NOT NULL, "
    "words TEXT NOT NULL)",
    "CREATE INDEX note_identity ON note (identity)",
    "CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB) WITHOUT ROWID",
)
_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
_FULL = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR)
_BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)


class DamagedLibrary(DataError):
    """The library's file is damaged; ``prepare`` makes it again."""


class Database:
    """The library's file in a folder."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / LIBRARY_FILE

    def prepare(self, *, replace: bool = False) -> None:
        """Make the file if it is missing; replace a damaged or older one, and with ``replace`` also a newer one.

        A damaged file is kept under another name. Raises UsageError for a file of another program, DataError for one of
        a newer smarig, and StorageError if the folder refuses.
        """
        if self.file.is_symlink() or (self.file.exists() and not self.file.is_file()):
            raise UsageError(f"{self.file} is not a regular file. Remove it; the library makes its own.")
        with self._errors():
            if not self._usable(replace):
                with contextlib.closing(self._connect("rwc")) as db:
                    _make_tables(db)

    @contextlib.contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """A connection for queries, which all see the same moment."""
        with self._errors(), contextlib.closing(self._opened()) as db:
            db.execute("PRAGMA query_only = ON")
            db.execute("BEGIN")
            yield db

    @contextlib.contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """A connection whose changes are stored together at the end of the block, or not at all."""
        with self._errors(), contextlib.closing(self._opened()) as db:
            db.execute("BEGIN IMMEDIATE")
            yield db
            db.execute("COMMIT")

    def start_again(self) -> None:
        """Forget all entries. Other processes may go on reading: they find none until the files are read again."""
        self.prepare(replace=True)
        with self.writing() as db:
            for (table,) in db.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall():
                db.execute(f"DELETE FROM {table}")

    def _opened(self) -> sqlite3.Connection:
        if not self.file.is_file():
            self.prepare()
        return self._connect("rw")

    def _connect(self, mode: str) -> sqlite3.Connection:
        check_sidecars(self.file)
        uri = f"{self.file.resolve().as_uri()}?mode={mode}"
        db = sqlite3.connect(uri, uri=True, timeout=_BUSY_S, isolation_level=None)
        db.execute("PRAGMA trusted_schema = OFF")
        # after a power cut, the last batch is read again from the files
        db.execute("PRAGMA synchronous = NORMAL")
        return db

    def _usable(self, replace: bool) -> bool:
        """Whether the file is a library with these tables. A damaged one is out of the way afterwards."""
        if not self.file.exists():
            return False
        try:
            found = self._found()
        except sqlite3.DatabaseError as error:
            if _code(error) not in _DAMAGED:
                raise
            self._set_aside()
            return False
        application, version, tables = found
        if not tables:
            return False
        if application != _APPLICATION:
            raise UsageError(
                f"{self.file} is a database of another program. Move it; the library needs this name."
            )
        if version > VERSION and not replace:
            raise DataError(
                f"{self.file} was made by a newer smarig (layout {version}; this one reads {VERSION}). Use that "
                "smarig, or rebuild the library from its files, which loses no tags or notes."
            )
        return version == VERSION and tables == TABLES

    def _found(self) -> tuple[int, int, tuple[str, ...]]:
        """Application, version and tables. Raises sqlite3.DatabaseError if the file is damaged."""
        with contextlib.closing(self._connect("rw")) as db:
            if db.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
                raise _damaged("its pages contradict each other")
            (application,), (version,) = (
                db.execute(f"PRAGMA {name}").fetchone() for name in ("application_id", "user_version")
            )
            return application, version, _tables(db)

    def _set_aside(self) -> None:
        self.file.replace(self.file.with_name(DAMAGED_FILE))
        for suffix in _SIDECARS:
            self.file.with_name(self.file.name + suffix).unlink(missing_ok=True)

    @contextlib.contextmanager
    def _errors(self) -> Iterator[None]:
        """Every failure of the database as one sentence."""
        try:
            yield
        except sqlite3.Error as error:
            raise self._sentence(error) from None
        except OSError as error:
            raise StorageError(f"{self.file} cannot be used: {error.strerror or error}.") from None

    def _sentence(self, error: sqlite3.Error) -> Exception:
        code, text = _code(error), printable(str(error), 200)
        if code in _BUSY:
            return InUse(f"{self.file} is being written by another process. Try again.")
        if code in _FULL or code == sqlite3.SQLITE_READONLY or code == sqlite3.SQLITE_CANTOPEN:
            return StorageError(f"{self.file} cannot be written: {text}.")
        return DamagedLibrary(
            f"{self.file} is damaged: {text}. Rebuild the library: no tags or notes are lost."
        )


def _make_tables(db: sqlite3.Connection) -> None:
    """Make the tables, instead of others, unless another process did so meanwhile."""
    end = time.monotonic() + _BUSY_S
    while True:
        try:  # SQLite does not wait for a lock when the mode is changed
            db.execute("PRAGMA journal_mode = WAL")
            break
        except sqlite3.OperationalError as error:
            if _code(error) not in _BUSY or time.monotonic() > end:
                raise
            time.sleep(0.01)
    db.execute("BEGIN IMMEDIATE")
    if (_tables(db), db.execute("PRAGMA user_version").fetchone()) != (TABLES, (VERSION,)):
        _drop_all(db)
        for statement in TABLES:
            db.execute(statement)
        db.execute(f"PRAGMA application_id = {_APPLICATION}")
        db.execute(f"PRAGMA user_version = {VERSION}")
    db.execute("COMMIT")


def _tables(db: sqlite3.Connection) -> tuple[str, ...]:
    rows = db.execute("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY rowid").fetchall()
    return tuple(sql for (sql,) in rows)


def _drop_all(db: sqlite3.Connection) -> None:
    """Remove the tables of another version. The file stays: others may have it open."""
    rows = db.execute("SELECT type, name FROM sqlite_master WHERE type IN ('view', 'table')").fetchall()
    for kind, name in rows:
        quoted = name.replace('"', '""')
        db.execute(f'DROP {kind} IF EXISTS "{quoted}"')


def _code(error: sqlite3.Error) -> int:
    """The primary result code; 0 if Python raised the error itself."""
    return (getattr(error, "sqlite_errorcode", None) or 0) & 0xFF


def _damaged(text: str) -> sqlite3.DatabaseError:
    error = sqlite3.DatabaseError(text)
    error.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
    return error

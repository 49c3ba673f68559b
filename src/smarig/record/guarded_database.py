"""Connections to run files of unknown origin: what a file can make SQLite do is bounded, and Ctrl-C always works.

A query has a number of instructions that grows with the size of the file. Without it, a damaged or hostile file could
keep SQLite busy for ever, and no signal would be handled meanwhile.
"""

import contextlib
import os
import sqlite3
import stat
from collections.abc import Iterator
from pathlib import Path

from smarig.core import DataError

SIDECARS = ("-wal", "-shm", "-journal")
LARGEST_CELL_BYTES = 64_000_000  # a reference of a million points, the largest that is recorded, takes 40 MB
_LIMITS = {
    sqlite3.SQLITE_LIMIT_LENGTH: LARGEST_CELL_BYTES,
    sqlite3.SQLITE_LIMIT_SQL_LENGTH: 100_000,
    sqlite3.SQLITE_LIMIT_COLUMN: 100,
    sqlite3.SQLITE_LIMIT_EXPR_DEPTH: 100,
    sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH: 1,
    sqlite3.SQLITE_LIMIT_ATTACHED: 0,
    sqlite3.SQLITE_LIMIT_WORKER_THREADS: 0,
}
_PRAGMAS = ("trusted_schema = OFF", "cell_size_check = ON", "mmap_size = 0")
_INTERVAL = 20_000  # instructions between two calls of the handler: some milliseconds
_INSTRUCTIONS, _PER_BYTE = 5_000_000, 5  # of all queries; samples take a third of one per byte
_JOURNAL_MAGIC = b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"


def restrict(db: sqlite3.Connection) -> None:
    """Limit sizes, and trust nothing that the schema of the file would execute."""
    for limit, value in _LIMITS.items():
        db.setlimit(limit, value)
    for pragma in _PRAGMAS:
        db.execute(f"PRAGMA {pragma}")


@contextlib.contextmanager
def bounded(db: sqlite3.Connection, file: Path) -> Iterator[None]:
    """Bound what the queries of this block may take. Raises DataError beyond it, and KeyboardInterrupt on a signal."""
    calls_left = (_INSTRUCTIONS + _PER_BYTE * _bytes(file)) // _INTERVAL

    def handler() -> int:
        nonlocal calls_left
        calls_left -= 1
        return calls_left < 0

    db.set_progress_handler(handler, _INTERVAL)
    try:
        yield
    except sqlite3.OperationalError as error:
        if getattr(error, "sqlite_errorcode", None) != sqlite3.SQLITE_INTERRUPT:
            raise
        if calls_left < 0:
            raise DataError(
                f"{file} is not a run file, or is damaged: reading it takes longer than any run of its size."
            ) from None
        raise KeyboardInterrupt from None  # raised by a signal's handler; SQLite stopped in its place
    finally:
        db.set_progress_handler(None, 0)


def check_sidecars(file: Path) -> None:
    """Raise DataError for what SQLite must not open beside a run: links, pipes, and journals of several databases.

    SQLite deletes the file that such a journal names.
    """
    for (
        suffix
    ) in SIDECARS:  # the recorder of a run that is being made removes them at any moment: one look each
        sidecar = file.with_name(file.name + suffix)
        with contextlib.suppress(FileNotFoundError):
            if not stat.S_ISREG(sidecar.lstat().st_mode):
                raise DataError(
                    f"{sidecar} is not a regular file. Remove it, or copy {file.name} without it."
                )
    journal = file.with_name(file.name + "-journal")
    with contextlib.suppress(FileNotFoundError):
        if _last_bytes(journal, len(_JOURNAL_MAGIC)) == _JOURNAL_MAGIC:
            raise DataError(
                f"{journal} belongs to several databases; no run has such a journal. Remove it, or copy {file.name} "
                "without it."
            )


def _last_bytes(path: Path, count: int) -> bytes:
    with path.open("rb") as file:
        file.seek(max(os.fstat(file.fileno()).st_size - count, 0))
        return file.read(count)


def _bytes(file: Path) -> int:
    """Size of a run with its write-ahead log."""
    found = file.stat().st_size
    with contextlib.suppress(FileNotFoundError):
        found += file.with_name(file.name + "-wal").stat().st_size
    return found

"""Opens run files to read them, as a killed recorder or a power cut left them, on media that cannot be written too.

What is not yet in the file stands beside it: in a write-ahead log (-wal) while recording, in a journal (-journal) for
an instant at closing. SQLite applies both when it opens the file for writing. If that is not possible, it is done in a
temporary copy, and nothing in the folder changes.
"""

import contextlib
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from pathlib import Path

from smarig.core import DataError
from smarig.record.checked_schema import check_schema
from smarig.record.guarded_database import SIDECARS, bounded, check_sidecars, restrict

_BUSY_S = 10.0
_GROWTH_BYTES = 10_000_000  # of a file between two calls
_COPIED = ("", "-wal", "-journal")  # not -shm: it is made again from the log


@contextlib.contextmanager
def opened_for_reading(file: Path) -> Iterator[sqlite3.Connection]:
    """Yield the database of a run file, whole. Raises sqlite3.Error, ValueError or DataError for other files."""
    check_sidecars(file)
    db = _connect(file, "ro")
    try:
        try:
            with bounded(db, file):
                db.execute("SELECT 1 FROM sqlite_master").fetchone()
        except sqlite3.OperationalError:
            if not _has_sidecar(file):
                raise
            with _recovered_copy(file) as copy, bounded(copy, file):
                check_schema(copy)
                yield copy
        else:
            with bounded(db, file):
                _check_length(db, file)
                check_schema(db)
                yield db
    finally:
        db.close()


@contextlib.contextmanager
def _recovered_copy(file: Path) -> Iterator[sqlite3.Connection]:
    with tempfile.TemporaryDirectory(prefix="smarig-") as folder:
        _check_space(file, folder)
        target = Path(folder) / file.name
        for suffix in _COPIED:
            with contextlib.suppress(FileNotFoundError):
                shutil.copyfile(file.with_name(file.name + suffix), target.with_name(target.name + suffix))
        with contextlib.closing(_connect(target, "rw")) as db:
            yield db


def _check_length(db: sqlite3.Connection, file: Path) -> None:
    """Raise ValueError for a file with much more behind its database: hashing it could take for ever.

    A recorder may lengthen the file meanwhile.
    """
    (pages,), (size,) = (db.execute(f"PRAGMA {name}").fetchone() for name in ("page_count", "page_size"))
    if file.stat().st_size > 2 * pages * size + _GROWTH_BYTES:
        raise ValueError(f"its database ends after {pages * size} bytes, but the file does not")


def _check_space(file: Path, folder: str) -> None:
    """Raise DataError if a copy, and what recovering it adds, would fill the disk of temporary files."""
    parts = (file.with_name(file.name + suffix) for suffix in _COPIED)
    needed, free = 2 * sum(p.stat().st_size for p in parts if p.is_file()), shutil.disk_usage(folder).free
    if needed > free:
        raise DataError(
            f"{file} was left open. To read it, {needed / 1e6:.0f} MB are needed in {tempfile.gettempdir()}, where "
            f"{free / 1e6:.0f} MB are free. Set TMPDIR to a folder on another disk."
        )


def _connect(file: Path, mode: str) -> sqlite3.Connection:
    db = sqlite3.connect(f"{file.resolve().as_uri()}?mode={mode}", uri=True, timeout=_BUSY_S)
    restrict(db)
    return db


def _has_sidecar(file: Path) -> bool:
    return any(file.with_name(file.name + suffix).exists() for suffix in SIDECARS)

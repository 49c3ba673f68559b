"""Opens run files to read them, as a killed recorder or a power cut left them, on media that cannot be written too.

What is not yet in the file stands beside it: in a write-ahead log (-wal) while recording, in a journal (-journal) for
an instant at closing. SQLite applies both when it opens the file for writing. If that is not possible, it is done in a
temporary copy, and nothing in the folder changes.
"""

import contextlib
import os
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from pathlib import Path

from smarig.core import DataError
from smarig.record.checked_schema import check_schema
from smarig.record.guarded_database import SIDECARS, bounded, check_sidecars, restrict

_BUSY_S = 10.0
_COPIES = 5  # attempts, while somebody else writes the file
_GROWTH_BYTES = 10_000_000  # of a file between two calls
_COPIED = ("", "-wal", "-journal")  # not -shm: it is made again from the log


@contextlib.contextmanager
def opened_for_reading(file: Path) -> Iterator[sqlite3.Connection]:
    """Yield the database of a run file, whole. Raises sqlite3.Error, ValueError or DataError for other files."""
    check_sidecars(file)
    if _has_sidecar(file) and not os.access(file.parent, os.W_OK):  # SQLite would try for 10 s, and give up
        with _recovered_copy(file) as copy, _checked(copy, file):
            yield copy
        return
    db = _connect(file, "ro")
    try:
        try:
            with bounded(db, file):
                db.execute("SELECT 1 FROM sqlite_master").fetchone()
        except sqlite3.OperationalError:
            with (
                _recovered_copy(file) if _has_sidecar(file) else _whole(file) as other,
                _checked(other, file),
            ):
                yield other
        else:
            with bounded(db, file):
                _check_length(db, file)
                check_schema(db)
                yield db
    finally:
        db.close()


@contextlib.contextmanager
def _checked(db: sqlite3.Connection, file: Path) -> Iterator[None]:
    """Bound the queries of this block, on a database that holds a run and nothing else."""
    with bounded(db, file):
        check_schema(db)
        yield


def _whole(file: Path) -> contextlib.closing[sqlite3.Connection]:
    """A file beside which nothing stands: not even what SQLite would make there if it could write."""
    return contextlib.closing(_connect(file, "ro&immutable=1"))


@contextlib.contextmanager
def _recovered_copy(file: Path) -> Iterator[sqlite3.Connection]:
    with _copied(file) as target, contextlib.closing(_connect(target, "rw")) as db:
        db.execute("PRAGMA synchronous=OFF")  # nobody needs the copy after a power cut
        yield db


@contextlib.contextmanager
def recovered_file(file: Path) -> Iterator[Path]:
    """Yield a file with what stands beside it, as far as SQLite can apply it. The original stays as it is."""
    check_sidecars(file)
    if not _has_sidecar(file):
        yield file
        return
    with contextlib.ExitStack() as stack:
        try:
            target = stack.enter_context(_copied(file))
        except OSError:  # the disk does not give all of it
            target = file
        else:
            with contextlib.suppress(sqlite3.Error), contextlib.closing(_connect(target, "rw")) as db:
                db.execute("PRAGMA synchronous=OFF")
                db.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
        yield target


@contextlib.contextmanager
def _copied(file: Path) -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="smarig-") as folder:
        _check_space(file, folder)
        for _ in range(_COPIES):
            before = _state(file)
            for copied in Path(folder).iterdir():
                copied.unlink()
            for suffix in before:
                with contextlib.suppress(FileNotFoundError):
                    shutil.copyfile(file.with_name(file.name + suffix), Path(folder) / (file.name + suffix))
            if _state(file) == before:
                break
        yield Path(folder) / file.name


def _state(file: Path) -> dict[str, tuple[int, int]]:
    """Size and time of the last change of a file and of what stands beside it."""
    found = {}
    for suffix in _COPIED:
        with contextlib.suppress(FileNotFoundError):
            status = file.with_name(file.name + suffix).stat()
            found[suffix] = (status.st_size, status.st_mtime_ns)
    return found


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

"""Reopens an interrupted run for writing: adds rows for interrupted steps and marks void steps.

Measured samples are neither changed nor removed.
"""

import json
import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.core import DataError, StorageError
from smarig.record import schema, table_hashes
from smarig.record.checked_schema import check_writable_schema
from smarig.record.guarded_database import check_sidecars, restrict


@dataclass(frozen=True)
class Continuation:
    """Rows of interrupted steps (STEP_COLUMNS), and whether all earlier steps are void."""

    interrupted: tuple[tuple, ...] = ()
    void_all: bool = False


def reopened(path: Path, meta: dict[str, Any], continuation_: Continuation) -> sqlite3.Connection:
    """The run's database with its end and its hashes removed, in one transaction.

    The caller holds the lock of the run, so no other process writes. The recorder's process number is not checked,
    because another process may have it after a reboot.
    """
    db = None
    try:
        db = opened_for_recording(path)
        check_writable_schema(db)
        with db:
            if continuation_.void_all:
                db.execute(schema.VOID_STEPS)
            db.executemany(schema.INSERT_STEP, continuation_.interrupted)
            db.executemany(schema.DELETE_KEY, [("end",), (table_hashes.KEY,)])
            db.executemany(schema.UPSERT_KEY, [(k, json.dumps(v)) for k, v in meta.items()])
    except sqlite3.Error as error:
        if db is not None:
            db.close()
        raise StorageError(f"Run file {path} cannot be continued: {error}.") from None
    except ValueError as error:
        if db is not None:
            db.close()
        raise DataError(f"Run file {path} cannot be continued: {error}.") from None
    return db


def opened_for_recording(path: Path) -> sqlite3.Connection:
    """The database of a run file, such that every commit survives a power cut. Raises StorageError if it cannot be."""
    check_sidecars(path)
    db = None
    try:
        db = sqlite3.connect(f"{path.resolve().as_uri()}?mode=rw", uri=True, check_same_thread=False)
        restrict(db)
        db.execute("PRAGMA journal_mode=WAL")  # stays as it is where the file system or an error prevents it
        db.execute("PRAGMA synchronous=EXTRA")  # as FULL, and without WAL also the folder is synced
        db.execute(f"PRAGMA wal_autocheckpoint={schema.WAL_PAGES}")
        db.execute("BEGIN IMMEDIATE")  # opens the log now: later, its name may belong to another run
        db.execute("COMMIT")
    except sqlite3.Error as error:
        if db is not None:
            db.close()
        raise StorageError(f"Run file {path} cannot be opened for recording: {error}.") from None
    return db

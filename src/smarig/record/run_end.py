"""Ends a run file: cause and hashes are stored together, and then the write-ahead log is merged into the file."""

import contextlib
import json
import sqlite3
import time
from collections.abc import Callable

from smarig.record import schema, table_hashes


def store_end(
    db: sqlite3.Connection,
    cause: str,
    progress: Callable[[], object] = lambda: None,
    samples: table_hashes.SampleHashes | None = None,
) -> None:
    """Store cause and time of the end, and the hashes of all tables. Nothing may be written afterwards.

    ``samples`` have been hashed in part; ``progress`` is called for each block that is hashed.
    """
    end = {"cause": cause, "epoch": time.time(), "hashed": True}
    db.execute(schema.UPSERT_KEY, ("end", json.dumps(end)))
    hashes = table_hashes.hashes_of(db, progress, samples)
    db.execute(schema.UPSERT_KEY, (table_hashes.KEY, json.dumps(hashes)))


def end_event(t_s: float, cause: str) -> tuple:
    """The row of table event that tells of the end."""
    level = "info" if cause == "done" else "warning"
    return (t_s, level, "end", f"Run ended: {cause.rstrip('.')}.", "{}")


def leave_one_file(db: sqlite3.Connection) -> None:
    """Merge the write-ahead log into the file; otherwise committed data stay safe in the log."""
    with contextlib.suppress(sqlite3.Error):  # another process reads, or the disk is full
        db.execute("PRAGMA busy_timeout=200")
        db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        db.execute("PRAGMA journal_mode=DELETE")

"""Ends a run file: cause and hashes are stored together, and then the write-ahead log is merged into the file."""

import contextlib
import json
import sqlite3
import time
from collections.abc import Callable
from typing import Any

from smarig.core import Severity, printable, severity_of
from smarig.record import schema
from smarig.record.metadata import MAX_LINE_LENGTH
from smarig.record.sample_hashes import SampleHashes
from smarig.record.stopped_by import StoppedBy
from smarig.record.table_hashes import KEY, TICKS, block_hash, blocks


def store_end(
    db: sqlite3.Connection,
    cause: str,
    samples: SampleHashes | None = None,
    progress: Callable[[], object] = lambda: None,
    *,
    stopped_by: StoppedBy | None = None,
) -> None:
    """Store cause and time of the end, who asked for it, and the hashes of all tables. Nothing may be written after it.

    ``samples`` may have been hashed in part; ``progress`` is called for each block of the rest.
    """
    end: dict[str, Any] = {"cause": cause, "epoch": time.time(), "hashed": True}
    if stopped_by is not None:
        end["stopped_by"] = {"kind": stopped_by.kind, "account": stopped_by.account}
    db.execute(schema.UPSERT_KEY, ("end", json.dumps(end)))
    hashes = _hashes_of(db, samples or SampleHashes(), progress)
    db.execute(schema.UPSERT_KEY, (KEY, json.dumps(hashes)))


def _hashes_of(
    db: sqlite3.Connection, samples: SampleHashes, progress: Callable[[], object]
) -> dict[str, list]:
    """The hashes of all tables, as they are read, without the key that holds the hashes."""
    samples.hash_rest(db, progress)
    others = {
        table: [block_hash(b) for b in blocks(r for r in db.execute(query) if table != "run" or r[0] != KEY)]
        for table, query in schema.READ.items()
        if table != "sample"
    }
    return {"sample": samples.hashes, TICKS: samples.ticks, **others}


def end_event(t_s: float, cause: str, severity: Severity | None = None) -> tuple:
    """The row of table event that tells of the end; its severity is stored if its level does not imply it."""
    level = "info" if cause == "done" else "warning"
    implied = severity is None or severity == severity_of("end", level)
    data = {} if implied else {"severity": severity}
    text = printable(f"Run ended: {cause.rstrip('.')}.", MAX_LINE_LENGTH)
    return (t_s, level, "end", text, json.dumps(data))


def leave_one_file(db: sqlite3.Connection) -> None:
    """Merge the write-ahead log into the file; otherwise committed data stay safe in the log."""
    with contextlib.suppress(sqlite3.Error):  # another process reads, or the disk is full
        db.execute("PRAGMA busy_timeout=200")
        db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        db.execute("PRAGMA journal_mode=DELETE")

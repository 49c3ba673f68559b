"""Makes run files. A file gets its name when it holds its tables, so every file with that name can be read."""

import contextlib
import json
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from smarig.core import (
    RUN,
    DataError,
    InUse,
    StorageError,
    UsageError,
    check_replaceable,
    new_file,
)
from smarig.record import schema, table_hashes
from smarig.record.guarded_database import SIDECARS
from smarig.record.metadata import check_metadata, decode_json
from smarig.record.opened_run import opened_for_reading
from smarig.record.recording_lock import REMEDY, check_not_recording
from smarig.record.run_end import store_end
from smarig.record.written_columns import insert_columns

CLOSING_KEYS = ("end", table_hashes.KEY)  # a new run has its own


@contextlib.contextmanager
def new_run_file(path: Path, meta: dict[str, Any], *, force: bool) -> Iterator[sqlite3.Connection]:
    """Yield the database of a new run, with its tables and description; it is at ``path`` when the block succeeds.

    Raises UsageError if the name is taken, InUse if it is being recorded, and StorageError if the disk refuses.
    """
    _refuse_if_recording(path)
    if path.exists() and not force:
        raise UsageError(f"{path} exists. Give another name, or --force to replace it.")
    check_replaceable(path, RUN)
    try:
        check_metadata(
            decode_json(json.dumps(meta))
        )  # what cannot be read again is refused now, not at the end
    except (TypeError, ValueError) as error:
        raise UsageError(f"Run file {path} cannot be created: {error}.") from None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with new_file(path, force=force) as part:
            try:
                with contextlib.closing(sqlite3.connect(part)) as db:
                    db.execute("PRAGMA synchronous=FULL")
                    with db:
                        db.executescript(f"BEGIN; {schema.CREATE}")
                        keys = [(k, json.dumps(v)) for k, v in meta.items() if k not in CLOSING_KEYS]
                        db.executemany(schema.UPSERT_KEY, keys)
                    yield db
            finally:
                _remove_sidecars(part)
            _remove_sidecars(path)  # of the replaced run: they would be applied to the new one
    except (OSError, sqlite3.Error, OverflowError) as error:
        raise StorageError(f"Run file {path} cannot be created: {error}.") from None


def write_run(
    path: Path, meta: dict[str, Any], columns: dict[str, Any], steps: list[tuple], *, force: bool
) -> None:
    """Write a complete run at once (imports, simulations), or nothing.

    ``columns`` maps names of SAMPLE_COLUMNS to sequences of one length (absent ones are NULL);
    ``steps`` are rows in STEP_COLUMNS order.
    """
    meta = {"schema_version": schema.VERSION, **meta}
    with new_run_file(path, meta, force=force) as db, db:
        insert_columns(db, columns)
        db.executemany(schema.INSERT_STEP, steps)
        store_end(db, "done")


def _remove_sidecars(path: Path) -> None:
    for suffix in SIDECARS:
        path.with_name(path.name + suffix).unlink(missing_ok=True)


def _refuse_if_recording(path: Path) -> None:
    """Raise InUse if another running process still writes that run, even one with another folder of locks."""
    check_not_recording(path)
    if not path.is_file() or os.name == "nt":
        return
    try:
        with opened_for_reading(path) as db:
            meta = dict(db.execute("SELECT key, value FROM run WHERE key IN ('recorder_pid', 'end')"))
        writer = int(meta.get("recorder_pid", 0))
        if "end" in meta or writer in (0, os.getpid()):
            return
        os.kill(writer, 0)
    except (sqlite3.Error, OSError, ValueError, DataError):
        return  # not a run, or its recorder has ended
    raise InUse(f"Run {path} is being recorded by process {writer}. {REMEDY}")

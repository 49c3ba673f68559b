"""Makes run files. A file gets its name when it holds its tables, so every file with that name can be read."""

import contextlib
import json
import os
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from smarig.core import (
    RUN,
    StorageError,
    UsageError,
    check_replaceable,
    new_file,
)
from smarig.record import schema
from smarig.record.written_columns import insert_columns

SIDECARS = ("-wal", "-shm", "-journal")


@contextlib.contextmanager
def new_run_file(path: Path, meta: dict[str, Any], *, force: bool) -> Iterator[sqlite3.Connection]:
    """Yield the database of a new run, with its tables and description; it is at ``path`` when the block succeeds.

    Raises UsageError if the name is taken, and StorageError if the disk refuses.
    """
    if path.exists() and not force:
        raise UsageError(f"{path} exists. Give another name, or --force to replace it.")
    check_replaceable(path, RUN)
    _refuse_if_recording(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with new_file(path, force=force) as part:
            try:
                with contextlib.closing(sqlite3.connect(part)) as db:
                    db.execute("PRAGMA synchronous=FULL")
                    with db:
                        db.executescript(f"BEGIN; {schema.CREATE}")
                        db.executemany(schema.UPSERT_KEY, [(k, json.dumps(v)) for k, v in meta.items()])
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
    meta = {"schema_version": schema.VERSION, **meta, "end": {"cause": "done", "epoch": time.time()}}
    with new_run_file(path, meta, force=force) as db, db:
        insert_columns(db, columns)
        db.executemany(schema.INSERT_STEP, steps)


def _remove_sidecars(path: Path) -> None:
    for suffix in SIDECARS:
        path.with_name(path.name + suffix).unlink(missing_ok=True)


def _refuse_if_recording(path: Path) -> None:
    """Raise UsageError if another running process still writes that run."""
    if not path.is_file() or os.name == "nt":
        return
    try:
        with contextlib.closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as db:
            meta = dict(db.execute("SELECT key, value FROM run WHERE key IN ('recorder_pid', 'end')"))
        writer = int(meta.get("recorder_pid", 0))
        if "end" in meta or writer in (0, os.getpid()):
            return
        os.kill(writer, 0)
    except (sqlite3.Error, OSError, ValueError):
        return  # not a run, or its recorder has ended
    raise UsageError(f"Process {writer} is recording {path}. Stop that run, or give another name.")

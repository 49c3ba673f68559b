"""Opens a run that was interrupted, to write on: what was interrupted gets its row, what is void is marked, at once.

Nothing that was measured is changed or taken away. Knows the tables; refuses to know why anything is void.
"""

import json
import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.core import StorageError
from smarig.record import schema


@dataclass(frozen=True)
class Continuation:
    """Rows of steps that were interrupted (STEP_COLUMNS), and whether all steps until now are void."""

    interrupted: tuple[tuple, ...] = ()
    void_all: bool = False


def reopened(path: Path, meta: dict[str, Any], continuation_: Continuation) -> sqlite3.Connection:
    """The run's database with its end taken back, all or nothing.

    Whoever calls holds the wire: that nobody else is writing is not asked here (the recorder's process number may
    belong to a stranger after a reboot).
    """
    db = None
    try:
        db = sqlite3.connect(f"{path.resolve().as_uri()}?mode=rw", uri=True, check_same_thread=False)
        db.execute("PRAGMA journal_mode=WAL")
        db.execute("PRAGMA synchronous=FULL")
        db.execute(f"PRAGMA wal_autocheckpoint={schema.WAL_PAGES}")
        with db:
            if continuation_.void_all:
                db.execute(schema.VOID_STEPS)
            db.executemany(schema.INSERT_STEP, continuation_.interrupted)
            db.execute(schema.DELETE_KEY, ("end",))
            db.executemany(schema.UPSERT_KEY, [(k, json.dumps(v)) for k, v in meta.items()])
    except sqlite3.Error as error:
        if db is not None:
            db.close()
        raise StorageError(f"Run file {path} cannot be written on: {error}.") from None
    return db

"""Writes a run while it is made: samples are appended in the tick, and a thread commits them at least every second.

A committed sample survives kill -9 and power cuts (SQLite WAL, synchronous=FULL). The recorder is a listener: the
runner calls ``sample``, ``step`` and ``event``.
"""

import contextlib
import json
import os
import shutil
import sqlite3
import threading
import time
from collections import deque
from pathlib import Path
from typing import Any

from smarig.core import RUN, Sample, StepResult, StorageError, UsageError, check_replaceable
from smarig.record import schema
from smarig.record.clock_watch import ClockWatch
from smarig.record.continuation import Continuation, reopened

COMMIT_INTERVAL_S = 0.5
RESERVE_BYTES = 8_000_000  # stop while there is still space to close the run


class Recorder:
    """A run file that is being written. ``close(cause)`` finishes it; idempotent."""

    def __init__(
        self,
        path: Path,
        meta: dict[str, Any],
        *,
        force: bool = False,
        continuation: Continuation | None = None,
        clock: ClockWatch | None = None,
    ) -> None:
        self.path = path
        self._clock = clock or ClockWatch()
        self._rows: deque[tuple] = deque()  # appended in the tick, popped by the writer: both atomic
        self._statements: list[tuple[str, tuple]] = []
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._closing = False
        self._failure: str | None = None
        self._loss_text: str | None = None
        meta = {"schema_version": schema.VERSION, "recorder_pid": os.getpid(), **meta}
        self._db = _create(path, meta, force) if continuation is None else reopened(path, meta, continuation)
        self._thread = threading.Thread(target=self._write_until_closed, name="recorder", daemon=True)
        self._thread.start()

    # --- called in the tick ----------------------------------------------------------------------

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Record a sample, within a few microseconds. Raises StorageError after writing has failed."""
        if self._failure is not None:
            self._loss_text = None
            raise StorageError(self._failure)
        self._rows.append(
            (s[0], s[1], step, s[2], s[3], s[4], s[5], input_value, s[6], s[7], s[8], int(s[9]))
        )

    def step(
        self,
        result: StepResult,
        *,
        branch: str,
        target: float | None,
        attempt: int = 0,
        void: bool = False,
    ) -> None:
        """Record a finished step; committed at once."""
        row = (
            result.index,
            attempt,
            int(void),
            branch,
            target,
            result.t_start_s,
            result.t_end_s,
            str(result.verdict),
            result.position,
            result.n,
        )
        self._execute(schema.INSERT_STEP, row)
        self._wake.set()

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Record an event."""
        self._execute(schema.INSERT_EVENT, (t_s, level, kind, text, json.dumps(data)))

    def describe(self, key: str, value: Any) -> None:
        """Set a key of the run table."""
        self._execute(schema.UPSERT_KEY, (key, json.dumps(value)))

    def shift(self, ticks: tuple[int, int], first_step: int, counts: int, per_count: float) -> None:
        """Add the difference of two zeros to these samples and to the steps from ``first_step`` on."""
        self._execute(schema.SHIFT_SAMPLES, (counts, counts * per_count, *ticks))
        self._execute(schema.SHIFT_STEPS, (counts * per_count, first_step))

    def _execute(self, sql: str, row: tuple) -> None:
        with self._lock:
            self._statements.append((sql, row))

    # --- the writer thread -------------------------------------------------------------------------

    def _write_until_closed(self) -> None:
        while not self._closing:
            self._wake.wait(COMMIT_INTERVAL_S)
            self._wake.clear()
            try:
                self._commit()
                self._check_space()
            except StorageError as error:  # samples are lost: reported at the next sample or at the end
                self._failure = self._loss_text = f"{error} The current is at zero."
                return
            except Exception as error:  # any failure must reach the tick
                self._failure = f"Run {self.path} cannot be written: {error}. The current is at zero."
                return

    def _commit(self) -> None:
        with self._lock:  # statements first: a step in the file then has all its samples
            statements, self._statements = self._statements, []
        rows = [self._rows.popleft() for _ in range(len(self._rows))]
        jump = self._clock.jump(rows[-1][1]) if rows else ""
        if jump:
            statements.append((schema.INSERT_EVENT, (rows[-1][1], "warning", "clock", jump, "{}")))
        if not rows and not statements:
            return
        try:
            rejected = self._write_batch(rows, statements)
        except Exception:  # rolled back: keep the rows, so that closing can retry
            self._rows.extendleft(reversed(rows))
            with self._lock:
                self._statements[:0] = statements
            raise
        if rejected:
            raise StorageError(
                f"Run {self.path}: {len(rejected)} samples were not recorded; the first has tick {rejected[0][0]}, "
                "which is a duplicate or invalid. All other samples are recorded."
            )

    def _write_batch(self, rows: list[tuple], statements: list[tuple[str, tuple]]) -> list[tuple]:
        """Write all in one transaction. Returns the samples that cannot be stored, so that the others are kept."""
        rejected: list[tuple] = []
        with self._db:
            self._db.execute("SAVEPOINT batch")
            try:
                self._db.executemany(schema.INSERT_SAMPLE, rows)
            except (sqlite3.IntegrityError, OverflowError):
                self._db.execute("ROLLBACK TO batch")
                rejected = [row for row in rows if not self._insertable(row)]
            for sql, row in statements:
                self._db.execute(sql, row)
        return rejected

    def _insertable(self, row: tuple) -> bool:
        try:
            self._db.execute(schema.INSERT_SAMPLE, row)
        except (sqlite3.IntegrityError, OverflowError):
            return False
        return True

    def _check_space(self) -> None:
        free = shutil.disk_usage(self.path.parent).free
        if free < RESERVE_BYTES:
            raise OSError(f"only {free / 1e6:.1f} MB left on the disk")

    # --- the end ---------------------------------------------------------------------------------

    def close(self, cause: str = "done", *, t_s: float = 0.0) -> None:
        """Write the rest, record the cause, and leave one file (its -wal is removed with the last reader).

        Raises StorageError if the rest could not be written; committed samples stay readable.
        """
        if self._closing:
            return
        self.event(
            t_s, "end", f"Run ended: {cause.rstrip('.')}.", level="info" if cause == "done" else "warning"
        )
        self.describe("end", {"cause": cause, "epoch": time.time()})
        self._closing = True
        self._wake.set()
        self._thread.join()
        try:
            self._commit()
        except (sqlite3.Error, OverflowError) as error:
            raise StorageError(f"The end of run {self.path} could not be written: {error}.") from None
        finally:
            _leave_one_file(self._db)
            self._db.close()
        if self._loss_text is not None:
            raise StorageError(self._loss_text)


def _leave_one_file(db: sqlite3.Connection) -> None:
    """Merge the write-ahead log into the file; otherwise committed data stay safe in the log."""
    with contextlib.suppress(sqlite3.Error):  # another process reads, or the disk is full
        db.execute("PRAGMA busy_timeout=200")
        db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        db.execute("PRAGMA journal_mode=DELETE")


def _create(path: Path, meta: dict[str, Any], force: bool) -> sqlite3.Connection:
    if path.exists() and not force:
        raise UsageError(f"{path} exists. Give another name, or --force to replace it.")
    check_replaceable(path, RUN)
    _refuse_if_recording(path)
    try:
        for suffix in ("", "-wal", "-shm"):
            path.with_name(path.name + suffix).unlink(missing_ok=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        db = sqlite3.connect(path, check_same_thread=False)
        db.execute("PRAGMA journal_mode=WAL")
        db.execute("PRAGMA synchronous=FULL")
        db.execute(f"PRAGMA wal_autocheckpoint={schema.WAL_PAGES}")
        with db:
            db.executescript(schema.CREATE)
            db.executemany(schema.UPSERT_KEY, [(k, json.dumps(v)) for k, v in meta.items()])
        db.execute("PRAGMA wal_checkpoint(PASSIVE)")  # the file alone then lacks only the last minute
    except (OSError, sqlite3.Error) as error:
        raise StorageError(f"Run file {path} cannot be created: {error}.") from None
    return db


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


def write_run(
    path: Path, meta: dict[str, Any], columns: dict[str, Any], steps: list[tuple], *, force: bool
) -> None:
    """Write a complete run at once (imports, simulations), or nothing.

    ``columns`` maps names of SAMPLE_COLUMNS to sequences of one length (absent ones are NULL);
    ``steps`` are rows in STEP_COLUMNS order.
    """
    part_path = path.with_name(path.name + ".part")
    if path.exists() and not force:
        raise UsageError(f"{path} exists. Give another name, or --force to replace it.")
    check_replaceable(path, RUN)
    _refuse_if_recording(path)
    try:
        db = _create(
            part_path,
            {"schema_version": schema.VERSION, **meta, "end": {"cause": "done", "epoch": time.time()}},
            True,
        )
        try:
            n = len(columns["tick"])
            provided = [columns.get(name) for name in schema.SAMPLE_COLUMNS]
            provided[-1] = provided[-1] if provided[-1] is not None else [0] * n
            with db:
                db.executemany(
                    schema.INSERT_SAMPLE,
                    zip(*[[None] * n if c is None else _as_list(c) for c in provided], strict=True),
                )
                db.executemany(schema.INSERT_STEP, steps)
            db.execute("PRAGMA journal_mode=DELETE")
        finally:
            db.close()
        for suffix in ("-wal", "-shm"):
            path.with_name(path.name + suffix).unlink(missing_ok=True)
        part_path.replace(path)
    except (OSError, sqlite3.Error, OverflowError) as error:
        raise StorageError(f"Run file {path} cannot be written: {error}.") from None
    finally:
        for suffix in ("", "-wal", "-shm"):
            with contextlib.suppress(OSError):
                part_path.with_name(part_path.name + suffix).unlink()


def _as_list(column: Any) -> list:
    return column.tolist() if hasattr(column, "tolist") else list(column)

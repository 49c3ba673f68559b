"""Writes a run while it is made: samples are appended in the tick, and a thread commits them at least every second.

A committed sample survives kill -9 and power cuts (SQLite WAL, synchronous=EXTRA). No sample waits longer than a few
seconds: a disk that does not answer ends the run. The recorder is a listener: the runner calls ``sample``, ``step``
and ``event``.
"""

import json
import os
import shutil
import sqlite3
import threading
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.core import Sample, Severity, StepResult, StorageError, in_time, printable, severity_of
from smarig.record import schema
from smarig.record.clock_watch import ClockWatch
from smarig.record.continuation import Continuation, opened_for_recording, reopened
from smarig.record.metadata import MAX_LINE_LENGTH
from smarig.record.new_run_file import new_run_file
from smarig.record.run_end import end_event, leave_one_file, store_end
from smarig.record.sample_hashes import SampleHashes
from smarig.record.stopped_by import StoppedBy

COMMIT_INTERVAL_S = 0.5
STALL_S = 3.0  # a sample that waits longer for the disk ends the run
TWIN_STALL_S = 30.0  # the same where no wire is heated
RESUMED_S = 0.2  # how long a writer that was stopped with the process needs to go on
MOST_WAITING = 20_000  # samples, half an hour at 10 Hz; a twin makes them faster than they are stored
CLOSE_LIMIT_S = 10.0  # how long closing waits for a disk that stores nothing
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
        self._closing = threading.Event()
        self._end: tuple[float, str, Severity | None] = (0.0, "done", None)  # time, cause, severity
        self._stopped_by: StoppedBy | None = None
        self._ended = False  # the end is stored; only the merging into one file is left
        self._hashes = SampleHashes()
        self._hashed_blocks = 0  # while closing
        self._failure: StorageError | None = None
        self._loss: StorageError | None = None
        self._stall_s = TWIN_STALL_S if meta.get("source") in ("twin", "simulation") else STALL_S
        self._waiting_since: float | None = None  # host time of the oldest sample not yet taken by a commit
        self._stored = _Stored()
        self._steps_given = 0
        meta = {"schema_version": schema.VERSION, "recorder_pid": os.getpid(), **meta}
        if continuation is None:
            self._db = in_time(
                lambda: _created(path, meta, force=force),
                f"Run file {path} was not created",
                limit_s=CLOSE_LIMIT_S,
            )
        else:
            self._db = reopened(path, meta, continuation)
        self._file = _identity(path)
        self._thread = threading.Thread(target=self._write, name="recorder", daemon=True)
        self._thread.start()

    # --- called in the tick ----------------------------------------------------------------------

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Record a sample, within a few microseconds.

        Raises StorageError after writing has failed, or if the disk has stored nothing for too long.
        """
        if self._failure is not None:
            self._loss = None
            raise self._failure
        self._rows.append(
            (s[0], s[1], step, s[2], s[3], s[4], s[5], input_value, s[6], s[7], s[8], int(s[9]))
        )
        if len(self._rows) > MOST_WAITING:
            self._let_the_writer_catch_up()
        now = time.monotonic()
        if self._waiting_since is None:
            self._waiting_since = now
        elif now - self._waiting_since > self._stall_s and not self._stores_again():
            raise StorageError(
                f"Run {self.path}: the disk has stored nothing for {self._stall_s:g} s."
            ).at_zero()

    def _let_the_writer_catch_up(self) -> None:
        """Wait, so that memory does not grow with the run. Never on a bench: there the disk has stalled before."""
        until = time.monotonic() + self._stall_s
        self._wake.set()
        while len(self._rows) > MOST_WAITING and self._failure is None and time.monotonic() < until:
            time.sleep(0.001)

    def _stores_again(self) -> bool:
        """Whether the writer goes on after the whole process had been stopped (a suspended machine)."""
        before = self._waiting_since
        self._wake.set()
        time.sleep(RESUMED_S)
        return self._waiting_since != before

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
        self._steps_given += 1
        self._execute(schema.INSERT_STEP, row)
        self._wake.set()

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Record an event; its severity is stored if its level does not imply it."""
        severity = severity_of(kind, level, data)
        if severity != severity_of("", level):
            data["severity"] = severity
        row = (t_s, level, kind, printable(text, MAX_LINE_LENGTH), json.dumps(data))
        self._execute(schema.INSERT_EVENT, row)

    def describe(self, key: str, value: Any) -> None:
        """Set a key of the run table."""
        self._execute(schema.UPSERT_KEY, (key, json.dumps(value)))

    def shift(self, ticks: tuple[int, int], first_step: int, counts: int, per_count: float) -> None:
        """Add the difference of two zeros to these samples and to the steps from ``first_step`` on."""
        self._execute(schema.SHIFT_SAMPLES, (counts, counts * per_count, *ticks))
        self._execute(schema.SHIFT_STEPS, (counts * per_count, first_step))

    def suspect(self, from_s: float) -> None:
        """Mark the steps that settled since then: their readings contradict later ones."""
        self._execute(schema.SUSPECT_STEPS, (from_s,))

    def _execute(self, sql: str, row: tuple) -> None:
        with self._lock:
            self._statements.append((sql, row))

    # --- the writer thread -------------------------------------------------------------------------

    def _write(self) -> None:
        """The whole life of the thread; only it uses the database, so a disk that hangs blocks nothing else."""
        self._write_until_closed()
        self._closing.wait()
        try:
            self._commit_rest()
            self._store_end()
        except Exception as error:  # any failure must reach close
            self._loss = StorageError(
                f"The end of run {self.path} could not be written: {error}. {self._stored_text()}"
            )
        finally:
            leave_one_file(self._db)
            self._db.close()

    def _commit_rest(self) -> None:
        try:
            self._commit()
        except StorageError as error:  # samples that cannot be stored; all others are
            self._loss = error

    def _store_end(self) -> None:
        with self._db:
            self._db.execute(schema.INSERT_EVENT, end_event(*self._end))
            store_end(
                self._db, self._end[1], self._hashes, self._count_hashed_block, stopped_by=self._stopped_by
            )
        self._ended = True

    def _count_hashed_block(self) -> None:
        self._hashed_blocks += 1

    def _write_until_closed(self) -> None:
        while not self._closing.is_set():
            self._wake.wait(COMMIT_INTERVAL_S)
            self._wake.clear()
            try:
                self._commit()
                self._hashes.hash_block(self._db)
                self._check_space()
            except StorageError as error:  # samples are lost: reported at the next sample or at the end
                self._failure = self._loss = error.at_zero()
                return
            except Exception as error:  # any failure must reach the tick
                self._failure = StorageError(f"Run {self.path} cannot be written: {error}.").at_zero()
                return

    def _commit(self) -> None:
        self._waiting_since = None  # samples from here on wait for the next commit
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
        self._stored = self._stored.after(rows, statements)
        if not self._rows:
            self._waiting_since = None
        if rejected:
            raise StorageError(
                f"Run {self.path}: {len(rejected)} samples were not recorded; the first has tick {rejected[0][0]}, "
                "which is a duplicate or invalid. All other samples are recorded."
            )

    def _write_batch(self, rows: list[tuple], statements: list[tuple[str, tuple]]) -> list[tuple]:
        """Write all in one transaction. Returns the samples that cannot be stored, so that the others are kept."""
        rejected: list[tuple] = []
        self._hashes.will_write(rows, statements)
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
        try:
            free = shutil.disk_usage(self.path.parent).free
        except FileNotFoundError:  # the folder was moved, and the open file with it: check_in_place says so
            return
        if free < RESERVE_BYTES:
            raise OSError(f"only {free / 1e6:.1f} MB left on the disk")

    # --- the end ---------------------------------------------------------------------------------

    def close(
        self,
        cause: str = "done",
        *,
        t_s: float = 0.0,
        severity: Severity | None = None,
        stopped_by: StoppedBy | None = None,
    ) -> None:
        """Write the rest, record the cause, and leave one file (its -wal is removed with the last reader).

        Raises StorageError if the rest could not be written, or not in time; committed samples stay readable.
        """
        if self._closing.is_set():
            return
        self._end, self._stopped_by = (t_s, printable(cause, MAX_LINE_LENGTH), severity), stopped_by
        self._closing.set()
        self._wake.set()
        self._wait_for_writer()
        if self._thread.is_alive():
            raise StorageError(self._stalled_text()).at_zero()
        if self._loss is not None:
            raise self._loss

    def check_in_place(self) -> None:
        """Raise StorageError if the name of the closed run leads to no file any more, or to another one."""
        if self._file != _identity(self.path):
            raise StorageError(
                f"Run {self.path} was recorded to its end, but its file was renamed, moved, replaced or removed "
                "meanwhile. Look for it under its new name."
            )

    def _wait_for_writer(self) -> None:
        """Wait as long as something is stored or hashed every few seconds."""
        before = None
        while self._thread.is_alive() and (self._stored, self._hashed_blocks) != before:
            before = self._stored, self._hashed_blocks
            self._thread.join(CLOSE_LIMIT_S)

    def _stalled_text(self) -> str:
        if self._ended:
            text = f"The end of run {self.path} is stored, but since then the disk does not answer."
        else:
            text = f"Run {self.path} could not be closed in time: the disk does not answer. {self._stored_text()}"
        return text

    def on_disk(self) -> str:
        """What is on disk, while the run or its closing goes on."""
        if self._ended:
            return f"Run {self.path} is closed."
        return f"Run {self.path} is not closed; 'smarig resume' continues it. {self._stored_text()}"

    def _stored_text(self) -> str:
        """What is stored for certain."""
        stored = self._stored
        samples = "no new samples" if stored.t_s is None else f"the samples up to {stored.t_s:.1f} s"
        steps = f"{stored.steps} of {self._steps_given} steps"
        return f"It holds at least {samples} and {steps}; the later ones may be lost."


def _created(path: Path, meta: dict[str, Any], *, force: bool) -> sqlite3.Connection:
    with new_run_file(path, meta, force=force):
        pass
    return opened_for_recording(path)


@dataclass(frozen=True)
class _Stored:
    """What the commits of a recorder have stored: time of the last sample, number of steps."""

    t_s: float | None = None
    steps: int = 0

    def after(self, rows: list[tuple], statements: list[tuple[str, tuple]]) -> "_Stored":
        steps = sum(sql == schema.INSERT_STEP for sql, _ in statements)
        return _Stored(rows[-1][1] if rows else self.t_s, self.steps + steps)


def _identity(path: Path) -> tuple[int, int] | None:
    """The file behind a name; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino

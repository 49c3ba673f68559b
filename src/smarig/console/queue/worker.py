"""The process that starts the entries of a queue in order: ``python -m smarig.console.queue.worker FOLDER``.

It starts only what a person has asked for under this account (``AllowedEntries``), and keeps the order: the first entry
that waits for a click holds up the rest. It holds nothing that a run needs. If it is killed, the run goes on; the next
worker finds it alive, waits for it and stores its outcome. It never starts an entry that it finds started.
"""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from smarig.console.queue.allowed_entries import AllowedEntries
from smarig.console.queue.entry_process import (
    EntryFiles,
    Outcome,
    bound_log,
    check_logs,
    check_system,
    forget_result,
    is_alive,
    outcome_of,
    start_process,
)
from smarig.console.queue.queue_entry import EntryState, QueueEntry
from smarig.console.queue.queue_file import QueueFile
from smarig.core import InUse, SmarigError, StorageError, process_lock

LOG = "queue.log"
POLL_S = 0.2
RETRY_S = 5.0  # after a disk was full
IDLE_S = 300.0  # without anything to do, the worker ends; the console starts another one when it needs it


def lock_key(folder: Path) -> str:
    """The key of the lock that the worker of a folder holds."""
    return f"queue {os.path.realpath(folder)}"


class Worker:
    """Starts the entries of an open queue, one after the other."""

    def __init__(self, folder: Path, file: QueueFile) -> None:
        self._folder, self._file, self._allowed = folder, file, AllowedEntries(folder)
        self._process: subprocess.Popen[bytes] | None = None  # None for an entry of an earlier worker

    def step(self) -> bool:
        """Follow the entry that runs, or start the next one. Returns False if there is nothing to do."""
        running = self._file.entries(EntryState.RUNNING)
        if running:
            self._follow(running[0])
            return True
        entry = self._take_next()
        if entry is not None:
            self._start(entry)
        return entry is not None

    def _take_next(self) -> QueueEntry | None:
        """The next entry, marked as running on the disk before its process exists, so that none is started twice.

        As it was when its mark was looked for: a trigger in a file of somebody else may change it meanwhile.
        """
        if self._next() is None:
            return None
        with self._file.transaction():
            entry, now = self._next(), time.time()
            if entry is None or not self._allowed.take(entry):
                return None
            forget_result(self._folder, entry.id)
            self._file.update(entry.id, state=EntryState.RUNNING, started=now, pid=None)
        return replace(entry, state=EntryState.RUNNING, started=now, pid=None)

    def _next(self) -> QueueEntry | None:
        """The entry that may be started now."""
        waiting = [] if self._file.get("paused") else self._file.entries(EntryState.WAITING)
        return waiting[0] if waiting and self._allowed.has(waiting[0]) else None

    def has_work(self) -> bool:
        """Whether an entry runs, or may be started now."""
        return self._next() is not None or bool(self._file.entries(EntryState.RUNNING))

    def _start(self, entry: QueueEntry) -> None:
        try:
            self._process = start_process(entry, self._folder)
        except InUse:  # it is followed from the next step on
            return
        except OSError as error:
            sentence = f"It could not be started: {error.strerror or error}."
            self._end(entry, Outcome(EntryState.FAILED, None, sentence))
            return
        pid = self._process.pid
        _log(f"Entry {entry.id} was started as process {pid}.")
        _until_stored(lambda: self._file.update(entry.id, pid=pid))

    def _follow(self, entry: QueueEntry) -> None:
        """Look whether it has ended; store its outcome if so."""
        bound_log(EntryFiles.of(self._folder, entry.id).lines)
        exit_status = self._process.poll() if self._process else None
        alive = exit_status is None if self._process else is_alive(self._folder, entry.id)
        if not alive:
            self._process = None
            self._end(entry, outcome_of(self._folder, entry.id, exit_status))

    def _end(self, entry: QueueEntry, outcome: Outcome) -> None:
        _until_stored(lambda: self._store(entry, outcome))
        _log(f"Entry {entry.id} is {outcome.state}. {outcome.sentence}".rstrip())

    def _store(self, entry: QueueEntry, outcome: Outcome) -> None:
        how = {"exit_status": outcome.exit_status, "sentence": outcome.sentence, "ended": time.time()}
        with self._file.transaction():
            self._file.update(entry.id, state=outcome.state, pid=None, **how)
            if outcome.pauses:
                text = f"Entry {entry.id} ({entry.request.experiment}) is {outcome.state}: {outcome.sentence}"
                self._file.set(paused={"sentence": text, "by": entry.id})
            elif self._file.get("stop_after_this"):
                self._file.set(paused={"sentence": f"Stopped after entry {entry.id}.", "by": None})
            self._file.set(stop_after_this=None)


def work(folder: Path, idle_s: float = IDLE_S) -> None:
    """Work until nothing has been left to do for a while. Raises InUse if another worker has the folder.

    An entry that is added while the lock is released is seen: ``ensure_worker`` then finds the lock free, or the look
    after the release finds the entry.
    """
    check_system()
    check_logs(folder)
    with QueueFile(folder) as file:
        worker = Worker(folder, file)
        while True:
            remedy = "It does the work."
            with process_lock(lock_key(folder), f"The queue of {folder} is served", remedy, lasting=False):
                _work_until_idle(worker, folder, idle_s)
            if not worker.has_work():
                return


def _work_until_idle(worker: Worker, folder: Path, idle_s: float) -> None:
    idle_since = time.monotonic()
    while time.monotonic() - idle_since < idle_s:
        try:
            if worker.step():
                idle_since = time.monotonic()
        except (
            StorageError,
            InUse,
            OSError,
        ) as error:  # nothing was started; perhaps there is room again later
            _log(str(error))
            time.sleep(RETRY_S)
            idle_since = time.monotonic()
        bound_log(folder / LOG)
        time.sleep(POLL_S)


def _until_stored(store: Callable[[], None]) -> None:
    """An outcome is not lost because the disk is full for a while."""
    while True:
        try:
            return store()
        except (StorageError, InUse) as error:
            _log(str(error))
            time.sleep(RETRY_S)


def _log(text: str) -> None:
    """A line on stderr, which is the log. A full disk does not end the worker."""
    with contextlib.suppress(OSError):
        stamp = time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime())
        sys.stderr.write(f"{stamp} {text}\n")
        sys.stderr.flush()


def main() -> None:
    """Serve the folder that is the argument."""
    try:
        work(Path(sys.argv[1]))
    except SmarigError as error:
        _log(str(error))
        sys.exit(error.exit_status)


if __name__ == "__main__":
    main()

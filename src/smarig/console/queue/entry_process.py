"""The process of an entry: started in a session of its own, and seen to be alive by a lock that it inherits.

The lock belongs to an open file that the worker passes to the process (flock). The system releases it when the process
ends, however it ends, and not when the worker does. So neither a process number that was given again nor a restart of
the machine can be mistaken for a run. Output goes to files: a pipe would break with the worker.
"""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from smarig.console.command_process import process_command
from smarig.console.queue.entry_command import entry_command
from smarig.console.queue.queue_entry import QueueEntry
from smarig.core import InUse, UsageError, shared_lock, try_lock

LOGS = "queue.logs"
LARGEST_LOG_BYTES = (
    1_000_000  # of the lines of an entry, which its record holds too; the first half is dropped
)


@dataclass(frozen=True)
class EntryFiles:
    """The files of an entry beside the queue: its lock, its lines of progress, and its result."""

    lock: Path
    lines: Path
    result: Path

    @classmethod
    def of(cls, folder: Path, number: int) -> "EntryFiles":
        """Those of the entry with this number."""
        logs = folder / LOGS
        return cls(logs / f"{number}.lock", logs / f"{number}.lines.jsonl", logs / f"{number}.result.json")


def check_system() -> None:
    """Raise UsageError where the system has no locks that a process inherits."""
    if os.name == "nt":
        raise UsageError("The queue needs locks that a process inherits, which Windows does not have.")


def check_logs(folder: Path) -> None:
    """Raise UsageError if the logs would be written elsewhere."""
    if (folder / LOGS).is_symlink():
        raise UsageError(
            f"{folder / LOGS} is a link to another folder. Remove it; the logs of the queue belong there."
        )


def start_process(entry: QueueEntry, folder: Path) -> subprocess.Popen[bytes]:
    """Start the command of an entry. Raises InUse if its process is alive already, and OSError."""
    files = EntryFiles.of(folder, entry.id)
    files.lock.parent.mkdir(exist_ok=True)
    command = process_command([*entry_command(entry.request, continued=entry.continued), "--json"])
    with _opened(files.lock, os.O_RDWR) as lock:
        if not try_lock(lock):
            raise InUse(f"Entry {entry.id} is running already.")
        with _opened(files.lines, os.O_APPEND) as lines, _opened(files.result, os.O_TRUNC) as result:
            return subprocess.Popen(
                command,
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=result,
                stderr=lines,
                start_new_session=True,  # signals to the worker and the console do not reach it
                pass_fds=(lock.fileno(),),
            )


def is_alive(folder: Path, number: int) -> bool:
    """Whether the process of an entry is running, whoever started it. The one place that decides this."""
    path = EntryFiles.of(folder, number).lock
    if not path.exists():
        return False
    with _opened(path, os.O_RDWR) as lock:
        return not shared_lock(lock)


def forget_result(folder: Path, number: int) -> None:
    """Remove the result of an earlier start, which must not be taken for that of the next."""
    EntryFiles.of(folder, number).result.unlink(missing_ok=True)


def bound_log(path: Path, largest: int = LARGEST_LOG_BYTES) -> None:
    """Keep the last lines of a file that is being appended to, if it has grown too large.

    A line that is written in the same moment may be lost; the record of the run has it.
    """
    with suppress(OSError):
        if path.stat().st_size <= largest:
            return
        with path.open("a+b") as file:  # appends, as the process does: neither overwrites the other
            file.seek(-(largest // 2), os.SEEK_END)
            file.readline()
            kept = file.read()
            file.truncate(0)
            file.write(kept)


@contextmanager
def _opened(path: Path, flags: int) -> Iterator[IO[bytes]]:
    """The file, closed afterwards: what the process has inherited stays open there. No link is followed."""
    writable = flags if flags & os.O_RDWR else flags | os.O_WRONLY
    descriptor = os.open(path, writable | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
    with os.fdopen(descriptor, "r+b" if flags & os.O_RDWR else "wb", buffering=0) as file:
        yield file

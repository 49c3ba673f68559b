"""The process of an entry: started in a session of its own, and seen to be alive by a lock that it inherits.

The lock belongs to an open file that the worker passes to the process (flock). The system releases it when the process
ends, however it ends, and not when the worker does. So neither a process number that was given again nor a restart of
the machine can be mistaken for a run. Output goes to files: a pipe would break with the worker.

How an entry has ended: from its exit status, its result and its last lines.
"""

import json
import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from smarig.console.command_process import process_command
from smarig.console.queue.entry_request import entry_command
from smarig.console.queue.queue_entry import EntryState, QueueEntry
from smarig.core import (
    Interrupted,
    InUse,
    UsageError,
    file_bytes,
    opened_file,
    printable,
    shared_lock,
    try_lock,
)

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


_LAST_BYTES = 20_000  # of the lines that are searched for the last sentence
_LARGEST_RESULT = 100_000_000
_NO_RESULT = "The process is gone without a result: it was killed, or the machine was restarted."


@dataclass(frozen=True)
class Outcome:
    """The new state of an entry. ``pauses``: the rig, the data or a person gave a reason to start nothing more."""

    state: EntryState
    exit_status: int | None
    sentence: str

    @property
    def pauses(self) -> bool:
        """A refused command (exit status 2) has no cause that the next entry would share."""
        refused = self.state is EntryState.FAILED and self.exit_status == UsageError.exit_status
        return self.state is not EntryState.DONE and not refused


def outcome_of(folder: Path, number: int, exit_status: int | None) -> Outcome:
    """The outcome of an entry whose process has ended. ``exit_status`` is None if another worker had started it."""
    files = EntryFiles.of(folder, number)
    result = _result(files.result)
    if exit_status is None and result is not None:
        exit_status = result.get("exit_status", 0) if "error" in result else 0
    if exit_status is None or exit_status < 0:
        return Outcome(EntryState.INTERRUPTED, exit_status, _killed_text(exit_status))
    error = str(result["error"]) if result and "error" in result else ""
    if exit_status == 0:
        return Outcome(EntryState.DONE, 0, printable(_last_sentence(files.lines, "Warning: "), 1000))
    sentence = printable(error or _last_sentence(files.lines), 1000)
    state = EntryState.STOPPED if exit_status == Interrupted.exit_status else EntryState.FAILED
    return Outcome(state, exit_status, sentence or f"It ended with exit status {exit_status}.")


def _killed_text(exit_status: int | None) -> str:
    if exit_status is None:
        return _NO_RESULT
    try:
        name = signal.Signals(-exit_status).name
    except ValueError:
        name = f"signal {-exit_status}"
    return f"The process was killed ({name})."


def _result(path: Path) -> dict[str, Any] | None:
    """The object that a command prints at its end; None if it printed none."""
    with suppress(UsageError, OSError, ValueError):
        if path.stat().st_size <= _LARGEST_RESULT:
            found = json.loads(file_bytes(path))
            return found if isinstance(found, dict) else None
    return None


def _last_sentence(path: Path, start: str = "") -> str:
    """The last line for people that starts so; lines for programs begin with a brace."""
    with suppress(UsageError, OSError), opened_file(path) as file:
        file.seek(max(path.stat().st_size - _LAST_BYTES, 0))
        lines = file.read().decode("utf-8", "replace").splitlines()
        plain = [
            line for line in map(str.strip, lines) if line.startswith(start) and line[:1] not in ("", "{")
        ]
        return plain[-1].removeprefix("smarig: ") if plain else ""
    return ""

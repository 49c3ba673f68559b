"""Starts the worker of a queue if none is alive."""

import os
import subprocess
from pathlib import Path

from smarig.console.command_process import process_command
from smarig.console.queue.worker import LOG, lock_key
from smarig.core import InUse, StorageError, check_free

_started: dict[str, subprocess.Popen[bytes]] = {}  # kept to be waited for: none is left as a zombie


def ensure_worker(folder: Path) -> bool:
    """Start the worker of a folder, which outlives this process. Returns whether one was started.

    Two that start at once are no harm: the second refuses. Raises StorageError if it cannot be started.
    """
    key = lock_key(folder)
    mine = _started.get(key)
    if mine is not None and mine.poll() is None:
        return False
    try:
        check_free(key, "", "")
    except InUse:
        return False
    try:
        _started[key] = _start(folder)
    except OSError as error:
        raise StorageError(
            f"The worker of {folder} could not be started: {error.strerror or error}."
        ) from None
    return True


def _start(folder: Path) -> subprocess.Popen[bytes]:
    append = os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0)
    append |= getattr(os, "O_NONBLOCK", 0)  # a pipe of this name must not hold the console up
    log = os.open(folder / LOG, append, 0o644)
    try:
        return subprocess.Popen(
            process_command(["smarig.console.queue.worker", str(folder.resolve())]),
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=log,
            start_new_session=True,
        )
    finally:
        os.close(log)

"""The lock of a run file: one process at a time records a run, whatever drives it."""

import os
from contextlib import AbstractContextManager
from pathlib import Path

from smarig.core import InUse, check_free, process_lock

REMEDY = "Wait until it has ended, stop it, or give another name."


def recording(path: Path) -> AbstractContextManager[None]:
    """Hold the lock of a run file while it is recorded. Raises InUse if another process has it."""
    return process_lock(_key(path), f"Run {path} is being recorded", REMEDY, lasting=False)


def check_not_recording(path: Path) -> None:
    """Raise InUse if another process records that run."""
    check_free(_key(path), f"Run {path} is being recorded", REMEDY)


def is_recording(path: Path) -> bool:
    """Whether a process records that run."""
    try:
        check_not_recording(path)
    except InUse:
        return True
    return False


def _key(path: Path) -> str:
    return f"run {os.path.realpath(path)}"  # unlike resolve(), it accepts a link to itself

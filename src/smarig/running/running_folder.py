"""The folder in which runs announce themselves: one per user, in main memory where the system has such a place.

On a disk, a write to mapped memory may wait for that disk, and the run with it; so a file system in memory comes first.
"""

import os
import stat
from pathlib import Path

from smarig.core import UsageError, lock_folder

SUFFIX = ".run-in-progress"
_MEMORY = Path("/dev/shm")


def running_folder() -> Path:
    """The folder: $SMARIG_RUNNING_DIR, or the user's own in main memory, or one beside the locks."""
    if given := os.environ.get("SMARIG_RUNNING_DIR"):
        return Path(given)
    if hasattr(os, "getuid") and _MEMORY.is_dir() and os.access(_MEMORY, os.W_OK):
        return _MEMORY / f"smarig-running-{os.getuid()}"
    return lock_folder() / "running"


def made_running_folder() -> Path:
    """The folder, made if it is missing. Raises OSError, or UsageError if it is not the user's own."""
    folder = running_folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    check_own(folder)
    return folder


def check_own(folder: Path) -> None:
    """Raise UsageError if the folder is another user's or a link, or if others may write into it."""
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        raise UsageError(f"{folder} is not a folder. Remove it, or set SMARIG_RUNNING_DIR to a folder.")
    if hasattr(os, "getuid") and (found.st_uid != os.getuid() or found.st_mode & 0o022):
        raise UsageError(
            f"Other users can write into {folder}. Set SMARIG_RUNNING_DIR to a folder that only you can write to."
        )

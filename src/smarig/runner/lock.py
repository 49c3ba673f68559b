"""One runner per wire: a lock file held by the operating system, which releases it when the process ends.

The lock belongs to the name of the wire. Twins lock the wire name of their rig file, as hardware does. Links are not
followed, and another user's file is locked without changing it.
"""

import os
import stat
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from smarig.core import RigFault, UsageError


def lock_folder() -> Path:
    """The folder of the locks: $SMARIG_LOCK_DIR, or the user's own in the runtime or temporary folder."""
    if given := os.environ.get("SMARIG_LOCK_DIR"):
        return Path(given)
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        return Path(runtime) / "smarig-locks"
    user = getattr(os, "getuid", lambda: "")()
    return Path(tempfile.gettempdir()) / f"smarig-locks-{user}"


@contextmanager
def wire_lock(wire: str) -> Iterator[None]:
    """Hold the lock of a wire. Raises RigFault with the holder if another process has it."""
    with _opened(wire) as file:
        if not _try_lock(file):
            file.seek(0)
            holder = file.read().strip() or "another process"
            raise RigFault(
                f"Wire '{wire}' is in use by {holder}. Wait for it, or give another wire with --wire."
            )
        _note(file, f"process {os.getpid()}")
        yield
        _note(file, "")


def _note(file: IO, holder: str) -> None:
    """Write who holds the lock, if the file is one's own."""
    if file.writable():
        file.seek(0)
        file.truncate()
        file.write(holder)
        file.flush()


def _opened(wire: str) -> IO:
    readable = "".join(c if c.isalnum() or c in "-_" else "_" for c in wire)[:60]
    path = lock_folder() / f"{readable}-{zlib.crc32(wire.encode()):08x}.lock"
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        _check_own(path.parent)
        file = _opened_or_created(path)
    except OSError as error:
        raise UsageError(
            f"Lock {path} cannot be created: {error.strerror}. Set SMARIG_LOCK_DIR to a folder."
        ) from None
    if os.fstat(file.fileno()).st_nlink != 1:  # a second name of another file
        file.close()
        raise UsageError(
            f"Lock {path} is not a file of its own. Remove it, or set SMARIG_LOCK_DIR to a folder."
        )
    return file


def _check_own(folder: Path) -> None:
    """Raise UsageError if another user made the folder that belongs to this one; $SMARIG_LOCK_DIR may be anybody's."""
    if os.environ.get("SMARIG_LOCK_DIR") or not hasattr(os, "getuid"):
        return
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        raise UsageError(
            f"The folder of locks {folder} belongs to another user. Set SMARIG_LOCK_DIR to a folder."
        )


def _opened_or_created(path: Path) -> IO:
    """The file, for reading only if it is another user's: such a file can be locked, but not changed."""
    no_link = getattr(os, "O_NOFOLLOW", 0)
    try:
        return os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT | no_link, 0o644), "r+")
    except PermissionError:
        return os.fdopen(os.open(path, os.O_RDONLY | no_link), "r")


def _try_lock(file: IO) -> bool:
    try:
        if os.name == "nt":
            import msvcrt

            file.seek(1 << 30)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True

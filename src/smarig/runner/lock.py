"""One runner per wire: a lock file held by the operating system, which releases it when the process ends.

The lock belongs to the name of the wire. Twins lock the wire name of their rig file, as hardware does.
"""

import contextlib
import os
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from smarig.core import RigFault, UsageError


def lock_folder() -> Path:
    """The folder of the locks: $SMARIG_LOCK_DIR, or one in the system's temporary folder."""
    return Path(os.environ.get("SMARIG_LOCK_DIR") or Path(tempfile.gettempdir()) / "smarig-locks")


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
        file.seek(0)
        file.truncate()
        file.write(f"process {os.getpid()}")
        file.flush()
        yield
        file.seek(0)
        file.truncate()


def _opened(wire: str) -> IO:
    readable = "".join(c if c.isalnum() or c in "-_" else "_" for c in wire)[:60]
    path = lock_folder() / f"{readable}-{zlib.crc32(wire.encode()):08x}.lock"
    try:
        if not path.parent.is_dir():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.parent.chmod(0o1777)  # all users share the lock of a wire
        file = path.open("a+")
        with contextlib.suppress(OSError):  # another user's file: its mode cannot be changed
            path.chmod(0o666)
    except OSError as error:
        raise UsageError(
            f"Lock {path} cannot be created: {error.strerror}. Set SMARIG_LOCK_DIR to a folder."
        ) from None
    return file


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

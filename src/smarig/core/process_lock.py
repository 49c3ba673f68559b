"""Locks between processes: files locked by the operating system, which releases them when a process ends.

They exclude processes of one computer that use the same folder of locks. Links are not followed, and another user's
file is locked without changing it. A folder that does not answer delays nobody for more than seconds.
"""

import contextlib
import os
import shlex
import stat
import sys
import tempfile
import time
import weakref
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from smarig.core.errors import InUse, UsageError
from smarig.core.file_work import entered_in_time, in_time

_MOST = 200  # characters of a holder that are shown
_held: set[str] = set()  # keys of the locks of this process
_locked_files: "weakref.WeakSet[IO]" = weakref.WeakSet()


def lock_folder() -> Path:
    """The folder of the locks: $SMARIG_LOCK_DIR, or the user's own in the runtime or temporary folder."""
    if given := os.environ.get("SMARIG_LOCK_DIR"):
        return Path(given)
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        return Path(runtime) / "smarig-locks"
    user = getattr(os, "getuid", lambda: "")()
    return Path(tempfile.gettempdir()) / f"smarig-locks-{user}"


@contextmanager
def process_lock(key: str, what: str, remedy: str, *, lasting: bool = True) -> Iterator[None]:
    """Hold the lock of a key. Raises InUse, "``what`` by HOLDER. ``remedy``", if it is held already.

    The file of a key that will not come back is removed at the end (``lasting=False``).
    """
    path = _path(key)
    files: list[IO] = []
    try:
        with entered_in_time(_noted_lock(path, what, remedy, files, lasting=lasting), f"Lock {path}"):
            _held.add(key)
            yield
    finally:
        _held.discard(key)
        for file in files:  # its folder did not answer: the lock itself is the kernel's
            _give_back(file)


@contextmanager
def _noted_lock(path: Path, what: str, remedy: str, files: list[IO], *, lasting: bool) -> Iterator[None]:
    """Hold a lock whose file says who holds it; ``files`` holds that file meanwhile."""
    with _locked(path, what, remedy) as file:
        files.append(file)
        try:
            _note(file, holder_text())
            yield
        finally:
            _note(file, "")
            if not lasting:
                with contextlib.suppress(OSError):  # another user's, or a system that keeps open files
                    path.unlink()
    files.clear()


def give_back_locks() -> None:
    """Give back all locks of this process, which is about to end; see ``forced_end``."""
    for file in list(_locked_files):
        _give_back(file)


def check_free(key: str, what: str, remedy: str) -> None:
    """Raise InUse if another process holds the lock of a key. Nothing is written."""
    if key not in _held:
        path = _path(key)
        in_time(lambda: _check_free(path, what, remedy), f"Lock {path}")


def _check_free(path: Path, what: str, remedy: str) -> None:
    if not path.exists():
        return
    with contextlib.suppress(OSError), _opened(path, 0) as file:
        if not shared_lock(file):
            raise InUse(_refusal(file, what, remedy))


def holder_text() -> str:
    """This process as others see it: number, start of the use, command without its options."""
    since = time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime())
    return f"process {os.getpid()} since {since} ({own_command()})"


def own_command() -> str:
    """The command of this process up to its first option: options may hold what nobody else should read."""
    program, *words = sys.argv or ["python"]
    file = Path(program)
    name = file.parent.name if file.stem == "__main__" else file.name
    plain = next((k for k, word in enumerate(words) if word.startswith("-")), len(words))
    return shlex.join([name or "python", *words[:plain]])[: _MOST // 2]


@contextmanager
def _locked(path: Path, what: str, remedy: str) -> Iterator[IO]:
    """The file, locked; opened again if its last holder removed it meanwhile."""
    while True:
        with _created(path) as file:
            if not try_lock(file):
                raise InUse(_refusal(file, what, remedy))
            if _is_at(file, path):
                yield file
                return


def _is_at(file: IO, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.lstat())
    except OSError:
        return False


def _refusal(file: IO, what: str, remedy: str) -> str:
    file.seek(0)
    noted = "".join(c for c in file.read(_MOST) if c.isprintable()).strip()
    return f"{what} by {noted or 'another process'}. {remedy}"


def _note(file: IO, holder: str) -> None:
    """Write who holds the lock, if the file is one's own."""
    if file.writable():
        file.seek(0)
        file.truncate()
        file.write(holder)
        file.flush()


def _path(key: str) -> Path:
    readable = "".join(c if c.isalnum() or c in "-_" else "_" for c in key)[-60:]
    return lock_folder() / f"{readable}-{zlib.crc32(key.encode(errors='surrogateescape')):08x}.lock"


def _created(path: Path) -> IO:
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        _check_own(path.parent)
        file = _opened(path, os.O_CREAT)
    except OSError as error:
        raise UsageError(
            f"Lock {path} cannot be created: {error.strerror}. Set SMARIG_LOCK_DIR to a folder."
        ) from None
    if os.fstat(file.fileno()).st_nlink > 1:  # a second name of another file
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


def _opened(path: Path, create: int) -> IO:
    """The file, for reading only if it is another user's: such a file can be locked, but not changed."""
    no_link = getattr(os, "O_NOFOLLOW", 0)
    try:
        return os.fdopen(
            os.open(path, os.O_RDWR | create | no_link, 0o644), "r+", encoding="utf-8", errors="replace"
        )
    except PermissionError:
        return os.fdopen(os.open(path, os.O_RDONLY | no_link), "r", encoding="utf-8", errors="replace")


def try_lock(file: IO) -> bool:
    """Lock an open file for this process alone, until it is closed. Whether that succeeded.

    Who only looks whether a file is locked shares its lock for a moment; that is waited for.
    """
    while not _lock(file, shared=False):
        if os.name == "nt" or not _lock(file, shared=True):
            return False
    return True


def shared_lock(file: IO) -> bool:
    """The same, beside others that share it. It fails while a process has locked the file for itself.

    Windows has no such lock: there it is that of one process.
    """
    return _lock(file, shared=True)


def _lock(file: IO, *, shared: bool) -> bool:
    try:
        if os.name == "nt":
            import msvcrt

            file.seek(1 << 30)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError:
        return False
    _locked_files.add(file)
    return True


def _give_back(file: IO) -> None:
    """Unlock without touching the file, which its folder may delay."""
    if os.name != "nt":
        import fcntl

        with contextlib.suppress(OSError, ValueError):  # closed meanwhile
            fcntl.flock(file, fcntl.LOCK_UN)

"""Regular files: a pipe or a device under the name of a file may never end, so it is refused before it is read."""

import os
import stat
from io import BufferedReader
from pathlib import Path

from smarig.core.errors import UsageError
from smarig.core.shown_text import printable


def is_file(path: Path) -> bool:
    """Whether a text leads to a regular file. One that cannot be a name (too long, with a null character) does not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """The same of a folder."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def check_file(path: Path, kind: str = "file", remedy: str = "") -> None:
    """Raise UsageError unless there is a regular file. ``kind``: what was expected, such as "run file"; ``remedy``: a
    sentence for a file that is missing.
    """
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError, ValueError):
        raise UsageError(f"There is no {kind} {path}. {remedy}".rstrip()) from None
    except OSError as error:
        raise UsageError(f"{printable(str(path), 200)} cannot be read: {error.strerror or error}.") from None
    if stat.S_ISDIR(mode):
        raise UsageError(f"{path} is a folder. Name a {kind} in it.")
    if not stat.S_ISREG(mode):
        raise _not_regular(path)


def opened_file(path: Path) -> BufferedReader:
    """A regular file, opened for reading. Raises UsageError for anything else, and OSError."""
    check_file(path)  # before it is opened, which would reset the device at a serial port
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    file = os.fdopen(os.open(path, flags), "rb")
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):  # exchanged meanwhile
        file.close()
        raise _not_regular(path)
    return file


def file_bytes(path: Path) -> bytes:
    """The bytes of a regular file. Raises UsageError for anything else, and OSError."""
    with opened_file(path) as file:
        return file.read()


def _not_regular(path: Path) -> UsageError:
    return UsageError(f"{path} is not a regular file, so it is not read. Give another name.")

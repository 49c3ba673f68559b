"""A file appears under its name only when it is complete: it is written beside it and then renamed."""

import contextlib
import os
import secrets
from pathlib import Path

from smarig.core.errors import UsageError

_LONGEST = 120  # characters of the name that a temporary one repeats


def new_part_file(path: Path) -> Path:
    """Create an empty file in the folder of ``path``, under a name that cannot be guessed."""
    part = path.with_name(f".{path.name[:_LONGEST]}.{secrets.token_hex(8)}.part")
    os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_NOFOLLOW", 0), 0o666))
    return part


def publish(part: Path, path: Path, *, force: bool) -> None:
    """Give the file ``part`` its name ``path``, and make the name survive a power cut.

    Raises UsageError if the name was taken meanwhile (without ``force``), or belongs to something that is no file.
    """
    check_regular(path)
    if force:
        part.replace(path)
    else:
        _link(part, path)
    _sync_folder(path.parent)


def check_regular(path: Path) -> None:
    """Raise UsageError if a name belongs to a device, a pipe or a socket, which a file must not replace."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise UsageError(f"{path} is not a regular file, so it is not replaced. Give another name.")


def _link(part: Path, path: Path) -> None:
    """Rename without replacing."""
    try:
        os.link(part, path)
    except FileExistsError:
        raise UsageError(f"{path} exists. Give another name, or --force to replace it.") from None
    except OSError:  # a file system without hard links
        if path.exists():
            raise UsageError(f"{path} exists. Give another name, or --force to replace it.") from None
        part.replace(path)
    else:
        part.unlink()


def _sync_folder(folder: Path) -> None:
    if os.name == "nt":
        return
    with contextlib.suppress(OSError):  # some file systems cannot
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

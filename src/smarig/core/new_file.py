"""A file appears under its name only when it is complete: it is written beside it and then renamed."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from smarig.core.errors import UsageError
from smarig.core.leftover import part_name


@contextlib.contextmanager
def new_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield an empty file beside ``path``; it becomes ``path`` if the block succeeds, and is deleted otherwise.

    Its name cannot be guessed and tells this process (``leftover``), and the name ``path`` survives a power cut. Raises
    UsageError if ``path`` is taken meanwhile (without ``force``) or is no file, and OSError.
    """
    check_regular(path)
    part = path.with_name(part_name(path.name))
    os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666))  # O_EXCL follows no link
    try:
        yield part
        check_regular(path)
        _rename(part, path, replace=force)
        _sync_folder(path.parent)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def check_regular(path: Path) -> None:
    """Raise UsageError if a name belongs to a device, a pipe or a socket, which a file must not replace."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise UsageError(f"{path} is not a regular file, so it is not replaced. Give another name.")


def _rename(part: Path, path: Path, *, replace: bool) -> None:
    taken = UsageError(f"{path} exists. Give another name, or --force to replace it.")
    try:
        if not replace:
            os.link(part, path)  # refuses a name that exists, unlike a renaming
            return
    except FileExistsError:
        raise taken from None
    except OSError:  # a file system without hard links
        if path.exists():
            raise taken from None
    part.replace(path)


def _sync_folder(folder: Path) -> None:
    if os.name == "nt":
        return
    with contextlib.suppress(OSError):  # some file systems cannot
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

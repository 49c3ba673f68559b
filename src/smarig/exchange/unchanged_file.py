"""Notices that a data file was changed or removed while it was read, so that no result mixes two states of it."""

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from smarig.core import DataError


class FileChangedError(DataError):
    """A data file was changed while it was read. This says nothing of its content, so it may be tried again."""


@contextlib.contextmanager
def unchanged(paths: Sequence[Path]) -> Iterator[None]:
    """Raise FileChangedError after the block if size or time of one of these files is another than before."""
    before = {path: _state(path) for path in paths}
    yield
    for path, state in before.items():
        if _state(path) != state:
            raise FileChangedError(
                f"{path} was changed while it was read. Copy it first if something still writes it, and repeat the "
                "command."
            )


def _state(path: Path) -> tuple[int, int, int] | None:
    """Identity, size and time of the last change; None if there is no such file."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns

"""Write a file completely or not at all: into a temporary file in the same folder, which is then renamed.

``force`` replaces only a file of the same kind. A wrong file name therefore never destroys a measurement.
"""

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from smarig.core.errors import StorageError, UsageError
from smarig.core.file_content import content_kind
from smarig.core.new_file import check_regular, new_file


@contextlib.contextmanager
def atomic_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield a path to write to. It becomes ``path`` if the block succeeds and is deleted otherwise.

    Raises the errors of ``check_writable`` and ``check_replaceable``, and StorageError if the disk is full.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, atomic_file(Path(folder) / "a.txt", force=False) as part:
    ...     _ = part.write_text("all of it")
    """
    check_writable(path, force=force)
    try:
        with new_file(path, force=force) as part:
            yield part
            check_replaceable(path, content_kind(part, path.name))
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None


def check_writable(path: Path, *, force: bool, kind: str = "") -> None:
    """Check before a long computation that its result of this ``kind`` (if known) can be written; make the folder.

    Raises UsageError if ``path`` is a folder, if it exists (without ``force``, or with another kind of content), or
    if its parent is not a folder. Raises StorageError if it cannot be written.
    """
    if path.is_dir():
        raise UsageError(f"{path} is a folder; name a file in it.")
    if path.exists() and not force:
        raise UsageError(f"{path} exists; give another name or --force to replace it.")
    check_regular(path)
    check_replaceable(path, kind)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except (FileExistsError, NotADirectoryError):
        raise UsageError(f"{path.parent} is not a folder; name a file inside one.") from None
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None


def check_replaceable(path: Path, kind: str) -> None:
    """Raise UsageError if the file holds content of another kind than ``kind``. An empty file may be replaced.

    Devices such as /dev/null are not read.
    """
    if not kind or not path.is_file():
        return
    try:
        existing_kind = content_kind(path)
    except OSError as error:
        raise StorageError(f"{path} cannot be read: {error.strerror or error}.") from None
    if existing_kind not in ("", kind):
        raise UsageError(
            f"{path} holds {existing_kind}, which --force does not replace by {kind}. Give another name."
        )

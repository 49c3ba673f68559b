"""A file written whole or not at all: beside its place first, then moved there.

With ``force`` it replaces another file of its kind only, so that a slip of the hand costs no measurement.
"""

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from smarig.core.errors import StorageError, UsageError
from smarig.core.file_content import content_kind


@contextlib.contextmanager
def atomic_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield the path to write to; it becomes ``path`` if the block ends well, and is gone if not.

    Raises what ``check_writable`` and ``check_replaceable`` do, and StorageError when the disk is full after all.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, atomic_file(Path(folder) / "a.txt", force=False) as part:
    ...     _ = part.write_text("all of it")
    """
    check_writable(path, force=force)
    part = path.with_name(path.name + ".part")
    try:
        yield part
        check_replaceable(path, content_kind(part, path.name))
        part.replace(path)
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def check_writable(path: Path, *, force: bool, kind: str = "") -> None:
    """Make a file's folder and try it, before hours are spent on what goes into it: something of ``kind``, if known.

    UsageError if ``path`` is a folder, exists (without ``force``, or as another kind), or lies in what is no
    folder; StorageError if it cannot be written.
    """
    if path.is_dir():
        raise UsageError(f"{path} is a folder; name a file in it.")
    if path.exists() and not force:
        raise UsageError(f"{path} exists; give another name or --force to replace it.")
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
    """UsageError where a file exists that holds something else than ``kind``; an empty one may become anything.

    A device such as /dev/null holds nothing, and is not read.
    """
    if not kind or not path.is_file():
        return
    try:
        existing_kind = content_kind(path)
    except OSError as error:
        raise StorageError(f"{path} cannot be read: {error.strerror or error}.") from None
    if existing_kind not in ("", kind):
        raise UsageError(
            f"{path} holds {existing_kind}, which --force does not replace by {kind}: give another name."
        )

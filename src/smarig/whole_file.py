"""A file written whole or not at all: beside its place first, then moved there. Knows no content."""

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from smarig.errors import StorageError, UsageError


@contextlib.contextmanager
def whole_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield the path to write to; it becomes ``path`` if the block ends well, and is gone if not.

    Raises what ``may_be_written`` does, and StorageError when the disk is full after all.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, whole_file(Path(folder) / "a.txt", force=False) as part:
    ...     _ = part.write_text("all of it")
    """
    may_be_written(path, force=force)
    part = path.with_name(path.name + ".part")
    try:
        yield part
        part.replace(path)
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def may_be_written(path: Path, *, force: bool) -> None:
    """Make a file's folder and try it, before hours are spent on what goes into it.

    UsageError if ``path`` is a folder, exists (without ``force``), or lies in what is no folder; StorageError
    if it cannot be written.
    """
    if path.is_dir():
        raise UsageError(f"{path} is a folder; name a file in it.")
    if path.exists() and not force:
        raise UsageError(f"{path} exists; give another name or --force to replace it.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except (FileExistsError, NotADirectoryError):
        raise UsageError(f"{path.parent} is not a folder; name a file inside one.") from None
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None

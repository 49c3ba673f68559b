"""A file written whole or not at all: beside its place first, then moved there. Knows no content."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from smarig.errors import StorageError, UsageError


@contextlib.contextmanager
def whole_file(path: Path, *, force: bool) -> Iterator[Path]:
    """Yield the path to write to; it becomes ``path`` if the block ends well, and is gone if not.

    UsageError if ``path`` is a folder, exists (without ``force``), or lies in what is no folder; StorageError
    if it cannot be written.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, whole_file(Path(folder) / "a.txt", force=False) as part:
    ...     _ = part.write_text("all of it")
    """
    if path.is_dir():
        raise UsageError(f"{path} is a folder; name a file in it.")
    if path.exists() and not force:
        raise UsageError(f"{path} exists; give another name or --force to replace it.")
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield part
        part.replace(path)
    except (FileExistsError, NotADirectoryError):
        raise UsageError(f"{path.parent} is not a folder; name a file inside one.") from None
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}.") from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)

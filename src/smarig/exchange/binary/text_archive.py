"""Unpacks the texts of a ZIP archive, as one of exported tables, within limits of size and into one folder."""

import codecs
import re
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from smarig.core import DataError, SmarigError, atomic_file
from smarig.exchange.binary.workbook_file import MAX_UNPACKED

MAX_PARTS = 1000
_HEAD = 4096  # bytes
_ENCRYPTED = 0x1
_LONGEST_NAME = 100
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_NO_NAME = re.compile(r"[^\w.-]+")
_OF_SYSTEM = "__MACOSX"


def is_text_archive(path: Path) -> bool:
    """Whether a file is a ZIP archive that holds a text; no workbook is one."""
    try:
        with _opened(path) as archive:
            names = archive.namelist()
            return "[Content_Types].xml" not in names and any(_texts(archive))
    except DataError:
        return False


def unpack_texts(path: Path, folder: Path) -> list[Path]:
    """Write the texts in an archive to ``folder``, each under a name without a path, and return the files.

    Archives within it and other files that are no texts stay packed. DataError for a damaged archive, or one of too
    many parts, or one that unpacks to more than a workbook may.
    """
    written: list[Path] = []
    with _opened(path) as archive:
        for part in _texts(archive):
            name = _NO_NAME.sub("_", "_".join(_places(part))).lstrip("._")[-_LONGEST_NAME:] or "text"
            taken = {file.name for file in written}
            file = folder / (name if name not in taken else f"{len(written)}_{name}")
            folder.mkdir(parents=True, exist_ok=True)
            content = archive.read(part)  # never more than the size that was checked
            with atomic_file(file, force=True) as target:
                target.write_bytes(content)
            written.append(file)
    return written


@contextmanager
def _opened(path: Path) -> Iterator[zipfile.ZipFile]:
    """The archive, checked."""
    try:
        with zipfile.ZipFile(path) as archive:
            parts = archive.infolist()
            unpacked = sum(part.file_size for part in parts)
            if unpacked > MAX_UNPACKED:
                raise DataError(
                    f"{path} unpacks to {unpacked / 1e6:.0f} MB, more than {MAX_UNPACKED // 10**6} MB. Split it."
                )
            if len(parts) > MAX_PARTS:
                raise DataError(f"{path} holds {len(parts)} files, more than {MAX_PARTS}. Split it.")
            yield archive
    except (SmarigError, OSError):  # of the archive, or of what is done with it: a full disk, for example
        raise
    except Exception as error:  # zipfile raises whatever a damaged directory leads to
        raise DataError(
            f"{path} is no ZIP archive that can be read ({type(error).__name__}). Unpack it and give the files in it."
        ) from None


def _texts(archive: zipfile.ZipFile) -> Iterator[zipfile.ZipInfo]:
    for part in archive.infolist():
        places = _places(part)
        hidden = any(place.startswith(".") for place in places) or _OF_SYSTEM in places
        if part.is_dir() or hidden or not part.file_size or part.flag_bits & _ENCRYPTED:
            continue
        with archive.open(part) as file:
            head = file.read(_HEAD)
        if head.startswith(_UTF_16) or (
            b"\0" not in head and not head.startswith((b"PK", b"%PDF", b"\x1f\x8b"))
        ):
            yield part


def _places(part: zipfile.ZipInfo) -> list[str]:
    """The folders of a part and its name, without those that lead up."""
    return [place for place in re.split(r"[\\/]", part.filename) if place not in ("", ".", "..")]

"""Data files of a study with those that an archive holds in its place, unpacked into the folder of the study."""

from collections.abc import Sequence
from pathlib import Path

from smarig.core import DataError, natural_order
from smarig.exchange import is_text_archive, unpack_texts
from smarig.study.data_files import tables_among

UNPACKED = "unpacked"


def with_unpacked(files: Sequence[Path], folder: Path) -> tuple[Path, ...]:
    """The files, with the tables of each archive of texts in its place; an archive without one stays, to be refused."""
    found: list[Path] = []
    for file in files:
        found += _tables_in(file, folder / UNPACKED / file.stem) or [file]
    return tuple(found)


def _tables_in(file: Path, folder: Path) -> list[Path]:
    if file.suffix.lower() != ".zip" or not is_text_archive(file):
        return []
    try:
        return natural_order(tables_among(unpack_texts(file, folder)))
    except DataError:  # a damaged part
        return []

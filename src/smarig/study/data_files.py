"""Which files of a folder may hold measurements: notes, programs and archives are left out and named."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.core import UsageError, check_file, leads_out, natural_order, pattern_order
from smarig.exchange import is_text_archive, logged_rows

MOST_FILES = 100_000
NOT_DATA = "not data, left out"
_OTHER_KINDS = (
    ".md",
    ".rst",
    ".py",
    ".m",
    ".html",
    ".htm",
    ".toml",
    ".yaml",
    ".yml",
    ".ini",
    ".gz",
)
_PACKED = (".zip", ".gz")
_TABLES = (".csv", ".tsv", ".dat", ".asc", ".json", ".jsonl", ".ndjson")
_TEXTS = ("", ".txt", ".text", ".log")
_ABOUT = re.compile(
    r"(read[ _-]?me|notes?|licen[cs]e|changelog|authors|copying|citation|liesmich)\b", re.IGNORECASE
)
_BETWEEN = re.compile(r"[\s,;|]+")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_FEWEST_ROWS, _READ_BYTES = 3, 1 << 16


@dataclass(frozen=True)
class FoundFiles:
    """Files in natural order: ``data`` may hold measurements, ``left_out`` do not."""

    data: tuple[Path, ...]
    left_out: tuple[Path, ...] = ()


def find_files(places: Sequence[Path]) -> FoundFiles:
    """The files given, and all in the given folders and below; hidden files are ignored.

    A file that is named is always used; a link in a folder that leads out of it is left out.
    Raises UsageError for a place that does not exist, or if nothing is left.
    """
    data: dict[Path, None] = {}
    left_out: dict[Path, None] = {}
    for place in pattern_order(places):
        if place.is_dir():
            for file in natural_order(p for p in place.rglob("*") if p.is_file() and not _hidden(p, place)):
                unused = leads_out(file, place) or _is_no_data(file)
                (left_out if unused else data)[file] = None
        else:
            check_file(place)
            data[place] = None
    if not data:
        packed = next((file for file in left_out if file.suffix.lower() in _PACKED), None)
        more = (
            f" Unpack {packed}: it holds no texts, or more than are read from an archive." if packed else ""
        )
        raise UsageError(f"There is no file with data in {', '.join(map(str, places))}.{more}")
    if len(data) > MOST_FILES:
        raise UsageError(f"These are {len(data)} files, more than {MOST_FILES}. Study a part of them.")
    return FoundFiles(tuple(data), tuple(file for file in left_out if file not in data))


def tables_among(files: Sequence[Path]) -> list[Path]:
    """The files of an archive that may hold measurements: of an unknown kind only if they begin with rows of numbers,
    as an archive may hold a program.
    """
    return [
        file
        for file in files
        if not _is_no_data(file) and (file.suffix.lower() in _TABLES or not _is_prose(file))
    ]


def _hidden(file: Path, place: Path) -> bool:
    return any(part.startswith(".") for part in file.relative_to(place).parts)


def _is_no_data(file: Path) -> bool:
    """Whether name or content of a file in a folder says that it is a text, a program or an archive."""
    kind = file.suffix.lower()
    if kind in _OTHER_KINDS or (kind == ".zip" and not is_text_archive(file)):
        return True
    return kind in _TEXTS and (_ABOUT.match(file.name) is not None or _is_prose(file))


def _is_prose(file: Path) -> bool:
    """Whether the beginning of a text holds hardly a row of numbers; a file that cannot be read is no prose."""
    try:
        with file.open("rb") as opened:
            start = opened.read(_READ_BYTES)
    except OSError:
        return False
    if not start.strip() or b"\0" in start:  # empty, binary or UTF-16: its reader says what is wrong with it
        return False
    lines = logged_rows(start.decode("utf-8", errors="replace").splitlines()).lines
    return sum(map(_is_row, lines)) < _FEWEST_ROWS


def _is_row(line: str) -> bool:
    cells = [cell for cell in _BETWEEN.split(line) if cell]
    numbers = sum(_NUMBER.fullmatch(cell) is not None for cell in cells)
    return numbers > 0 and 2 * numbers >= len(cells)

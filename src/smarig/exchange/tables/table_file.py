"""Reads a text table block by block, so that a file of millions of rows is never in memory as text.

This holds for the usual file: text in UTF-8 with one header, whose rows are ASCII. Every other file, and every error,
is left to ``read_whole_table``, whose messages name line and column.
"""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.exchange.layouts.clock_pairs import has_clock_pairs
from smarig.exchange.layouts.igor_text import is_igor_text
from smarig.exchange.layouts.long_table import is_long
from smarig.exchange.layouts.table_lines import MAX_LINE, check_lines
from smarig.exchange.tables import text_table
from smarig.exchange.tables.text_table import HEADER_WITHIN, Table, TableLayout
from smarig.exchange.text.no_reading import stands_for_none, without_marks
from smarig.exchange.text.number_blocks import numbers_of
from smarig.exchange.text.table_rows import begins_with_word
from smarig.exchange.text.text_cells import TextCells, texts_of

BLOCK_BYTES = 1 << 20
HEAD_BYTES = 1 << 20  # enough for the lines that are searched for the header
_BOM = b"\xef\xbb\xbf"
_OTHER_BREAKS = b"\x0b\x0c\x1c\x1d\x1e"  # str.splitlines breaks lines there too
_FIRST_TEXT = 9  # smaller bytes are in no text


class _UnusualError(Exception):
    """The file is none that can be read block by block."""


@dataclass(frozen=True)
class _Head:
    """The lines before the first row, the names of the columns, the delimiter, and the place of the first row."""

    preamble: list[str]
    names: list[str]
    delimiter: str | None
    line: int
    offset: int


def read_table(path: Path, layout: TableLayout) -> Table:
    """Read a text table; UsageError if the file does not exist, DataError with the line if it is not a table."""
    try:
        return _read_by_blocks(path, layout)
    except (_UnusualError, DataError, OSError, UnicodeDecodeError, csv.Error):
        return text_table.read_whole_table(path, layout)


def _read_by_blocks(path: Path, layout: TableLayout) -> Table:
    if (
        layout.header_starts
        or layout.clock
        or layout.interruptions != "refuse"
        or layout.no_reading  # they are counted in the whole table
        or path.stat().st_size > text_table.MAX_BYTES
    ):
        raise _UnusualError
    with path.open("rb") as file:
        head = _head(path, file, layout)
        notes = text_table.preamble_notes(head.preamble)
        most = _count_lines(file, head.offset)
        data, where = np.empty((len(head.names), most)), np.empty(most, dtype=np.int64)
        filled, line, texts = 0, head.line, dict[str, TextCells]()
        for block in _whole_lines(file, head.offset):
            if not block.endswith(b"\n"):
                block, dropped = _complete(block, head, line)
                notes += dropped
            columns, lines, texts = _parsed(path, block, head, layout, texts)
            rows = slice(filled, filled + lines.size)
            data[:, rows], where[rows] = columns, lines + line
            filled, line = rows.stop, line + block.count(b"\n")
    found = dict(zip(head.names, data[:, :filled], strict=True))
    if filled < 2 or any(np.isinf(column).any() or _has_marks(column) for column in found.values()):
        raise _UnusualError
    notes += text_table.missing_notes(found, texts=texts)
    return Table(found, where[:filled], text_table.preamble_keys(head.preamble), tuple(notes))


def _head(path: Path, file: BinaryIO, layout: TableLayout) -> _Head:
    data = file.read(HEAD_BYTES)
    complete = len(data) < HEAD_BYTES
    skipped = len(_BOM) if data.startswith(_BOM) else 0
    raw = data[skipped:].split(b"\n")[: HEADER_WITHIN + 1]
    if not complete and len(raw) <= HEADER_WITHIN:
        raise _UnusualError
    lines = [line.decode("utf-8").removesuffix("\r") for line in raw]
    if (
        is_igor_text(lines)
        or is_long(lines)
        or has_clock_pairs(lines)
        or next(filter(None, map(str.strip, lines)), "").startswith(("{", "["))
    ):
        raise _UnusualError
    if any(len(line.splitlines()) > 1 for line in lines) or min(b"".join(raw), default=0) < _FIRST_TEXT:
        raise _UnusualError
    start, names, delimiter = text_table.header(path, lines, layout)
    first = layout.first_row(start)
    offset = skipped + sum(len(line) + 1 for line in raw[:first])
    return _Head([line for line in lines[:start] if line.strip()], names, delimiter, first + 1, offset)


def _count_lines(file: BinaryIO, offset: int) -> int:
    """Number of lines from a place on, counting one without an end."""
    return 1 + sum(block.count(b"\n") for block in _whole_lines(file, offset))


def _whole_lines(file: BinaryIO, offset: int) -> Iterator[bytes]:
    """Blocks of lines from a place on; only the last line of a file may have no end."""
    file.seek(offset)
    while block := file.read(BLOCK_BYTES):
        yield block + (b"" if block.endswith(b"\n") else file.readline())


def _complete(block: bytes, head: _Head, line: int) -> tuple[bytes, list[str]]:
    """The end of a file whose last line has no end: the line is dropped if cells are missing."""
    rest, _, last = block.rpartition(b"\n")
    cells = text_table.split(last.decode("ascii"), head.delimiter)
    if len(cells) >= len(head.names):
        return block + b"\n", []
    if begins_with_word(cells):
        raise _UnusualError  # it may be a footer
    rest += b"\n" if rest else b""
    return rest, [text_table.incomplete_note(line + rest.count(b"\n"))]


def _parsed(
    path: Path, block: bytes, head: _Head, layout: TableLayout, texts: dict[str, TextCells]
) -> tuple[Sequence[Array] | Array, NDArray[np.int64], dict[str, TextCells]]:
    """The columns of a block, the numbers of their lines in it, from 0, and the texts in all blocks up to it."""
    numbers = numbers_of(block, len(head.names), head.delimiter, layout.decimal) if block else None
    if numbers is not None:
        return numbers.T, np.arange(len(numbers)), texts
    if not block.isascii() or _has_other_breaks(block) or min(block, default=_FIRST_TEXT) < _FIRST_TEXT:
        raise _UnusualError
    lines = block.decode("ascii").splitlines()
    check_lines(path, lines, MAX_LINE)
    if text_table.footer_start(lines, 0, len(head.names), head.delimiter, layout) is not None:
        raise _UnusualError  # it is told
    cells, where = text_table.cells(path, lines, 0, head.names, head.delimiter, False)
    if any(stands_for_none(cell) for row in cells for cell in row):
        raise _UnusualError  # the marks are counted in the whole table
    written = {name: [row[k] for row in cells] for k, name in enumerate(head.names)}
    columns = {name: layout.column(path, name, column, where) for name, column in written.items()}
    texts = texts_of(columns, written, {}, texts)
    return [*columns.values()], np.array(where, dtype=np.int64) - 1, texts


def _has_marks(column: Array) -> bool:
    """Whether a column holds numbers that stand for no reading."""
    return np.isnan(without_marks(column)).sum() > np.isnan(column).sum()


def _has_other_breaks(block: bytes) -> bool:
    return any(byte in block for byte in _OTHER_BREAKS) or block.count(b"\r") != block.count(b"\r\n")

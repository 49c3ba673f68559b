"""The lines of a text as those of tables with one row for each instant, whatever stands for rows in the file."""

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from smarig.core import DataError
from smarig.exchange.layouts.channel_rows import channel_rows
from smarig.exchange.layouts.clock_pairs import clock_pairs, has_clock_pairs
from smarig.exchange.layouts.json_document import json_document
from smarig.exchange.layouts.key_cells import key_cells
from smarig.exchange.layouts.logged_rows import LoggedRows, logged_rows
from smarig.exchange.layouts.long_rows import long_rows
from smarig.exchange.layouts.long_table import is_long
from smarig.exchange.layouts.stacked_channels import stacked_channels
from smarig.exchange.layouts.unit_cells import has_unit_cells, joined_cells, unit_cells
from smarig.exchange.text.table_rows import split

MAX_LINE = 1_000_000  # characters: 10 000 columns of 100
_HEAD = 250  # rows of a sheet by which it is taken for one of another layout
_PLUS_APART = re.compile(r"(?<!\S)\+ +(?=[\d.])")
_SIGN_APART = re.compile(r"(?<!\S)([+-]) +(?=[\d.])")


def table_lines(path: Path, text: str) -> LoggedRows:
    """The lines of a text as those of tables, whatever stands for rows; DataError for a line that is too long, and for
    readings that cannot be brought into columns.
    """
    if document := json_document(text):
        return LoggedRows(*document)
    lines = text.splitlines()
    check_lines(path, lines, MAX_LINE)
    if any(map(_PLUS_APART.search, lines)):  # nobody writes a plus for a missing value
        lines = [_SIGN_APART.sub(r"\1", line) for line in lines]
    return _rewritten(path, logged_rows(lines))


def sheet_rows(path: Path, rows: Sequence[Sequence[str]]) -> tuple[list[list[str]], tuple[str, ...]]:
    """The rows of a sheet as those of tables, as for the lines of a text, and what was done."""
    head = [joined_cells(row, "\t") for row in rows[:_HEAD]]
    if not (has_clock_pairs(head) or is_long(head) or has_unit_cells(head)):
        return [list(row) for row in rows], ()
    found = _rewritten(path, LoggedRows([joined_cells(row, "\t") for row in rows]))
    return [split(line, "\t") for line in found.lines], found.notes


def _rewritten(path: Path, found: LoggedRows) -> LoggedRows:
    """Lines with one row for each instant, and plain numbers in their cells."""
    for rewrite in (
        key_cells,
        partial(stacked_channels, path),
        partial(clock_pairs, path),
        channel_rows,
        partial(long_rows, path, added=found.added),
        partial(unit_cells, path),
    ):
        later = rewrite(found.lines)
        found = LoggedRows(later.lines, (*found.notes, *later.notes), found.added + later.added)
    return found


def check_lines(path: Path, lines: Sequence[str], longest: int) -> None:
    """Raise DataError for a line that is too long for a table of numbers."""
    for k, line in enumerate(lines):
        if len(line) > longest:
            raise DataError(
                f"{path}, line {k + 1} has {len(line)} characters; a line of a table has at most {longest}."
            )

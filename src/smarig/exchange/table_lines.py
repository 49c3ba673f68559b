"""The lines of a text as those of tables with one row for each instant, whatever stands for rows in the file."""

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from smarig.core import DataError
from smarig.exchange.channel_rows import channel_rows
from smarig.exchange.clock_pairs import clock_pairs
from smarig.exchange.json_document import json_document
from smarig.exchange.logged_rows import LoggedRows, logged_rows
from smarig.exchange.long_rows import long_rows
from smarig.exchange.unit_cells import unit_cells

MAX_LINE = 1_000_000  # characters: 10 000 columns of 100
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
    found = logged_rows(lines)
    for rewritten in (
        partial(clock_pairs, path),
        channel_rows,
        partial(long_rows, path),
        partial(unit_cells, path),
    ):
        later = rewritten(found.lines)
        found = LoggedRows(later.lines, (*found.notes, *later.notes), found.added + later.added)
    return found


def check_lines(path: Path, lines: Sequence[str], longest: int) -> None:
    """Raise DataError for a line that is too long for a table of numbers."""
    for k, line in enumerate(lines):
        if len(line) > longest:
            raise DataError(
                f"{path}, line {k + 1} has {len(line)} characters; a line of a table has at most {longest}."
            )

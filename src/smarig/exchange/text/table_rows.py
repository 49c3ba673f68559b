"""The rows of a text table: the cells of its lines, and where a footer ends it."""

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from smarig.core import DataError
from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.clock_cells import clock_seconds
from smarig.exchange.text.interruptions import names_columns
from smarig.exchange.text.no_reading import is_missing

_MAY_BE_PADDED = re.compile(r"[+-] ")
_PADDED = re.compile(r"^([+-])\s+(?=[\d.,])")  # a number whose sign and digits are aligned


class Signs(Protocol):
    """How a table writes numbers: decimal sign, and what stands between thousands."""

    @property
    def decimal(self) -> str: ...

    @property
    def thousands(self) -> str: ...


def split(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line, stripped of blanks and quotes, without trailing empty cells.

    >>> split("+   20.1;-  0.5 ;", ";")
    ['+20.1', '-0.5']
    """
    if delimiter is None:
        cells = line.split()
    elif '"' in line:
        cells = next(csv.reader(io.StringIO(line), delimiter=delimiter, skipinitialspace=True), [])
    else:
        cells = line.split(delimiter)
    cells = [cell.strip() for cell in cells]
    if delimiter is not None and _MAY_BE_PADDED.search(line):
        cells = [_PADDED.sub(r"\1", cell) for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def cells(
    path: Path,
    lines: Sequence[str],
    first: int,
    names: Sequence[str],
    delimiter: str | None,
    ends_blank: bool,
    again: str = "",
) -> tuple[list[list[str]], list[int]]:
    """The cells of the rows from line ``first`` on, and the number of each line, from 1; ``again``: a header that a
    logger may have written once more.
    """
    rows: list[list[str]] = []
    where: list[int] = []
    for k in range(first, len(lines)):
        line = lines[k]
        if not line.strip():
            if ends_blank:
                break
            continue
        if line.startswith("#") or (again and line.strip() == again.strip()):
            continue
        row = split(line, delimiter)
        if ends_blank and not any(is_number(cell, ".") or is_number(cell, ",") for cell in row):
            break  # a title of the next table
        missing = len(names) - len(row)
        if missing < 0 or (delimiter is None and missing > 0):
            raise DataError(
                f"{path}, line {k + 1} has {len(row)} cells, but the header names {len(names)} columns."
            )
        rows.append(row + [""] * missing)
        where.append(k + 1)
    return rows, where


def without_interruptions(
    lines: Sequence[str], first: int, width: int, delimiter: str | None, signs: Signs, *, ends: bool
) -> tuple[list[str], list[str]]:
    """The lines with a comment sign in place of each line of text between rows from ``first`` on, and those texts.

    ``ends``: names of columns, or a row of another width, begin another table, and blank lines do not end this one.
    """
    out, texts = list(lines), list[str]()
    waiting: list[int] = []  # lines since the last row: a footer is none between rows
    for k in range(first, len(lines)):
        row = split(lines[k], delimiter)
        if _mostly_numbers(row, signs):
            if ends and len(row) != width:
                break
            texts += [lines[i] for i in waiting if lines[i].strip()]
            for i in waiting:
                out[i] = "#" if ends or lines[i].strip() else ""
            waiting = []
        elif ends and row and names_columns(row, lines[k], width):
            break
        elif not lines[k].startswith("#"):
            waiting.append(k)
    return out, texts


def footer_start(
    lines: Sequence[str], first: int, width: int, delimiter: str | None, signs: Signs
) -> int | None:
    """The line, from 0, at which a text after the last row begins, as "Results:" does; None for a table up to the end.

    Such a text begins with words that are not divided as rows are, or its rows begin with a word where the first row
    has a value, as those of statistics do; no other row is mostly numbers after it.
    """
    model = next((row for line in lines[first:] if (row := split(line, delimiter))), [])
    k = len(lines)
    while k > first and not _is_row(split(lines[k - 1], delimiter), model, signs):
        k -= 1
    start = next((i for i in range(k, len(lines)) if lines[i].strip()), len(lines))
    if k <= first or start == len(lines) or lines[start].startswith("#"):
        return None
    row = split(lines[start], delimiter)
    if is_labelled(row, model, signs):
        return start
    divided = len(row) == width if delimiter is None else len(row) > 1
    return None if divided or not row or _is_value(row[0], signs) else start


def is_plain_row(row: Sequence[str], signs: Signs) -> bool:
    """Whether the cells of a row are numbers, or clock times beside them."""
    numbers = [is_number(cell, signs.decimal, signs.thousands) for cell in row]
    return any(numbers) and all(n or clock_seconds(cell) is not None for n, cell in zip(numbers, row))


def rows_end(rows: Sequence[Sequence[str]], first: int, signs: Signs) -> int:
    """The row after the last one of a table: rows of statistics below it are none of its own, nor are rows of texts."""
    k = len(rows)
    while k > first and (not _has_value(rows[k - 1], signs) or is_labelled(rows[k - 1], rows[first], signs)):
        k -= 1
    return k if k > first else len(rows)


def _has_value(row: Sequence[str], signs: Signs) -> bool:
    return any(cell and _is_value(cell, signs) for cell in row)


def is_labelled(row: Sequence[str], model: Sequence[str], signs: Signs) -> bool:
    """Whether the first filled cell of a row is a word, while the row ``model`` has a value there."""
    j = next((j for j, cell in enumerate(row) if cell), len(model))
    return j < len(model) and bool(model[j]) and _is_value(model[j], signs) and not _is_value(row[j], signs)


def is_incomplete(row: Sequence[str], first: Sequence[str], names: Sequence[str], signs: Signs) -> bool:
    """Whether the last line of a file, which has no end, lacks cells; words below the ``first`` row are a footer."""
    return len(row) < len(names) and not (begins_with_word(row) and is_labelled(row, first, signs))


def begins_with_word(row: Sequence[str]) -> bool:
    """Whether the first cell begins with a word: one with digits may be a clock time that is cut."""
    words = row[0].split() if row else []
    return bool(words) and not any(sign.isdigit() for sign in words[0])


def _is_row(row: Sequence[str], model: Sequence[str], signs: Signs) -> bool:
    return _mostly_numbers(row, signs) and not is_labelled(row, model, signs)


def _mostly_numbers(row: Sequence[str], signs: Signs) -> bool:
    used = [cell for cell in row if cell]
    return len(row) > 1 and 2 * sum(_is_value(cell, signs) for cell in used) > len(used)


def _is_value(cell: str, signs: Signs) -> bool:
    """Whether a cell is a number, a clock time or a word for a missing value."""
    return (
        is_number(cell, signs.decimal, signs.thousands) or is_missing(cell) or clock_seconds(cell) is not None
    )

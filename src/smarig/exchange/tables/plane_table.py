"""A table of values over the Preisach plane: a matrix with levels along both edges, or columns alpha, beta and value.

Such a file is no record of an input and an output. It is recognised by its structure: the first row and the first
column of a matrix are the same rising levels, or three columns hold every pair of levels with α ≥ β (or α > β) once.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, UsageError
from smarig.exchange.tables.text_table import DELIMITERS, HEADER_WITHIN, read_text, split
from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.no_reading import is_missing

_FEWEST_LEVELS = 3
_MOST_LEVELS = 1000  # those of a table in a model file
_LARGEST_BYTES = 32 * _MOST_LEVELS**2
_COMMENTS = ("#", "%")
_ALPHA = re.compile(r"(?:alpha|α|a)\b", re.IGNORECASE)
_BETA = re.compile(r"(?:beta|β|b)\b", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class PlaneTable:
    """``values[i, j]`` at (α, β) = (levels[i], levels[j]), NaN where the file has none; levels (n,) rise strictly.

    ``words`` is what the file says of the values: their name, or corner cell and comments. ``level_name`` is the name
    of the first column, "" for a matrix.
    """

    levels: Array
    values: Array
    words: str
    level_name: str = ""


def plane_table(path: Path) -> PlaneTable | None:
    """The table over the Preisach plane in a text file; None for any other file."""
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            return None
        lines = [line for line in read_text(path)[0].splitlines() if line.strip()]
    except (DataError, UsageError, OSError):
        return None
    for delimiter in DELIMITERS.values():
        if (found := _matrix(lines, delimiter) or _columns(lines, delimiter)) is not None:
            return found
    return None


def _matrix(lines: Sequence[str], delimiter: str | None) -> PlaneTable | None:
    """A matrix whose first row and first column are the same levels, below lines of comment."""
    comments = [line for line in lines[:HEADER_WITHIN] if line.startswith(_COMMENTS)]
    size = len(lines) - len(comments) - 1
    if not _FEWEST_LEVELS <= size <= _MOST_LEVELS:
        return None
    rows = [_cells(line, delimiter) for line in lines if not line.startswith(_COMMENTS)]
    if len(rows[0]) not in (size, size + 1) or any(len(row) > size + 1 for row in rows):
        return None
    across, down = _numbers(rows[0][-size:]), _numbers([row[0] for row in rows[1:]])
    if across is None or down is None or not np.array_equal(across, down) or not (np.diff(across) > 0).all():
        return None
    values = [_numbers([*row[1:], *[""] * (size + 1 - len(row))]) for row in rows[1:]]
    if any(row is None for row in values):
        return None
    corner = rows[0][0] if len(rows[0]) > size else ""
    return PlaneTable(across, np.array(values), " ".join([corner, *comments]))


def _columns(lines: Sequence[str], delimiter: str | None) -> PlaneTable | None:
    """Columns named alpha, beta and a value, with every pair of levels of a triangle, or of the square, once."""
    heads = [_cells(line.lstrip("#% "), delimiter) for line in lines[:HEADER_WITHIN]]
    first = next(
        (k for k, c in enumerate(heads) if len(c) == 3 and _ALPHA.match(c[0]) and _BETA.match(c[1])), None
    )
    numbers = [_numbers(_cells(line, delimiter)) for line in lines[first + 1 :]] if first is not None else []
    if first is None or not numbers or any(row is None or row.size != 3 for row in numbers):
        return None
    a, b, z = np.array(numbers).T
    levels = np.unique(np.concatenate([a, b]))
    size = levels.size
    counts = (size * (size + 1) // 2, size * (size - 1) // 2, size**2)
    if not (_FEWEST_LEVELS <= size <= _MOST_LEVELS and a.size in counts):
        return None
    values = np.full((size, size), np.nan)
    values[np.searchsorted(levels, a), np.searchsorted(levels, b)] = z
    return (
        PlaneTable(levels, values, heads[first][2], heads[first][0])
        if np.isfinite(values).sum() == a.size
        else None
    )


def _cells(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line, also the empty ones at its end."""
    found = split(line, delimiter)
    return found if delimiter is None else found + [""] * (line.count(delimiter) + 1 - len(found))


def _numbers(cells: Sequence[str]) -> Array | None:
    """The numbers of cells (n,), NaN for missing ones; None if one of them is a text."""
    if not all(not cell or is_missing(cell) or is_number(cell, ".") for cell in cells):
        return None
    return np.array([float(cell) if is_number(cell, ".") else np.nan for cell in cells])

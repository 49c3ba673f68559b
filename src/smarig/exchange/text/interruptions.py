"""Lines of text between the rows of one table, such as the titles of segments: no names of columns, and no values.

A table goes on below them if its rows have the same columns. What names the columns of another table ends it.
"""

import re
from collections.abc import Sequence

from smarig.core import shown
from smarig.exchange.text.header_words import ALIGNED, with_brackets_joined
from smarig.exchange.units.written_units import is_unit, is_units_row

_VALUE = re.compile(r"[+-]?\d+(?:[.,]\d+)?\s*(\S*)")
_MOST_SHOWN = 3


def names_columns(row: Sequence[str], line: str, width: int) -> bool:
    """Whether a row of text may hold the names or units of as many columns. Values are no names, and a sentence has
    more words than a table has columns.

    >>> names_columns(["Time", "Force"], "Time,Force", 2), names_columns(["Weight:", "12.3 mg"], "Weight:\\t12.3 mg", 2)
    (True, False)
    >>> sentence = "Cool from 120.0 °C"
    >>> names_columns(sentence.split(), sentence, 2), names_columns(["2) Cool"], "2) Cool", 2)
    (False, False)
    """
    if any(_is_value(cell) for cell in row):
        return False
    if is_units_row(row):
        return True
    if len(row) > 1 and list(row) == line.split():  # blanks divide words of a sentence, too
        return width in (len(row), len(with_brackets_joined(row)), len(re.split(ALIGNED, line.strip())))
    return len(row) >= width or len(re.split(ALIGNED, line.strip())) == width


def interruption_notes(lines: Sequence[str]) -> list[str]:
    """A finding on the lines between rows that were left out."""
    different = list(dict.fromkeys(line.strip() for line in lines))
    if not different:
        return []
    listed = ", ".join(shown(line, 40) for line in different[:_MOST_SHOWN])
    more = ", …" if different[_MOST_SHOWN:] else ""
    number = len(lines)
    were = (
        "1 line of text between the rows was"
        if number == 1
        else f"{number} lines of text between the rows were"
    )
    return [f"{were} left out: {listed}{more}."]


def _is_value(cell: str) -> bool:
    match = _VALUE.fullmatch(cell.strip())
    return match is not None and (not match[1] or is_unit(match[1]))

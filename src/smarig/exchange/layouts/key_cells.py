"""Keys and values in cells to the left of the readings, as oscilloscopes write them: they are lines above the table.

``Record Length,2500,,-0.1,0.08`` is a reading (−0.1, 0.08) beside a key with its value. Below the last key, the cells
to the left are empty.
"""

import csv
import io
from collections.abc import Sequence

from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.text.cell_values import is_number

_SIGNS = (",", "\t", ";")
_FEWEST = 3  # rows of a table
_NOTE = "Cells to the left of the readings hold keys and values; they are read as lines before the table."


def key_cells(lines: Sequence[str]) -> LoggedRows:
    """The lines of a text whose keys stand beside its readings, with the keys above them; other texts as they are."""
    last = next((line.strip(" ") for line in reversed(lines) if line.strip()), "")
    for sign in _SIGNS:
        empty_at_last = last.startswith((sign, f'""{sign}'))  # of most texts, no more needs to be read
        if empty_at_last and sign in lines[0] and (found := _parted(_rows(lines, sign))):
            keys, readings = found
            above = [sign.join(cell for cell in row if cell) for row in keys]
            above += [sign.join(_names(keys, len(readings[0])))]
            return LoggedRows([*above, *(sign.join(row) for row in readings)], (_NOTE,), len(above))
    return LoggedRows(list(lines))


def _rows(lines: Sequence[str], sign: str) -> list[list[str]]:
    """The cells of the lines that are not blank; all of one width, or none."""
    rows = [
        [cell.strip() for cell in row] for row in csv.reader(io.StringIO("\n".join(lines)), delimiter=sign)
    ]
    return rows if rows and all(len(row) == len(rows[0]) for row in rows) else []


def _parted(rows: list[list[str]]) -> tuple[list[list[str]], list[list[str]]] | None:
    """The keys and the readings of rows; None if there are no keys beside readings."""
    if len(rows) < _FEWEST or not rows[0][0] or rows[-1][0]:
        return None
    first = next((j for j, cell in enumerate(rows[-1]) if cell), 0)
    width = max(j + 1 for j, cell in enumerate(rows[-1]) if cell) if any(rows[-1]) else 0
    readings = [row[first:width] for row in rows]
    keys = [row[:first] for row in rows if row[0]]
    if first < 2 or width - first < 2 or any(is_number(row[0], ".") for row in keys):
        return None
    return (keys, readings) if all(is_number(cell, ".") for row in readings for cell in row) else None


def _names(keys: Sequence[Sequence[str]], width: int) -> list[str]:
    """The names of the readings: of the horizontal axis, and of the source of a single channel, if keys state them."""
    known = {row[0].lower(): row[1] for row in keys if len(row) > 1}
    names = [f"column {k + 1}" for k in range(width)]
    if any(key.startswith("horizontal") for key in known):
        names[0] = "Horizontal"
    if width == 2 and known.get("source"):
        names[1] = known["source"]
    return names

"""Names in several levels above a row with the name of the index, as pandas writes columns of a MultiIndex."""

from collections.abc import Sequence
from dataclasses import dataclass

from smarig.exchange.tables.found_table import TEXT
from smarig.exchange.tables.number_style import NumberStyle
from smarig.exchange.units.written_units import is_unit, is_units_row


@dataclass(frozen=True)
class ColumnLevels:
    """The row of the first level, and the names and units of all columns; units are "" where no level holds them."""

    row: int
    names: list[str]
    units: list[str]


def column_levels(
    rows: Sequence[Sequence[str]], kinds: Sequence[str], first: int, width: int, style: NumberStyle
) -> ColumnLevels | None:
    """The levels over the name of the index, which stands alone directly above the first row of numbers.

    Each level begins with its own name, or none does; one may hold the units. A single level of names has groups: else
    the lone cell is a title below an ordinary row of names.
    """
    index = first - 1
    if index < 2 or kinds[index] != "text" or len(rows[index]) != 1:
        return None
    begin = index
    while begin > 0 and kinds[begin - 1] == "text" and _is_level(rows[begin - 1], width):
        begin -= 1
    levels = [[*row, *[""] * width][:width] for row in rows[begin:index]]
    named = [bool(level[0]) for level in levels]
    if len(levels) < 2 or len(set(named)) > 1 or any(is_unit(level[0]) for level in levels):
        return None
    units = next((level for level in levels if is_units_row(level[1:])), None)
    others = [level[1:] for level in levels if level is not units]
    grouped = len(others) > 1 or len(set(others[0])) < width - 1
    if not grouped or any(style.kind(cell) != TEXT for level in others for cell in level if cell):
        return None
    names = [" ".join(dict.fromkeys(filter(None, parts))) for parts in zip(*others)]
    if not all(names):
        return None
    return ColumnLevels(begin, [rows[index][0], *names], ["", *units[1:]] if units else [""] * width)


def _is_level(row: Sequence[str], width: int) -> bool:
    return len(row) <= width < 2 * sum(map(bool, row))

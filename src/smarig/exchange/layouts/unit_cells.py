"""Cells that carry their unit, as "23.4 °C" or "850 µm" of a dashboard: the number stays in the cell, and the unit is
that of the column. Units of one quantity within a column are converted to the most frequent of them.
"""

import csv
import io
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from smarig.core import DataError, shown
from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.no_reading import is_missing
from smarig.exchange.text.table_rows import split
from smarig.exchange.units.unit_conversion import convert, dimension
from smarig.exchange.units.written_units import known_unit

_FEWEST = 3  # rows of a table
_SAMPLE = 250  # lines by which a text is taken for one with units in its cells
_SIGNS = ("\t", ";", ",")
_NUMBER = (
    r"[+-]?(?:\d{1,3}(?:,\d{3})+(?:\.\d*)?|\d{1,3}(?:\.\d{3})+,\d*|\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
)
_CELL = re.compile(rf"({_NUMBER})(\s*)([^\W\d_]\S*|[%‰°]\S*)")
_OWN_UNIT = re.compile(r"\s*[\[(]([^\[\]()]*)[\])]\s*$")


@dataclass(frozen=True)
class _Quantity:
    """A cell's number as it is written, and its unit: as written, and in the known spelling, "" if it is unknown."""

    number: str
    written: str
    unit: str


@dataclass(frozen=True)
class _UnitColumn:
    """A column of quantities: its place, its unit as written and as known, and the converted cells by their unit."""

    place: int
    written: str
    unit: str
    converted: tuple[tuple[str, int], ...]


def has_unit_cells(lines: Sequence[str]) -> bool:
    """Whether some cells near the beginning carry units."""
    return bool(_sign(lines[:_SAMPLE]))


def unit_cells(path: Path, lines: Sequence[str]) -> LoggedRows:
    """The lines of a text without the units in their cells, which stand behind the names; other texts as they are.

    DataError with line and column for a cell that cannot be converted to the unit of its column.
    """
    sign = _sign(lines[:_SAMPLE])
    if not sign:
        return LoggedRows(list(lines))
    rows = [split(line, sign) for line in lines]
    first = _first(rows)
    heading = _heading(rows, first)
    if heading is None and first > 0:  # no place for names
        return LoggedRows(list(lines))
    names = rows[heading] if heading is not None else [f"column {k + 1}" for k in range(len(rows[first]))]
    places = [
        j for j in range(len(rows[first])) if _carries_units([row[j] for row in rows[first:] if j < len(row)])
    ]
    columns = [_column(path, rows, first, j, names[j]) for j in places if j < len(names)]
    if not columns:
        return LoggedRows(list(lines))
    decimal = _decimal(rows[first:], columns)
    out = [*lines[:first], *(_without_units(row, columns, decimal, sign) for row in rows[first:])]
    header = joined_cells(_with_units(names, columns), sign)
    if heading is not None:
        out[heading] = header
    return LoggedRows(
        out if heading is not None else [header, *out], _notes(names, columns), int(heading is None)
    )


def _sign(sample: Sequence[str]) -> str:
    """The sign between cells of which most carry a unit; "" for a text without such cells."""
    able = [line for line in sample if _CELL.search(line)]
    found = {
        sign: sum(_quantity(c) is not None for line in able for c in split(line, sign)) for sign in _SIGNS
    }
    divided = {sign: n for sign, n in found.items() if n >= _FEWEST and any(sign in line for line in able)}
    return max(divided, key=lambda sign: divided[sign], default="")


def is_quantity(cell: str) -> bool:
    """Whether a cell is a number with a unit behind it.

    >>> is_quantity("850 µm"), is_quantity("41%"), is_quantity("850"), is_quantity("7x")
    (True, True, False, False)
    """
    return _quantity(cell) is not None


def _quantity(cell: str) -> _Quantity | None:
    """A number with a unit behind it; one that is not known counts only behind a blank."""
    match = _CELL.fullmatch(cell)
    if match is None:
        return None
    unit = _known(match[3])
    return _Quantity(match[1], match[3], unit) if unit or match[2] else None


@lru_cache(maxsize=1024)  # a file has few units and many cells
def _known(written: str) -> str:
    return known_unit(written)


def _carries_units(cells: Sequence[str]) -> bool:
    """Whether most cells that are filled are quantities; texts with several words that are no units are none."""
    filled = [cell for cell in cells if not is_missing(cell)]
    found = [quantity for cell in filled if (quantity := _quantity(cell))]
    units = any(quantity.unit for quantity in found) or len({quantity.written for quantity in found}) == 1
    return len(found) >= _FEWEST and 2 * len(found) > len(filled) and units


def _first(rows: Sequence[Sequence[str]]) -> int:
    """The first row of quantities that is as wide as most of them: lines before a table may hold quantities, too."""
    able = {k: len(row) for k, row in enumerate(rows) if any(map(_quantity, row))}
    width = Counter(able.values()).most_common(1)[0][0]
    return next(k for k, cells in able.items() if cells == width)


def _heading(rows: Sequence[Sequence[str]], first: int) -> int | None:
    """The nearest row above the first row of quantities that is as wide, and holds no number."""
    for k in range(first - 1, -1, -1):
        if len(rows[k]) >= len(rows[first]) and not any(
            is_number(c, ".") or is_number(c, ",") for c in rows[k]
        ):
            return k
    return None


def _column(path: Path, rows: Sequence[Sequence[str]], first: int, j: int, name: str) -> _UnitColumn:
    """The unit of a column of quantities; DataError for a cell that has none, or one of another quantity."""
    found = {
        k: _quantity(row[j])
        for k, row in enumerate(rows[first:], first)
        if j < len(row) and not is_missing(row[j])
    }
    times = Counter((q.unit or q.written) for q in found.values() if q)
    unit = _usual_unit(times)
    able = {u for u in times if dimension(u) == dimension(unit)}
    for k, quantity in found.items():
        cell = rows[k][j]
        plain = quantity is None and (is_number(cell, ".") or is_number(cell, ","))
        other = quantity is not None and (quantity.unit or quantity.written) not in able
        if plain or other:
            why = "has no unit" if plain else f"cannot be converted to {unit}"
            raise DataError(
                f"{path}, line {k + 1}, column {shown(name)}: {shown(cell, 40)} {why}, but this column holds "
                f"quantities in {unit}. Write the column in one unit."
            )
    written = Counter(q.written for q in found.values() if q and (q.unit or q.written) == unit)
    others = tuple((u, n) for u, n in times.items() if u != unit)
    return _UnitColumn(j, written.most_common(1)[0][0], unit, others)


def _usual_unit(times: Counter[str]) -> str:
    """The most frequent unit of the most frequent quantity, a known one if any is."""
    known = Counter({unit: number for unit, number in times.items() if known_unit(unit)}) or times
    quantities = Counter[str]()
    for unit, number in known.items():
        quantities[dimension(unit)] += number
    usual = quantities.most_common(1)[0][0]
    return next(unit for unit, _ in known.most_common() if dimension(unit) == usual)


def _decimal(rows: Sequence[Sequence[str]], columns: Sequence[_UnitColumn]) -> str:
    """The decimal sign of the quantities: the last sign in numbers that have two, else a comma if none has a point."""
    cells = (row[c.place] for row in rows for c in columns if c.place < len(row))
    numbers = [q.number for cell in cells if (q := _quantity(cell))]
    last = {max(".,", key=number.rfind) for number in numbers if "." in number and "," in number}
    plain = any("," in number for number in numbers) and not any("." in number for number in numbers)
    return "," if plain or last == {","} else "."


def _without_units(row: Sequence[str], columns: Sequence[_UnitColumn], decimal: str, sign: str) -> str:
    cells = list(row)
    for column in columns:
        quantity = _quantity(cells[column.place]) if column.place < len(cells) else None
        if quantity is not None:
            same = (quantity.unit or quantity.written) == column.unit
            cells[column.place] = quantity.number if same else _converted(quantity, column.unit, decimal)
    return joined_cells(cells, sign)


def _converted(quantity: _Quantity, unit: str, decimal: str) -> str:
    thousands = "." if decimal == "," else ","
    plain = quantity.number.replace(thousands, "").replace(",", ".")
    value = convert(float(plain), quantity.unit, unit)
    text = np.format_float_positional(float(f"{value:.12g}"), trim="0")  # factors are exact, products are not
    return text.replace(".", decimal)


def _with_units(names: Sequence[str], columns: Sequence[_UnitColumn]) -> list[str]:
    """The names, with the units of the columns in place of those that they state."""
    out = list(names)
    for column in columns:
        stated = _OWN_UNIT.search(out[column.place])
        name = out[column.place][: stated.start()] if stated and known_unit(stated[1]) else out[column.place]
        out[column.place] = f"{name or f'column {column.place + 1}'} [{column.written}]"
    return out


def joined_cells(cells: Sequence[str], sign: str) -> str:
    """A line of cells, with quotation marks where a cell holds the sign between them."""
    out = io.StringIO()
    csv.writer(out, delimiter=sign, lineterminator="").writerow(cells)
    return out.getvalue()


def _notes(names: Sequence[str], columns: Sequence[_UnitColumn]) -> tuple[str, ...]:
    notes = ["The cells carry their units; they are the units of the columns."]
    for column in columns:
        if column.converted:
            which = " and ".join(f"{number} cells in {unit}" for unit, number in column.converted)
            notes.append(f"Column {shown(names[column.place])} is in {column.unit}: {which} are converted.")
    return tuple(notes)

"""What lines before a table state of its columns: a list of channels with units, or units by words of names."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from smarig.exchange.layouts.unit_cells import is_quantity
from smarig.exchange.text.cell_values import is_number_with_any_sign
from smarig.exchange.text.header_words import UNIT_WORD
from smarig.exchange.units.units import UNITS
from smarig.exchange.units.written_units import known_unit

_UNIT = re.compile(rf"(?:[\w.]+[ _-])?(?:{UNIT_WORD.pattern})", re.IGNORECASE)
_STATED = re.compile(rf".*\b(?:{UNIT_WORD.pattern})\b[^:=]*[:=]\s*(.+)", re.IGNORECASE)
_PART = re.compile(r"(\w.*?)\s*(?:[\s:=]|\bin\b)\s*[\[(]?([^\s\[\]()]+)[\])]?")
_WORD = re.compile(r"\w+")
_FEWEST = 2  # columns that a list names


@dataclass(frozen=True)
class StatedColumns:
    """The units of columns as lines before the table write them, and what else they say of each, "" for nothing."""

    units: tuple[str, ...]
    comments: tuple[str, ...]


def stated_columns(
    names: Sequence[str], lines: Sequence[str], rows: Sequence[Sequence[str]]
) -> StatedColumns:
    """What ``lines`` before a table, whose cells are ``rows``, state of the columns with these names."""
    listed = _listed(names, rows)
    by_words = next((units for line in lines if any(units := _by_words(names, line))), [""] * len(names))
    units = (listed[name][0] if name in listed else unit for name, unit in zip(names, by_words))
    return StatedColumns(tuple(units), tuple(listed.get(name, ("", ""))[1] for name in names))


def _listed(names: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, tuple[str, str]]:
    """Units and comments by name, from a table with a column of names and a column that is headed as one of units."""
    for k, head in enumerate(rows):
        unit = next((j for j, cell in enumerate(head) if _UNIT.fullmatch(cell)), None)
        if unit is None or len(head) < _FEWEST:
            continue
        end = next((i for i in range(k + 1, len(rows)) if not 0 < len(rows[i]) <= len(head)), len(rows))
        below = [[*row, *[""] * (len(head) - len(row))] for row in rows[k + 1 : end]]
        place = max(range(len(head)), key=lambda j: sum(row[j] in names for row in below))
        found = {
            row[place]: (row[unit], _comment(row, (place, unit))) for row in below if row[place] in names
        }
        if place != unit and len(found) >= _FEWEST and any(known_unit(u) for u, _ in found.values()):
            return found
    return {}


def _comment(row: Sequence[str], but: Sequence[int]) -> str:
    """The words of a row; numbers, as gains and rates are, say nothing of what a channel is."""
    cells = [cell for j, cell in enumerate(row) if cell and j not in but]
    return ", ".join(c for c in cells if not (is_number_with_any_sign(c) or is_quantity(c)))


def _by_words(names: Sequence[str], line: str) -> list[str]:
    """The units in a line such as "units: axis 1 UM, output V": each is that of the columns whose names have its words.

    >>> _by_words(["Target of axis 1", "Output 2"], "# units: axis 1 UM, output V")
    ['um', 'V']
    >>> _by_words(["Output 2"], "units: output soon")
    ['']
    """
    units = [""] * len(names)
    match = _STATED.fullmatch(line)
    parts = [_PART.fullmatch(part.strip()) for part in re.split(r"[,;]", match[1])] if match else []
    for part in parts:
        unit = _in_any_case(part[2]) if part else ""
        if part is None or not unit:
            return [""] * len(names)
        words = set(_WORD.findall(part[1].lower()))
        units = [unit if words <= set(_WORD.findall(n.lower())) else u for u, n in zip(units, names)]
    return units


def _in_any_case(written: str) -> str:
    """The one known unit that a text is, whatever its case; "" for none."""
    same = [unit for unit in UNITS if unit.casefold() == written.casefold()]
    return known_unit(written) or (same[0] if len(same) == 1 else "")

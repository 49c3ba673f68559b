"""Tables in long format become tables with a column for each variable: by the times of the readings, or by turns."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, shown
from smarig.exchange.layouts.channel_rows import by_turns
from smarig.exchange.layouts.joined_clocks import joined_clocks
from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.layouts.long_table import LongReading, LongTable, long_table
from smarig.exchange.layouts.unit_cells import joined_cells
from smarig.exchange.text.clock_cells import clock_column, clock_seconds

_MOST_SHOWN = 4  # names in a finding
_Variable = tuple[str, ...]
_Row = tuple[
    LongReading, dict[_Variable, str]
]  # the reading whose line and time are those of the row, and values


def long_rows(path: Path, lines: Sequence[str], added: int = 0) -> LoggedRows:
    """The lines of a text with a column for each variable of a long table; other texts as they are. The first ``added``
    lines are not in the file.

    The rows stand in the lines of the variable with most readings. DataError if nothing states which readings belong
    to one row.
    """
    table = long_table(lines)
    if table is None:
        return LoggedRows(list(lines))
    rows, how = _rows(path, table)
    masked = (*_masked_notes(table), *_word_notes(table, added))
    notes = (f"{_what(table)} Each is a column. {how}", *_left_out(table), *masked)
    return LoggedRows(_written(lines, rows, table), notes)


def _rows(path: Path, table: LongTable) -> tuple[list[_Row], str]:
    """The rows of all variables, and a sentence on how readings came into one row."""
    clocks = _clocks(path, table)
    repeated = any(np.unique(clock).size < clock.size for clock in clocks)
    if (repeated or not clocks) and by_turns([" ".join(r.variable) for r in table.in_order]):
        first = table.title(next(iter(table.readings)))
        return _scans(
            table
        ), f"A row is a scan with the time of its first reading, mostly that of {shown(first)}."
    if not clocks:
        raise DataError(
            f"{path} is in long format: {_what(table)} They cannot be brought into rows, because they do not come by "
            "turns and no column is a time. Write one column for each, and study that file."
        )
    joined = joined_clocks(clocks)
    base = list(table.readings)[joined.base]
    rows = [(reading, dict[_Variable, str]()) for reading in table.readings[base]]
    for where, (variable, readings) in zip(joined.rows, table.readings.items()):
        for k, reading in zip(where.tolist(), readings):
            if k >= 0:
                rows[k][1][variable] = _value(reading, table)
    return rows, joined.sentence(table.title(base))


def _clocks(path: Path, table: LongTable) -> list[Array]:
    """The times of the readings of each variable in seconds, or in the unit of numbers; [] without a time."""
    if not table.time:
        return []
    readings = table.in_order
    cells = [reading.cell(table.time) for reading in readings]
    if clock_seconds(cells[0]) is not None:
        t = clock_column(path, table.time, cells, [reading.line + 1 for reading in readings])
    else:
        t = np.array([float(cell.replace(",", ".")) for cell in cells])
    at = {reading.line: float(time) for reading, time in zip(readings, t)}
    return [np.array([at[reading.line] for reading in found]) for found in table.readings.values()]


def _scans(table: LongTable) -> list[_Row]:
    """The rows of variables by turns: one that comes again begins a new row."""
    rows: list[_Row] = []
    for reading in table.in_order:
        if not rows or reading.variable in rows[-1][1]:
            rows.append((reading, {}))
        rows[-1][1][reading.variable] = _value(reading, table)
    return rows


def _value(reading: LongReading, table: LongTable) -> str:
    """The cell of a reading, with its unit where those of a variable differ."""
    if reading.line in table.masked or not reading.value or reading.line in table.words:
        return "nan"
    several = len(table.units[reading.variable]) > 1
    return f"{reading.value} {reading.at(reading.header.unit)}" if several else reading.value


def _written(lines: Sequence[str], rows: Sequence[_Row], table: LongTable) -> list[str]:
    """The lines with those of the rows in place, and the names directly above the first of them."""
    begin = table.line
    while begin > 0 and lines[begin - 1].startswith(
        "#"
    ):  # types of columns, which InfluxDB writes above the names
        begin -= 1
    out = [*lines[:begin], *[""] * (rows[-1][0].line + 1 - begin)]
    for reading, values in rows:
        cells = [values.get(variable, "nan") for variable in table.readings]
        out[reading.line] = _line(reading.cell(table.time), cells, table)
    names = [_named(table, variable) for variable in table.readings]
    out[rows[0][0].line - 1] = _line(table.time, names, table)
    return out


def _line(time: str, cells: Sequence[str], table: LongTable) -> str:
    return joined_cells([time, *cells] if table.time else cells, table.header.sign)


def _named(table: LongTable, variable: _Variable) -> str:
    """The name of a column, with the unit of a column of units."""
    units = list(table.units[variable])
    return f"{table.title(variable)} [{units[0]}]" if len(units) == 1 else table.title(variable)


def _what(table: LongTable) -> str:
    listed = [f"{table.title(variable)} ({len(found)})" for variable, found in table.readings.items()]
    more = ", …" if listed[_MOST_SHOWN:] else ""
    names = table.header.names
    return (
        f"{shown(names[table.header.value])} holds the readings of {len(listed)} variables, which "
        f"{shown(names[table.header.variable[0]])} names: {', '.join(listed[:_MOST_SHOWN])}{more}."
    )


def _left_out(table: LongTable) -> list[str]:
    """A finding on rows that are no readings of the variables."""
    if not table.others:
        return []
    names = [*dict.fromkeys(" ".join(filter(None, reading.variable)) for reading in table.others)]
    listed = ", ".join(shown(name, 40) for name in names[:_MOST_SHOWN]) + (
        ", …" if names[_MOST_SHOWN:] else ""
    )
    return [f"Rows that are no readings of them are left out: {len(table.others)} ({listed})."]


def _masked_notes(table: LongTable) -> list[str]:
    if not table.masked:
        return []
    name = table.header.names[table.header.quality]
    return [f"Readings that {shown(name)} marks as not valid are masked: {len(table.masked)}."]


def _word_notes(table: LongTable, added: int) -> list[str]:
    """A finding on the words among the readings, with the lines of the file where they first stand."""
    if not table.words:
        return []
    number = Counter(table.words.values())
    first = {word: line + 1 - added for line, word in reversed(table.words.items())}
    listed = [f"{shown(word, 40)} ({times}, first in line {first[word]})" for word, times in number.items()]
    more = ", …" if listed[_MOST_SHOWN:] else ""
    return [f"Words among the readings are masked: {', '.join(listed[:_MOST_SHOWN])}{more}."]

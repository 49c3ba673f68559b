"""Columns in pairs of a clock and a value, as scopes of controllers export channels of several periods: the channels
are joined on time, as rows with one clock.

The names stand in one row, as "Time, T, Time, s", or each channel has keys and values above its pair, as
"Name, fTemp, Name, fPos" and "Unit, °C, Unit, mm" of TwinCAT.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, shown
from smarig.exchange.layouts.joined_clocks import joined_clocks
from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.layouts.unit_cells import joined_cells
from smarig.exchange.text.cell_values import is_number_with_any_sign
from smarig.exchange.text.clock_cells import clock_column, clock_seconds
from smarig.exchange.text.header_words import UNIT_WORD
from smarig.exchange.text.no_reading import is_missing
from smarig.exchange.text.table_rows import split
from smarig.exchange.units.unit_conversion import convert, dimension
from smarig.exchange.units.written_units import known_unit

_HEADER_WITHIN = 200  # lines
_SIGNS = ("\t", ";", ",")
_NAME = re.compile(r"(channel|signal|symbol|kanal)?[ _]?name|channel|signal|kanal", re.IGNORECASE)
_PERIOD = re.compile(
    r"(?:sampl\w*|abtast)[ _-]?(?:time|period|interval|zeit|intervall)\s*[\[(](\w+)[\])]", re.IGNORECASE
)
_COMMENT = re.compile(r".*(comment|kommentar|descr|beschreib|remark|bemerkung|label)\w*", re.IGNORECASE)
_TIME = re.compile(r"time|zeit", re.IGNORECASE)
_CLOCK = re.compile(
    r"((?i:time|zeit|timestamp|x[_ ]?value)|t)(\d*\s*\(?\[?.*[\])]|[ _.-].*|\d*)"
)  # T is a temperature


@dataclass(frozen=True)
class _Heading:
    """The lines of a heading, from 0, the sign between cells, and the names of the values and of their clocks;
    ``stated`` are the period of each channel and its unit, and ``comments`` what is said of each, where keys state it.
    """

    first: int
    last: int
    sign: str
    names: tuple[str, ...]
    clocks: tuple[str, ...]
    stated: tuple[tuple[str, ...], str] = ((), "")
    comments: tuple[str, ...] = ()

    @property
    def has_keys(self) -> bool:
        """Whether the heading is one of keys and values."""
        return self.last > self.first


def has_clock_pairs(lines: Sequence[str]) -> bool:
    """Whether names stand over pairs of a clock and a value."""
    return any(_headings(lines[:_HEADER_WITHIN]))


def clock_pairs(path: Path, lines: Sequence[str]) -> LoggedRows:
    """The lines of a text with one clock for all channels, where each has its own; other texts as they are.

    The rows stand in the lines of the channel with most readings. DataError with the line for a clock that goes back.
    """
    heading = next(_headings(lines[:_HEADER_WITHIN]), None)
    rows = _rows(lines, heading) if heading else {}
    if heading is None or not rows:
        return LoggedRows(list(lines))
    where = [_filled(rows, j) for j in range(len(heading.names))]
    clocks = _clocks(path, rows, where)
    one = not heading.has_keys and all(np.array_equal(clock, clocks[0]) for clock in clocks)
    if one or not _rise(path, heading, clocks, where):
        return LoggedRows(list(lines))
    joined = joined_clocks(clocks)
    base = where[joined.base]
    values = {k: ["nan"] * len(heading.names) for k in base}
    for j, (found, numbers) in enumerate(zip(where, joined.rows)):
        for k, row in zip(found, numbers.tolist()):
            if row >= 0:
                values[base[row]][j] = rows[k][2 * j + 1]
    out = ["" if heading.first <= k <= heading.last or k in rows else line for k, line in enumerate(lines)]
    for k, cells in values.items():
        out[k] = joined_cells([rows[k][2 * joined.base], *cells], heading.sign)
    clock = f"{heading.clocks[joined.base]}{_unit_of_clock(heading, clocks)}"
    names = heading.last - any(heading.comments)
    out[names : heading.last + 1] = [
        joined_cells(cells, heading.sign)
        for cells in ([clock, *heading.names], ["", *heading.comments])[: heading.last - names + 1]
    ]
    counts = ", ".join(f"{name} ({clock.size})" for name, clock in zip(heading.names, clocks))
    note = f"The file holds {len(clocks)} channels, each with its own clock: {counts}."
    return LoggedRows(out, (f"{note} {joined.sentence(heading.names[joined.base])}",))


def _rise(path: Path, heading: _Heading, clocks: Sequence[Array], where: Sequence[Sequence[int]]) -> bool:
    """Whether all clocks rise; DataError for one that does not, although its name says that it is a time."""
    for name, clock_name, clock, found in zip(heading.names, heading.clocks, clocks, where):
        back = np.flatnonzero(~(np.diff(clock) >= 0))
        if back.size and (heading.has_keys or _TIME.match(clock_name)):
            raise DataError(
                f"{path} has a clock for each channel, but that of {shown(name)} does not rise in line "
                f"{found[back[0] + 1] + 1}. Correct it, or split the file there."
            )
        if back.size:
            return False
    return True


def _clocks(path: Path, rows: Mapping[int, Sequence[str]], where: Sequence[Sequence[int]]) -> list[Array]:
    """The times of the readings of each channel, in the unit of numbers or in seconds."""
    cells = [rows[k][2 * j] for j, found in enumerate(where) for k in found]
    if cells and clock_seconds(cells[0]) is not None:
        t = clock_column(path, "time", cells, [k + 1 for found in where for k in found])
    else:
        t = np.array(
            [float(cell.replace(",", ".")) if is_number_with_any_sign(cell) else np.nan for cell in cells]
        )
    return np.split(t, np.cumsum([len(found) for found in where])[:-1])


def _headings(lines: Sequence[str]) -> Iterator[_Heading]:
    """The headings over pairs: rows of keys and values, else one row of names."""
    for k, line in enumerate(lines):
        for sign in _SIGNS:
            cells = split(line, sign)
            if len(cells) < 4 or len(cells) % 2:
                continue
            keys, values = cells[::2], cells[1::2]
            distinct = all(values) and len(set(values)) == len(values)
            if distinct and len(set(keys)) == 1 and _NAME.fullmatch(keys[0]):
                yield _of_keys(lines, k, sign, values)
            elif distinct and all(map(_CLOCK.fullmatch, keys)) and not any(map(_CLOCK.fullmatch, values)):
                yield _Heading(k, k, sign, tuple(values), tuple(keys))


def _of_keys(lines: Sequence[str], first: int, sign: str, names: Sequence[str]) -> _Heading:
    """The heading whose rows hold a key and a value for each channel, from that of the names on."""
    last, units, periods, unit = first, [""] * len(names), (), ""
    comments = [""] * len(names)
    for k in range(first + 1, len(lines)):
        cells = split(lines[k], sign)
        keys = set(cells[::2])
        if len(keys) != 1 or is_number_with_any_sign(cells[0]):
            break
        last, (key,), values = k, keys, [*cells[1::2], *[""] * len(names)][: len(names)]
        units = values if UNIT_WORD.fullmatch(key) else units
        if _COMMENT.fullmatch(key):
            comments = [f"{old} {new}".strip() for old, new in zip(comments, values)]
        if match := _PERIOD.fullmatch(key):
            periods, unit = tuple(values), known_unit(match[1])
    named = [f"{name} [{u}]" if u else name for name, u in zip(names, units)]
    return _Heading(first, last, sign, tuple(named), ("time",) * len(names), (periods, unit), tuple(comments))


def _rows(lines: Sequence[str], heading: _Heading) -> dict[int, list[str]]:
    """The cells of the rows below a heading by line, each as wide as the pairs; lines of text are none."""
    width, rows = 2 * len(heading.names), dict[int, list[str]]()
    for k, line in enumerate(lines[heading.last + 1 :], heading.last + 1):
        cells = split(line, heading.sign)
        times, values = [cell for cell in cells[::2] if cell], cells[1::2]
        are_times = all(is_number_with_any_sign(cell) or clock_seconds(cell) is not None for cell in times)
        are_values = all(is_number_with_any_sign(cell) or is_missing(cell) for cell in values)
        if 1 < len(cells) <= width and times and are_times and are_values:
            rows[k] = cells + [""] * (width - len(cells))
    return rows


def _filled(rows: Mapping[int, Sequence[str]], j: int) -> list[int]:
    """The lines in which a channel has a time and a value."""
    return [k for k, row in rows.items() if row[2 * j] and row[2 * j + 1]]


def _unit_of_clock(heading: _Heading, clocks: Sequence[Array]) -> str:
    """The unit of the clocks in brackets: that of the stated periods, if they are the steps of the clocks; else ""."""
    periods, unit = heading.stated
    if (
        len(periods) != len(clocks)
        or dimension(unit) != "time"
        or not all(map(is_number_with_any_sign, periods))
    ):
        return ""
    if min(clock.size for clock in clocks) < 2:
        return ""
    steps = [float(np.median(np.diff(clock))) for clock in clocks]
    for written in ("s", "ms", "us", "ns", unit):
        if np.allclose(
            [convert(float(period.replace(",", ".")), unit, written) for period in periods], steps, rtol=1e-3
        ):
            return f" [{written}]"
    return ""

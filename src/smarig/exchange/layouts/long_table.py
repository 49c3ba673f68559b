"""Finds tables in long format, as of historians, trends of controllers and InfluxDB: one row for each reading, a column
that names the variable, and one that holds all values.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from smarig.exchange.layouts.unit_cells import is_quantity
from smarig.exchange.text.cell_values import is_number_with_any_sign
from smarig.exchange.text.clock_cells import clock_seconds
from smarig.exchange.text.header_words import UNIT_WORD
from smarig.exchange.text.no_reading import is_missing
from smarig.exchange.text.table_rows import split

_FEWEST = 3  # readings of a variable, as rows of a table
_HEADER_WITHIN = 200  # lines
_SIGNS = ("\t", ";", ",")
_NAME = re.compile(
    r"(var(iable)?|tag|point|sensor|channel|chan|ch|metric|signal|_?field|_measurement|item|param(eter)?|topic|series|"
    r"entity|kanal|messstelle|messgröße|größe|voie|canal)?[ _.]?(name|id|key)?",
    re.IGNORECASE,
)
_VALUE = re.compile(
    r"_?(var|tag|sensor|signal|point)?[ _]?(value|val|reading|measurement|wert|messwert|valeur|valor|payload|state)s?",
    re.IGNORECASE,
)
_TIME = re.compile(r".*(time|zeit|date|datum|stamp|changed).*|ts?", re.IGNORECASE)
_QUALITY = re.compile(
    r"(opc)?[ _]?(validity|valid|quality|qualität|gültig|gültigkeit)[ _]?(code)?", re.IGNORECASE
)
_GOOD = re.compile(r"1|192|true|ok|valid|gut|yes|good.*", re.IGNORECASE)  # 192 is that of OPC
_OF_THE_LOG = re.compile(r"\$\w+\$")  # $RT_OFF$ and $RT_COUNT$ are written by a log of itself
_NO_TAGS = ("", "result", "table")  # columns of InfluxDB


@dataclass(frozen=True)
class LongHeader:
    """The names of a header, the sign between them, and the columns that name the variable and hold its value, its
    times, and its unit and validity, -1 for one that is missing.
    """

    names: tuple[str, ...]
    sign: str
    variable: tuple[int, ...]
    value: int
    times: tuple[int, ...]
    unit: int
    quality: int


@dataclass(frozen=True)
class LongReading:
    """The reading of a variable: its line, from 0, its cells, and the header above it."""

    line: int
    row: tuple[str, ...]
    header: LongHeader
    variable: tuple[str, ...]

    @property
    def value(self) -> str:
        return self.row[self.header.value]

    def cell(self, name: str) -> str:
        """The cell of a column, "" if the header above has none of that name."""
        return self.row[self.header.names.index(name)] if name in self.header.names else ""

    def at(self, column: int) -> str:
        """The cell of a column by its number, "" for -1."""
        return self.row[column] if column >= 0 else ""


@dataclass(frozen=True)
class LongTable:
    """The readings of each variable, of which there are three or more, a number among them, and ``others``, the rows
    that are none.

    ``line`` is the line of the first header, ``time`` the column of times, "" without one, ``units`` are those of the
    column of units by variable, ``masked`` the lines of readings that are marked as not valid, and ``words`` the
    values of valid ones that are words, as "unavailable", by line.
    """

    line: int
    header: LongHeader
    readings: dict[tuple[str, ...], list[LongReading]]
    others: list[LongReading]
    time: str
    units: dict[tuple[str, ...], frozenset[str]]
    masked: frozenset[int]
    words: dict[int, str]

    def title(self, variable: tuple[str, ...]) -> str:
        """The name of a variable: the parts of it by which variables differ."""
        differ = [k for k, parts in enumerate(zip(*self.readings)) if len(set(parts)) > 1]
        return " ".join(filter(None, (variable[k] for k in differ)))

    @property
    def in_order(self) -> list[LongReading]:
        """The readings of all variables in the order of the file."""
        return sorted((r for found in self.readings.values() for r in found), key=lambda r: r.line)


def is_long(lines: Sequence[str]) -> bool:
    """Whether a header names a column of variables and one of values."""
    return any(map(_header, lines[:_HEADER_WITHIN]))


def long_table(lines: Sequence[str]) -> LongTable | None:
    """The table of a text; None for one that is not in long format, has fewer than two variables, or has another column
    that is a signal.
    """
    line = next((k for k, line in enumerate(lines[:_HEADER_WITHIN]) if _header(line)), -1)
    every = list(_rows(lines)) if line >= 0 else []
    time = _time(every)
    able = [
        r for r in every if not _OF_THE_LOG.fullmatch(r.variable[0]) and (not time or _is_time(r.cell(time)))
    ]
    times = Counter(r.variable for r in able)
    several = [r for r in able if times[r.variable] >= _FEWEST]
    measured = {r.variable for r in several if not is_missing(r.value) and _is_value(r.value)}
    readings = [r for r in several if r.variable in measured]  # a switch is on or off
    masked = _masked(readings)
    words = {r.line: r.value for r in readings if r.line not in masked and not _is_value(r.value)}
    found: dict[tuple[str, ...], list[LongReading]] = {}
    for reading in readings:
        found.setdefault(reading.variable, []).append(reading)
    if len(found) < 2 or 2 * len(words) >= len(readings) or _has_other_signals(found):
        return None
    kept = {r.line for r in readings}
    others = [r for r in every if r.line not in kept]
    units = {v: frozenset(filter(None, (r.at(r.header.unit) for r in own))) for v, own in found.items()}
    return LongTable(line, readings[0].header, found, others, time, units, masked, words)


def _header(line: str) -> LongHeader | None:
    """The header of a long table in a line."""
    for sign in _SIGNS if not line.startswith("#") else ():
        names = tuple(split(line, sign))
        value = _first(names, _VALUE)
        variable = [j for j, name in enumerate(names) if name and _NAME.fullmatch(name)]
        if value < 0 or not variable:
            continue
        if names[value].startswith("_"):  # tags tell series of InfluxDB apart, too
            tags = {j for j, n in enumerate(names) if not n.startswith("_") and n not in _NO_TAGS}
            variable = sorted({*variable, *tags})
        times = tuple(j for j, name in enumerate(names) if _TIME.fullmatch(name) and j not in variable)
        return LongHeader(
            names, sign, tuple(variable), value, times, _first(names, UNIT_WORD), _first(names, _QUALITY)
        )
    return None


def _first(names: Sequence[str], pattern: re.Pattern[str]) -> int:
    return next((j for j, name in enumerate(names) if pattern.fullmatch(name)), -1)


def _rows(lines: Sequence[str]) -> Iterator[LongReading]:
    """The rows below headers; InfluxDB writes a header for each block, after a blank line."""
    header, begins = None, True
    for k, line in enumerate(lines):
        if not line.strip() or line.startswith("#"):
            begins = True
            continue
        new = _header(line) if begins or header is None else None
        begins, header = False, new or header
        row = split(line, header.sign) if header and not new else []
        if header and not new and len(row) <= len(header.names):
            cells = (*row, *[""] * (len(header.names) - len(row)))
            yield LongReading(k, cells, header, tuple(cells[j] for j in header.variable))


def _is_value(cell: str) -> bool:
    """Whether a cell is a number, one with a unit, or says that there is none."""
    return is_missing(cell) or is_number_with_any_sign(cell) or is_quantity(cell)


def _is_time(cell: str) -> bool:
    return clock_seconds(cell) is not None or (bool(cell) and is_number_with_any_sign(cell))


def _time(every: Sequence[LongReading]) -> str:
    """The column of times: the first of clock times, else of numbers; "" without one."""
    names = [r.header.names[j] for r in every[:1] for j in r.header.times]
    for is_one in (lambda cell: clock_seconds(cell) is not None, is_number_with_any_sign):
        for name in names:
            cells = [r.cell(name) for r in every[:_HEADER_WITHIN]]
            if 2 * sum(map(is_one, cells)) > len(cells):
                return name
    return ""


def _masked(readings: Sequence[LongReading]) -> frozenset[int]:
    """The lines of readings that are not marked as valid, where most are."""
    marks = {r.line: r.at(r.header.quality) for r in readings if r.header.quality >= 0}
    bad = frozenset(line for line, mark in marks.items() if not _GOOD.fullmatch(mark))
    return bad if 2 * len(bad) < len(marks) else frozenset()


def _has_other_signals(readings: Mapping[tuple[str, ...], Sequence[LongReading]]) -> bool:
    """Whether a column that is no part of a long table goes up and down within a variable."""
    for found in readings.values():
        h = found[0].header
        own = {*h.variable, h.value, *h.times, h.unit, h.quality}
        for name in [name for j, name in enumerate(h.names) if j not in own]:
            cells = [r.cell(name) for r in found]
            steps = np.diff([float(c.replace(",", ".")) for c in cells if is_number_with_any_sign(c)])
            if (steps > 0).any() and (steps < 0).any():
                return True
    return False

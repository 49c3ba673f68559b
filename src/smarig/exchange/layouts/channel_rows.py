"""Rows of one channel each, as scanning multimeters write them: the channels are columns, and a scan is one row.

The readings of all channels stand in one column, beside one of channels and one of units. A row of a scan has the time
of its first reading. Where channels do not come by turns, or have no units, such a table is refused.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.core import DataError, shown
from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.text.header_words import UNIT_WORD
from smarig.exchange.units.written_units import known_unit

_CHANNEL = re.compile(r"channel|chan\.?|ch\.?|kanal|canal|voie", re.IGNORECASE)
_READING = re.compile(r"readings?|values?|measurement|messwert|wert|valeur|valor|data", re.IGNORECASE)
_HEADER_WITHIN = 200  # lines
_SIGNS = ("\t", ";", ",")


@dataclass(frozen=True)
class _Place:
    """The line of the header, the sign between its cells, the names, and the columns of channel, reading and unit."""

    line: int
    sign: str
    names: tuple[str, ...]
    channel: int
    reading: int
    unit: int

    def cells(self, line: str) -> list[str]:
        return [cell.strip().strip('"') for cell in line.split(self.sign)]


def channel_rows(lines: Sequence[str]) -> LoggedRows:
    """The lines of a text with one row for each scan, in the line of its first reading; other texts as they are."""
    place = _place(lines)
    if place is None:
        return LoggedRows(list(lines))
    rows = _rows(lines, place)
    units = {(row[place.channel], row[place.unit]) for row in rows}
    channels = list(dict.fromkeys(row[place.channel] for row in rows))
    if len(channels) < 2 or len(units) > len(channels) or not by_turns([r[place.channel] for r in rows]):
        return LoggedRows(list(lines))
    first = place.line + 1
    written = {first + k: _wide(scan, channels, place) for k, scan in _scans(rows, place)}
    names = [f"{place.names[place.reading]} {channel} [{dict(units)[channel]}]" for channel in channels]
    wide = [written.get(k, "") for k in range(first, first + len(rows))]
    rest = [*lines[first + len(rows) :]]
    while wide and not wide[-1] and not rest:
        wide.pop()
    note = (
        f"{shown(place.names[place.reading])} holds {len(channels)} channels by turns. Each is a column, and a row is "
        f"a scan with the time of its first reading, that of {channels[0]}; the later ones are not shifted to it."
    )
    return LoggedRows([*lines[: place.line], _joined_cells(place.names, names, place), *wide, *rest], (note,))


def check_one_channel(path: Path, names: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Raise DataError for a table whose readings are those of several channels or units in one column."""
    places = [k for k, name in enumerate(names) if _CHANNEL.fullmatch(name) or UNIT_WORD.fullmatch(name)]
    columns = [[row[k] for k in places if k < len(row)] for row in rows] if places else []
    for j, k in enumerate(places):
        cells = [row[j] for row in columns if j < len(row) and row[j] != names[k]]
        found = list(dict.fromkeys(cells))
        what = "units" if UNIT_WORD.fullmatch(names[k]) else "channels"
        mixed = len({known_unit(cell) for cell in found} - {""}) > 1 if what == "units" else by_turns(cells)
        if mixed:
            listed = ", ".join(shown(cell, 20) for cell in found[:4]) + (", …" if len(found) > 4 else "")
            raise DataError(
                f"{path} holds several channels in one column: {shown(names[k])} has the {what} {listed}. Write one "
                "column for each channel, with its unit, and study that file."
            )


def _place(lines: Sequence[str]) -> _Place | None:
    for k, line in enumerate(lines[:_HEADER_WITHIN]):
        for sign in _SIGNS:
            names = tuple(cell.strip().strip('"') for cell in line.split(sign))
            found = [
                next((j for j, name in enumerate(names) if pattern.fullmatch(name)), -1)
                for pattern in (_CHANNEL, _READING, UNIT_WORD)
            ]
            if min(found) >= 0:
                return _Place(k, sign, names, *found)
    return None


def _rows(lines: Sequence[str], place: _Place) -> list[list[str]]:
    """The rows below the header, up to the first line with another number of cells."""
    rows = []
    for line in lines[place.line + 1 :]:
        cells = place.cells(line)
        if len(cells) != len(place.names):
            break
        rows.append(cells)
    return rows


def by_turns(channels: Sequence[str]) -> bool:
    """Whether channels come in one order: most rows have another channel than the next, and that of a scan later."""
    number, half = len(set(channels)), len(channels) / 2
    changes = sum(a != b for a, b in zip(channels, channels[1:]))
    return (
        number > 1 and min(changes, sum(a == b for a, b in zip(channels, channels[number:]))) > half - number
    )


def _scans(rows: Sequence[Sequence[str]], place: _Place) -> Iterator[tuple[int, list[Sequence[str]]]]:
    """The number of the first row of each scan, and its rows: a channel that comes again begins a new one."""
    start, scan = 0, list[Sequence[str]]()
    for k, row in enumerate(rows):
        if row[place.channel] in [other[place.channel] for other in scan]:
            yield start, scan
            start, scan = k, []
        scan.append(row)
    if scan:
        yield start, scan


def _wide(scan: Sequence[Sequence[str]], channels: Sequence[str], place: _Place) -> str:
    of_channel = {row[place.channel]: row[place.reading] for row in scan}
    return _joined_cells(scan[0], [of_channel.get(channel) or "nan" for channel in channels], place)


def _joined_cells(cells: Sequence[str], readings: Sequence[str], place: _Place) -> str:
    """A line with the readings of all channels in place of their column, without those of channel and unit."""
    left_out = (place.channel, place.unit)
    parts = [readings if k == place.reading else [cell] for k, cell in enumerate(cells) if k not in left_out]
    return place.sign.join(cell for part in parts for cell in part)

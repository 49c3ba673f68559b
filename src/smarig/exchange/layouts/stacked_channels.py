"""Channels that stand one below another, each below a line with its name and with times of its own, as archives of
control systems export them: they are joined on time, as rows with one clock.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from smarig.core import Array
from smarig.exchange.layouts.joined_clocks import joined_clocks, share_times
from smarig.exchange.layouts.logged_rows import LoggedRows
from smarig.exchange.text.cell_values import is_number_with_any_sign
from smarig.exchange.text.clock_cells import clock_column, clock_seconds
from smarig.exchange.text.table_rows import split

_HEADING = re.compile(
    r"[^\w\s]*\s*(?:channel|signal|tag|pv|process variable|variable|sensor|kanal|messstelle|voie|canal)(?:[ _]?name)?"
    r"\s*[:=]\s*(\S.*?)\s*",
    re.IGNORECASE,
)
_TIME = re.compile(r"\W*(date[ /]?)?(time|zeit|timestamp|temps|t)\b", re.IGNORECASE)
_UNIT = re.compile(r"[\[(]([^\])]*)[\])]\s*$")
_SIGNS = ("\t", ";", ",")
_FEWEST_ROWS = 2


@dataclass(frozen=True)
class _Channel:
    """A channel by its name with the unit: the line of its heading, and the cells of its rows by line."""

    name: str
    line: int
    rows: dict[int, tuple[str, str]]


def stacked_channels(path: Path, lines: Sequence[str]) -> LoggedRows:
    """The lines with one row for each reading of the channel that has most of them; other texts as they are.

    DataError with the line for a clock that cannot be read.
    """
    channels = _channels(lines)
    clocks = _clocks(path, channels)
    if not clocks or not share_times(clocks):
        return LoggedRows(list(lines))
    joined = joined_clocks(clocks)
    base = channels[joined.base]
    cells = [["nan"] * len(channels) for _ in base.rows]
    for k, channel in enumerate(channels):
        for (_, value), row in zip(channel.rows.values(), joined.rows[k].tolist()):
            if row >= 0:
                cells[row][k] = value
    out = [*lines[: channels[0].line], *[""] * (len(lines) - channels[0].line)]
    out[min(base.rows) - 1] = "\t".join(["time", *(channel.name for channel in channels)])
    for (k, (time, _)), values in zip(base.rows.items(), cells):
        out[k] = "\t".join([time, *values])
    counts = ", ".join(f"{channel.name} ({len(channel.rows)})" for channel in channels)
    note = f"The file holds {len(channels)} channels one below another, each with its own clock: {counts}."
    return LoggedRows(out, (f"{note} {joined.sentence(base.name)}",))


def _channels(lines: Sequence[str]) -> list[_Channel]:
    """The channels of a text; none if a name stands twice or a heading has no rows of one value each."""
    heads = [(k, match[1]) for k, line in enumerate(lines) if (match := _HEADING.fullmatch(line))]
    if len(heads) < 2 or len({name for _, name in heads}) < len(heads):
        return []
    ends = [*(k for k, _ in heads), len(lines)]
    found = [_channel(name, first, last, lines) for (_, name), (first, last) in zip(heads, pairwise(ends))]
    able = [channel for channel in found if channel is not None]
    return able if len(able) == len(found) else []


def _channel(name: str, first: int, last: int, lines: Sequence[str]) -> _Channel | None:
    """The channel between two headings, of a clock and a value in each row; further cells are words on the value."""
    rows: dict[int, tuple[str, str]] = {}
    above = ""
    for k in range(first + 1, last):
        cells = _cells(lines[k])
        if len(cells) < 2 or not (_is_clock(cells[0]) or is_number_with_any_sign(cells[0])):
            above = above if rows or not lines[k].strip(" #") else lines[k]
        elif any(map(is_number_with_any_sign, cells[2:])):
            return None
        elif is_number_with_any_sign(cells[1]):
            rows[k] = (cells[0], cells[1])
    names = _cells(above)
    timed = _TIME.match(above) is not None or all(_is_clock(time) for time, _ in rows.values())
    if len(rows) < _FEWEST_ROWS or not timed:
        return None
    unit = _UNIT.search(names[1]) if len(names) > 1 else None
    return _Channel(f"{name} [{unit[1]}]" if unit and unit[1] else name, first, rows)


def _cells(line: str) -> list[str]:
    """The cells of a line; between blanks, a date and a time of day are one."""
    sign = next((sign for sign in _SIGNS if sign in line), " ")
    cells = split(line.strip("\r\n"), sign)
    if sign == " " and len(cells) > 2 and ":" in cells[1] and _is_clock(f"{cells[0]} {cells[1]}"):
        return [f"{cells[0]} {cells[1]}", *cells[2:]]
    return cells


def _is_clock(cell: str) -> bool:
    return clock_seconds(cell) is not None


def _clocks(path: Path, channels: Sequence[_Channel]) -> list[Array]:
    """The times of the readings of each channel; none if one of them does not rise."""
    times = [time for channel in channels for time, _ in channel.rows.values()]
    where = [k + 1 for channel in channels for k in channel.rows]
    if not times:
        return []
    if _is_clock(times[0]):
        t = clock_column(path, "time", times, where)
    else:
        t = np.array([float(time.replace(",", ".")) for time in times])
    clocks = np.split(t, np.cumsum([len(channel.rows) for channel in channels])[:-1])
    return clocks if all((np.diff(clock) >= 0).all() for clock in clocks) else []

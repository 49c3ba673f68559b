"""Clock times from the cells of a table: times of day, durations and dates, in the one order that a column keeps."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, shown
from smarig.exchange.text.no_reading import is_missing

_CLOCK = re.compile(r"(?:(\d{1,9})[ T])?(\d{1,3}):(\d{2})(?::(\d{2})(?:[.,:](\d+))?)?")
_DATE = re.compile(
    r"(\d{1,4})[./-](\d{1,2})[./-](\d{1,4})[ T,;]+(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,:](\d+))?)?"
    r"(?:\s*([AaPp][Mm]))?\s*(?:Z|([+-])(\d{2}):?(\d{2})?)?"
)
_SHORT_FIRST = re.compile(r"'?\d{1,2}[./-]")  # a date that does not begin with a year of four digits
_ORDERS = ("dmy", "mdy", "ymd")  # of day, month and year; the first counts where rows allow several


def clock_seconds(cell: str, order: str = "") -> float | None:
    """Seconds of a time of day, a duration, or a date with a time (from 1970; UTC if it has an offset); None for other
    texts.

    ``order`` is that of day, month and year in numbers, where no year of four digits comes first; "" for the first that
    the cell allows. An apostrophe before a date, which keeps a spreadsheet from changing it, is left out.

    >>> clock_seconds("00:01:30.5"), clock_seconds("1970-01-01 00:00:02"), clock_seconds("12.5")
    (90.5, 2.0, None)
    >>> clock_seconds("2/1/1970 00:00:00:250"), clock_seconds("2/1/1970 00:00", "mdy")
    (86400.25, 2678400.0)
    """
    text = cell.strip().removeprefix("'")
    if match := _CLOCK.fullmatch(text):
        days, hours, minutes, seconds, fraction = match.groups()
        whole = 86400 * int(days or 0) + 3600 * int(hours) + 60 * int(minutes) + int(seconds or 0)
        return whole + float(f"0.{fraction}" if fraction else 0)
    match = _DATE.fullmatch(text)
    if match is None:
        return None
    found = (_of_date(match, each) for each in ([order] if order else _ORDERS[:2]))
    return next((seconds for seconds in found if seconds is not None), None)


def _of_date(match: re.Match[str], order: str) -> float | None:
    """Seconds of a date and time whose day, month and year stand in an order; None if there is no such day."""
    a, b, c, hour, minute, second, fraction, half, *offset = match.groups()
    first = len(a) == 4 or (order == "ymd" and len(c) < 3)
    if len(a) == 4 and order == "mdy":
        b, c = c, b  # 2019-21-03: year, day and month
    year, month, day = (a, b, c) if first else (c, a, b) if order == "mdy" else (c, b, a)
    noon = 12 * (half.lower() == "pm") - 12 * (int(hour) == 12) if half else 0
    try:
        at = datetime(
            int(year) + 2000 * (len(year) < 3),
            int(month),
            int(day),
            int(hour) + noon,
            int(minute),
            int(second or 0),
            tzinfo=UTC,
        )
    except ValueError:
        return None
    return at.timestamp() + float(f"0.{fraction}" if fraction else 0) - _offset_s(*offset)


def _offset_s(sign: str | None, hours: str | None, minutes: str | None) -> int:
    """The offset of a stamp from UTC: it may change within a file, as at the change to summer time."""
    seconds = 3600 * int(hours or 0) + 60 * int(minutes or 0)
    return -seconds if sign == "-" else seconds


def clock_column(path: Path, name: str, cells: Sequence[str], where: Sequence[int]) -> Array:
    """Seconds (n,) from the first reading of a column of clock times; midnight is passed over. DataError with line."""
    orders = _ORDERS if any(_SHORT_FIRST.match(cell) for cell in cells[:1]) else ("",)
    out = min((_seconds(cells, order) for order in orders), key=_unlikely)
    for k in np.flatnonzero(np.isnan(out)).tolist():
        if not is_missing(cells[k]):
            raise DataError(
                f"{path}, line {where[k]}, column {shown(name)}: {shown(cells[k], 40)} is not a time."
            )
    known = out[np.isfinite(out)]
    if known.size and known.max() <= 86400:  # times of day
        days = np.cumsum(np.diff(out, prepend=out[:1]) < -43200)
        out = out + 86400 * days
    return out - (known[0] if known.size else 0.0)


def _seconds(cells: Sequence[str], order: str) -> Array:
    found = [clock_seconds(cell, order) for cell in cells]
    return np.array([np.nan if seconds is None else seconds for seconds in found], dtype=float)


def _unlikely(x: Array) -> tuple[int, int, float]:
    """How unlikely a reading of the dates of a column is: rows that are no dates in it, steps back in time, and the
    way through time. Past midnight, 21-04-08 follows 21-04-07 by a day as year, month and day, else by a year.
    """
    steps = np.diff(x[np.isfinite(x)])
    return int(np.isnan(x).sum()), int((steps < 0).sum()), float(np.abs(steps).sum())

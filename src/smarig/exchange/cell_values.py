"""Numbers from the cells of a table: decimal sign, thousands, clock times, and words for a missing value."""

import math
import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError, number_from_text, shown
from smarig.exchange.no_reading import is_mark, without_marks

MISSING = {
    *(
        "",
        "nan",
        "na",
        "n/a",
        "#n/a",
        "#na",
        "#nv",
        "null",
        "none",
        "-",
        "--",
        "---",
        "?",
        "inf",
        "-inf",
        "+inf",
    ),
    *(
        "overflow",
        "overload",
        "ovld",
        "invalid",
        "error",
        "#div/0!",
        "#value!",
        "#ref!",
        "#num!",
    ),
}
_NOT_A_NUMBER = re.compile(
    r"[+-]?(nan(\([a-z0-9]*\))?|1\.#(?!inf)[a-z]{1,4}0*)", re.IGNORECASE
)  # as C libraries write it: -nan(ind), nan(snan), 1.#QNAN, -1.#IND00, and -1.#J with two decimals
_INFINITE = {
    "inf",
    "-inf",
    "+inf",
}  # a missing value while a table is searched for; an error where it is read
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(e[+-]?\d+)?", re.IGNORECASE)
_THOUSANDS = {",": ",", ".": r"\.", "'": "['’]", "space": r"[\s\u00a0\u202f]"}
_CLOCK = re.compile(r"(?:(\d{1,9})[ T])?(\d{1,3}):(\d{2})(?::(\d{2})(?:[.,:](\d+))?)?")
_DATE = re.compile(
    r"(\d{1,4})[./-](\d{1,2})[./-](\d{1,4})[ T,;]+(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,](\d+))?)?"
    r"(?:\s*([AaPp][Mm]))?(?:Z|[+-]\d{2}:?\d{2})?"
)
_SHORT_YEAR = re.compile(r"'?\d{1,2}[./-]\d{1,2}[./-]\d{2}\b")


def plain_number(cell: str, decimal: str, thousands: str = "") -> str:
    """The text of a number as Python writes it.

    >>> plain_number("1.234,5", ",", "."), plain_number("12,5", ","), plain_number("1'000.5", ".", "'")
    ('1234.5', '12.5', '1000.5')
    """
    if thousands and re.fullmatch(
        rf"[+-]?\d{{1,3}}({_THOUSANDS[thousands]}\d{{3}})+(\{decimal}\d*)?([eE][+-]?\d+)?", cell
    ):
        cell = re.sub(_THOUSANDS[thousands], "", cell)
    return cell.replace(",", ".") if decimal == "," and "." not in cell else cell


def is_number(cell: str, decimal: str, thousands: str = "") -> bool:
    """Whether a cell holds a finite or missing number that is written as one.

    >>> is_number("1,5", ","), is_number("1,5", "."), is_number("nan", ".")
    (True, False, False)
    """
    try:
        value = number_from_text(plain_number(cell, decimal, thousands))
    except ValueError:
        return False
    return math.isfinite(value)


def has_thousands(lines: Iterable[str], thousands: str) -> bool:
    """Whether a number in these lines may have such a sign between its thousands.

    >>> has_thousands(["1'000;2"], "'"), has_thousands(["1.5;2"], ".")
    (True, False)
    """
    divided = re.compile(rf"\d{_THOUSANDS[thousands]}\d{{3}}")
    return any(divided.search(line) for line in lines)


def is_missing(cell: str) -> bool:
    """Whether a cell says that there is no value.

    >>> is_missing("n/a"), is_missing("-1.#IND"), is_missing("0")
    (True, True, False)
    """
    return cell.lower() in MISSING or _NOT_A_NUMBER.fullmatch(cell) is not None or is_mark(cell)


def clock_seconds(cell: str, *, year_first: bool = False) -> float | None:
    """Seconds of a time of day, a duration, or a date with a time (from 1970, without its zone); None for other texts.

    A date of day, month and year in numbers is read in that order unless the year comes first or the month is above 12;
    ``year_first``: so is a year of two digits. An apostrophe before it, which keeps a spreadsheet from changing it, is
    left out.

    >>> clock_seconds("00:01:30.5"), clock_seconds("1970-01-01 00:00:02"), clock_seconds("12.5")
    (90.5, 2.0, None)
    """
    text = cell.strip().removeprefix("'")
    if match := _CLOCK.fullmatch(text):
        days, hours, minutes, seconds, fraction = match.groups()
        whole = 86400 * int(days or 0) + 3600 * int(hours) + 60 * int(minutes) + int(seconds or 0)
        return whole + float(f"0.{fraction}" if fraction else 0)
    match = _DATE.fullmatch(text)
    if match is None:
        return None
    a, b, c, hour, minute, second, fraction, half = match.groups()
    year, month, day = (a, b, c) if len(a) == 4 or (year_first and len(c) < 3) else (c, b, a)
    if int(month) > 12:
        month, day = day, month
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
    return at.timestamp() + float(f"0.{fraction}" if fraction else 0)


def clock_column(path: Path, name: str, cells: Sequence[str], where: Sequence[int]) -> NDArray[np.float64]:
    """Seconds (n,) from the first reading of a column of clock times; midnight is passed over. DataError with line."""
    out = _seconds(cells)
    for k in np.flatnonzero(np.isnan(out)).tolist():
        if not is_missing(cells[k]):
            raise DataError(
                f"{path}, line {where[k]}, column {shown(name)}: {shown(cells[k], 40)} is not a time."
            )
    if any(_SHORT_YEAR.match(cell) for cell in cells[:1]):
        out = _of_shortest(out, _seconds(cells, year_first=True))
    known = out[np.isfinite(out)]
    if known.size and known.max() <= 86400:  # times of day
        days = np.cumsum(np.diff(out, prepend=out[:1]) < -43200)
        out = out + 86400 * days
    return out - (known[0] if known.size else 0.0)


def _seconds(cells: Sequence[str], *, year_first: bool = False) -> NDArray[np.float64]:
    found = [clock_seconds(cell, year_first=year_first) for cell in cells]
    return np.array([np.nan if seconds is None else seconds for seconds in found], dtype=float)


def _of_shortest(first: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of two readings of the dates of a column, the one in which its rows follow each other sooner: past midnight,
    21-04-08 follows 21-04-07 by a day as year, month and day, and by a year in the other order.
    """
    apart = [np.abs(np.diff(x[np.isfinite(x)])).sum() for x in (first, other)]
    same = np.isfinite(first).sum() == np.isfinite(other).sum()
    return other if same and apart[1] < apart[0] else first


def number_column(
    path: Path,
    name: str,
    cells: Sequence[str],
    where: Sequence[int],
    decimal: str,
    *,
    thousands: str = "",
    lenient: bool = False,
) -> NDArray[np.float64]:
    """The numbers of a column's cells, NaN for those that say that there is none; ``lenient``: for any other text."""
    out = np.empty(len(cells))
    for k, cell in enumerate(cells):
        try:
            out[k] = number_from_text(plain_number(cell, decimal, thousands))
        except ValueError:
            if not lenient and not is_missing(cell):
                hint = "; declare decimal = ',' in a mapping file" if _DECIMAL_COMMA.fullmatch(cell) else ""
                raise DataError(
                    f"{path}, line {where[k]}, column {shown(name)}: {shown(cell, 40)} is not a number{hint}."
                ) from None
            out[k] = np.nan
    if lenient:
        out[np.isinf(out)] = np.nan
    if np.isinf(out).any():
        raise DataError(
            f"{path}, line {where[int(np.argmax(np.isinf(out)))]}, column {shown(name)} is infinite."
        )
    return without_marks(out)

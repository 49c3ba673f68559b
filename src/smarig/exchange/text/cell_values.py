"""Numbers from the cells of a table: decimal sign and thousands."""

import math
import re
from collections.abc import Collection, Iterable, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, number_from_text, shown
from smarig.exchange.text.no_reading import is_missing, without_marks

_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(e[+-]?\d+)?", re.IGNORECASE)
_THOUSANDS = {",": ",", ".": r"\.", "'": "['’]", "space": r"[\s\u00a0\u202f]"}


def plain_number(cell: str, decimal: str, thousands: str = "") -> str:
    """The text of a number as Python writes it.

    >>> plain_number("1.234,5", ",", "."), plain_number("12,5", ","), plain_number("1'000.5", ".", "'")
    ('1234.5', '12.5', '1000.5')
    """
    if thousands and _divided(decimal, thousands).fullmatch(cell):
        cell = re.sub(_THOUSANDS[thousands], "", cell)
    return cell.replace(",", ".") if decimal == "," and "." not in cell else cell


@cache
def _divided(decimal: str, thousands: str) -> re.Pattern[str]:
    return re.compile(rf"[+-]?\d{{1,3}}({_THOUSANDS[thousands]}\d{{3}})+(\{decimal}\d*)?([eE][+-]?\d+)?")


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


def is_number_with_any_sign(cell: str) -> bool:
    """Whether a cell is a number with a decimal point or a decimal comma.

    >>> is_number_with_any_sign("1.5"), is_number_with_any_sign("1,5"), is_number_with_any_sign("on")
    (True, True, False)
    """
    return is_number(cell, ".") or is_number(cell, ",")


def number_column(
    path: Path,
    name: str,
    cells: Sequence[str],
    where: Sequence[int],
    decimal: str,
    *,
    thousands: str = "",
    lenient: bool = False,
    no_reading: Collection[str] = (),
) -> Array:
    """The numbers of a column's cells, NaN for those that say that there is none, as the texts ``no_reading`` do;
    ``lenient``: for any other text.
    """
    out = np.empty(len(cells))
    for k, cell in enumerate(cells):
        try:
            out[k] = number_from_text(plain_number(cell, decimal, thousands))
        except ValueError:
            if not (lenient or is_missing(cell) or cell in no_reading):
                hint = "; declare decimal = ',' in a mapping file" if _DECIMAL_COMMA.fullmatch(cell) else ""
                raise DataError(
                    f"{path}, line {where[k]}, column {shown(name)}: {shown(cell, 40)} is not a number{hint}."
                ) from None
            out[k] = np.nan
    return without_marks(out)

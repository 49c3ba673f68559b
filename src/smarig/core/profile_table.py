"""Reads the numbers of a profile from a CSV file with one header line."""

import csv
from pathlib import Path

import numpy as np

from smarig.core.array import Array
from smarig.core.errors import DataError, UsageError
from smarig.core.file_content import TABLE
from smarig.core.number_text import number_from_text
from smarig.core.regular_file import check_file
from smarig.core.swapped_file import swapped_file

_LARGEST_BYTES = 10_000_000


def profile_rows(path: Path) -> list[list[str]]:
    """The cells of a CSV file, line by line. UsageError if it cannot be read, DataError if it is no text table."""
    check_file(path, "table")
    if path.stat().st_size > _LARGEST_BYTES:
        raise UsageError(f"Table {path} is larger than {_LARGEST_BYTES // 10**6} MB. Shorten it.")
    if swapped := swapped_file(path, TABLE):
        raise DataError(swapped)
    try:
        with path.open(newline="", encoding="utf-8-sig") as lines:
            return list(csv.reader(lines))
    except OSError as error:
        raise UsageError(f"Table {path} cannot be read: {error.strerror}.") from None
    except (UnicodeDecodeError, csv.Error):
        raise DataError(f"Table {path} is not a text table.") from None


def profile_numbers(path: Path, rows: list[list[str]], columns: int) -> Array:
    """The first ``columns`` of all rows after the header, (n, columns). DataError names the line of a wrong cell."""
    values = []
    for number, row in enumerate(rows[1:], start=2):
        try:
            values.append([number_from_text(row[k].strip()) for k in range(columns)])
        except (ValueError, IndexError):
            cells = ",".join(row)
            raise DataError(f"Table {path}, line {number}: '{cells:.40}' is not a number.") from None
    if not values:
        raise DataError(f"Table {path} has a header but no values.")
    return np.array(values)

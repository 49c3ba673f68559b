"""Reads a profile of ``step_currents`` from a CSV file: a list of values, or a temperature as a function of time."""

import csv
from pathlib import Path

import numpy as np

from smarig.core import DataError, UsageError, number_from_text
from smarig.protocols._building_blocks import checked_count

_LARGEST_BYTES = 10_000_000
Values = tuple[float, ...]


def profile_from_csv(path: Path, points: int) -> tuple[Values, Values]:
    """(temperatures, currents), one of them empty. A file with time_s is sampled at ``points`` even times.

    Raises UsageError if the file cannot be read, DataError for a wrong header, cell or order of times.
    """
    rows = _rows(path)
    header = [name.strip() for name in rows[0]] if rows else []
    if header[:1] == ["time_s"]:
        if header != ["time_s", "temperature_K"]:
            raise DataError(f"Profile {path} with time_s must have the columns time_s and temperature_K.")
        return _sampled(path, _numbers(path, rows, 2), points), ()
    name = header[0] if header else ""
    if name not in ("temperature_K", "current_A"):
        raise DataError(
            f"Profile {path} must begin with a header temperature_K or current_A, found '{name:.40}'."
        )
    values = tuple(_numbers(path, rows, 1)[:, 0].tolist())
    return (values, ()) if name == "temperature_K" else ((), values)


def _rows(path: Path) -> list[list[str]]:
    if not path.is_file() or path.stat().st_size > _LARGEST_BYTES:
        raise UsageError(f"Profile {path} cannot be read: the file is missing or larger than 10 MB.")
    try:
        with path.open(newline="", encoding="utf-8-sig") as lines:
            return list(csv.reader(lines))
    except OSError as error:
        raise UsageError(f"Profile {path} cannot be read: {error.strerror}.") from None
    except (UnicodeDecodeError, csv.Error):
        raise DataError(f"Profile {path} is not a text table.") from None


def _numbers(path: Path, rows: list[list[str]], columns: int) -> np.ndarray:
    values = []
    for number, row in enumerate(rows[1:], start=2):
        try:
            values.append([number_from_text(row[k].strip()) for k in range(columns)])
        except (ValueError, IndexError):
            cells = ",".join(row)
            raise DataError(f"Profile {path}, line {number}: '{cells:.40}' is not a number.") from None
    if not values:
        raise DataError(f"Profile {path} has a header but no values.")
    return np.array(values)


def _sampled(path: Path, table: np.ndarray, points: int) -> Values:
    checked_count("points", points, 2, 100_000)
    t_s, temperature_K = table.T
    if t_s.size < 2 or not np.isfinite(table).all() or np.any(np.diff(t_s) <= 0):
        raise DataError(f"Profile {path} needs at least two rows with finite values and increasing times.")
    return tuple(np.interp(np.linspace(t_s[0], t_s[-1], points), t_s, temperature_K).tolist())

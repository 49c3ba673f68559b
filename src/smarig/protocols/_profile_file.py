"""Reads a profile of ``step_currents`` from a CSV file: a list of values, or a temperature as a function of time."""

from pathlib import Path

import numpy as np

from smarig.core import DataError, profile_numbers, profile_rows
from smarig.protocols._building_blocks import checked_count

Values = tuple[float, ...]


def profile_from_csv(path: Path, points: int) -> tuple[Values, Values]:
    """(temperatures, currents), one of them empty. A file with time_s is sampled at ``points`` even times.

    Raises UsageError if the file cannot be read, DataError for a wrong header, cell or order of times.
    """
    rows = profile_rows(path)
    header = [name.strip() for name in rows[0]] if rows else []
    if header[:1] == ["time_s"]:
        if header != ["time_s", "temperature_K"]:
            raise DataError(f"Profile {path} with time_s must have the columns time_s and temperature_K.")
        return _sampled(path, profile_numbers(path, rows, 2), points), ()
    name = header[0] if header else ""
    if name not in ("temperature_K", "current_A"):
        raise DataError(
            f"Profile {path} must begin with a header temperature_K or current_A, found '{name:.40}'."
        )
    values = tuple(profile_numbers(path, rows, 1)[:, 0].tolist())
    return (values, ()) if name == "temperature_K" else ((), values)


def _sampled(path: Path, table: np.ndarray, points: int) -> Values:
    checked_count("points", points, 2, 100_000)
    t_s, temperature_K = table.T
    if t_s.size < 2 or not np.isfinite(table).all() or np.any(np.diff(t_s) <= 0):
        raise DataError(f"Profile {path} needs at least two rows with finite values and increasing times.")
    return tuple(np.interp(np.linspace(t_s[0], t_s[-1], points), t_s, temperature_K).tolist())

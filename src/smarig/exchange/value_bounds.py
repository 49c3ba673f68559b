"""Bounds of plausible values: a value outside them indicates a wrong unit, or a mark for a missing reading."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError, spaced
from smarig.record import LARGEST

Array = NDArray[np.float64]
LONGEST_S = 1e14  # three million years: milliseconds since 1970 are allowed
_LARGEST_MARK = 1e39  # instruments write numbers up to the largest of 32 bits for overload or no reading
_BOUNDS = {  # channel: (lowest, highest, unit), with a wide margin
    "t_s": (-LONGEST_S, LONGEST_S, "s"),
    "current_command_A": (-100.0, 100.0, "A"),
    "current_A": (-100.0, 100.0, "A"),
    "voltage_V": (-1000.0, 1000.0, "V"),
    "temperature_degC": (-273.15, 1500.0, "degC"),
    "ambient_degC": (-90.0, 90.0, "degC"),
}
_STRAIN_MAX = 0.2  # recoverable strain of shape-memory alloys is below 0.1
_STRAIN_RANGE_MIN = 1e-3  # less than thermal expansion over 100 K


def check_bounds(path: Path, channel: str, column: str, x: Array, line: NDArray[np.int64]) -> None:
    """Raise DataError with line and column for a value outside the channel's bounds."""
    low, high, unit = _BOUNDS.get(channel, (-LARGEST, LARGEST, ""))
    bad = np.flatnonzero((x < low) | (x > high))
    if bad.size:
        raise DataError(
            f"{path}, line {line[bad[0]]}, column '{column}': {x[bad[0]]:g}{spaced(unit)} as {channel} lies outside "
            f"{low:g} … {high:g}{spaced(unit)}. Is the unit right?"
        )


def check_size(
    path: Path, column: str, x: Array, line: NDArray[np.int64] | None = None, *, marks: bool = False
) -> None:
    """Raise DataError with line (or row) and column for a value that is too large to be measured in any unit.

    ``marks``: numbers such as 9.91e37, which instruments write where there is no reading, are allowed.
    """
    bad = np.flatnonzero(np.abs(x) > (_LARGEST_MARK if marks else LARGEST))
    if bad.size:
        where = f"row {bad[0] + 1}" if line is None else f"line {line[bad[0]]}"
        raise DataError(
            f"{path}, {where}, column '{column}': {x[bad[0]]:g} is no measured value (at most {LARGEST:g}). "
            "Leave the cell empty if there was no reading."
        )


def plausible(x: Array) -> Array:
    """The values (n,) with NaN for those that are infinite or too large to be measured.

    >>> plausible(np.array([1.0, -2.0, 9.91e37])).tolist()
    [1.0, -2.0, nan]
    """
    return np.where(np.abs(x) <= LARGEST, x, np.nan)


def check_strain(path: Path, column: str, strain: Array) -> list[str]:
    """Check strain (n,) in mm/mm: DataError above 20 %, a finding if the whole range is below 0.1 %."""
    if np.nanmax(np.abs(strain)) > _STRAIN_MAX:
        raise DataError(
            f"{path}, column '{column}': a strain of {np.nanmax(np.abs(strain)):.3g} mm/mm is more than any "
            f"shape-memory alloy recovers. Is the column in %?"
        )
    span = float(np.nanmax(strain) - np.nanmin(strain))
    if span < _STRAIN_RANGE_MIN:
        return [
            f"The strain covers only {100 * span:.3g} %, no more than thermal expansion. Is the unit right?"
        ]
    return []

"""Bounds of plausible values: many values outside them indicate a wrong unit, a few the marks of failed readings."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, shown, spaced
from smarig.exchange.checks.channel_faults import error_codes, lost_decimals
from smarig.exchange.units.unit_conversion import convert
from smarig.record import LARGEST, ImportFinding

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
FEW = 0.03  # of the readings: more impossible ones say that the unit is wrong
_STRAIN_MAX = 0.2  # recoverable strain of shape-memory alloys is below 0.1
_STRAIN_RANGE_MIN = 1e-3  # less than thermal expansion over 100 K


def check_bounds(path: Path, channel: str, column: str, x: Array, line: NDArray[np.int64]) -> None:
    """Raise DataError with line and column for a value outside the channel's bounds."""
    low, high, unit = _BOUNDS.get(channel, (-LARGEST, LARGEST, ""))
    bad = np.flatnonzero((x < low) | (x > high))
    if bad.size:
        raise DataError(
            f"{path}, line {line[bad[0]]}, column {shown(column)}: {x[bad[0]]:g}{spaced(unit)} as {channel} lies "
            f"outside {low:g} … {high:g}{spaced(unit)}. Is the unit right?"
        )


def possible(
    path: Path, channel: str, column: str, x: Array, line: NDArray[np.int64], strain: str = ""
) -> tuple[Array, list[ImportFinding]]:
    """The values (n,) with NaN for the few that no sensor can have read, and a finding on them.

    ``strain``: the unit, if the channel is one. DataError as of ``check_bounds`` if they are more than a few.
    """
    low, high, unit = _BOUNDS.get(channel, (-LARGEST, LARGEST, ""))
    if strain:
        most = float(convert(_STRAIN_MAX, "mm/mm", strain))
        low, high, unit = -most, most, strain
    bad = (x < low) | (x > high)
    if not bad.any():
        return x, []
    count, readings = int(bad.sum()), x.size
    if count > FEW * readings:
        check_bounds(path, channel, column, x, line)
        return x, []
    first = f"{x[bad][0]:g}{spaced(unit)} in line {line[bad][0]}"
    what = f"1 reading of {readings} is" if count == 1 else f"{count} readings of {readings} are"
    text = (
        f"{what} masked: {first}{' and further ones' if count > 1 else ''}, outside {low:g} … {high:g}{spaced(unit)} "
        f"(column {shown(column)})."
    )
    return np.where(bad, np.nan, x), [ImportFinding(text, "impossible readings")]


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
            f"{path}, {where}, column {shown(column)}: {x[bad[0]]:g} is no measured value (at most {LARGEST:g}). "
            "Leave the cell empty if there was no reading."
        )


def without_codes(
    column: str, x: Array, written: Array, line: NDArray[np.int64]
) -> tuple[Array, list[ImportFinding]]:
    """The values (n,) with NaN for a code of an error that is repeated in single rows, and for numbers that lost their
    decimal sign, with a finding on each; ``written`` are the values in the unit of the file.
    """
    x, slips = _without_slips(column, x, written, line)
    codes = error_codes(np.where(np.isfinite(x), written, np.nan))
    if not codes.any():
        return x, slips
    values = " and ".join(f"{value:g}" for value in np.unique(written[codes]))
    text = (
        f"{int(codes.sum())} readings of {x.size} are masked: {values} in single rows, the first in line "
        f"{line[codes][0]}, beyond all other readings (column {shown(column)})."
    )
    return np.where(codes, np.nan, x), [*slips, ImportFinding(text, "impossible readings")]


def _without_slips(
    column: str, x: Array, written: Array, line: NDArray[np.int64]
) -> tuple[Array, list[ImportFinding]]:
    """The values (n,) with NaN for numbers that lost their decimal sign, and a finding on each."""
    slips = lost_decimals(np.where(np.isfinite(x), written, np.nan))
    texts = [
        f"{value:g} in line {k} is masked: its decimal sign is missing, as its neighbours show (column "
        f"{shown(column)})."
        for value, k in zip(written[slips], line[slips])
    ]
    return np.where(slips, np.nan, x), [ImportFinding(text, "impossible readings") for text in texts]


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
            f"{path}, column {shown(column)}: a strain of {np.nanmax(np.abs(strain)):.3g} mm/mm is more than any "
            f"shape-memory alloy recovers. Is the column in %?"
        )
    span = float(np.nanmax(strain) - np.nanmin(strain))
    if span < _STRAIN_RANGE_MIN:
        return [
            f"The strain covers only {100 * span:.3g} %, no more than thermal expansion. Is the unit right?"
        ]
    return []

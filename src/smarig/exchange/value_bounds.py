"""Bounds of plausible values: a value outside them indicates a wrong unit."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError, spaced

Array = NDArray[np.float64]
_BOUNDS = {  # channel: (lowest, highest, unit), with a wide margin
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
    low, high, unit = _BOUNDS.get(channel, (-np.inf, np.inf, ""))
    bad = np.flatnonzero((x < low) | (x > high))
    if bad.size:
        raise DataError(
            f"{path}, line {line[bad[0]]}, column '{column}': {x[bad[0]]:g}{spaced(unit)} as {channel} lies outside "
            f"{low:g} … {high:g}{spaced(unit)}. Is the unit right?"
        )


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

"""Temperatures that a digital thermometer writes where it has no reading: −127 °C and 85 °C of a DS18B20."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, shown
from smarig.exchange.checks.dropped_readings import drops
from smarig.exchange.checks.value_bounds import FEW
from smarig.exchange.units.unit_conversion import convert, dimension
from smarig.record import ImportFinding

_NO_ANSWER, _POWER_ON = -127.0, 85.0  # °C
_WHEN = {_NO_ANSWER: "does not answer", _POWER_ON: "was switched on and has measured nothing yet"}
_DIGITS = 6  # behind the point, in which a code in °F or K is equal to that in °C


def without_thermometer_codes(
    column: str, unit: str, x: Array, line: NDArray[np.int64]
) -> tuple[Array, list[ImportFinding]]:
    """The values (n,) in ``unit`` with NaN for the codes of a thermometer, and a finding on each code."""
    if dimension(unit) != "temperature":
        return x, []
    celsius, found = np.round(convert(x, unit, "degC"), _DIGITS), list[ImportFinding]()
    for code, mask in ((_NO_ANSWER, drops), (_POWER_ON, _power_on)):
        rows = mask(celsius, code)
        if rows.any():
            found.append(ImportFinding(_text(column, code, rows, line), "drop-outs"))
        celsius = np.where(rows, np.nan, celsius)
    return np.where(np.isnan(celsius), np.nan, x), found


def _power_on(celsius: Array, code: float) -> NDArray[np.bool_]:
    """Mask of single readings (n,) of ``code``, if they are few: a wire can be held at 85 °C, or heated to it again and
    again.
    """
    rows, is_code = drops(celsius, code), np.pad(celsius == code, 1)
    single = rows & ~is_code[:-2] & ~is_code[2:]
    return single if single.sum() <= FEW * celsius.size else np.zeros(celsius.size, dtype=bool)


def _text(column: str, code: float, rows: NDArray[np.bool_], line: NDArray[np.int64]) -> str:
    return (
        f"Column {shown(column)}: {int(rows.sum())} of {rows.size} readings are masked, because they are exactly "
        f"{code:g} degC, far from the rows around them (first: line {line[rows][0]}). "
        f"A DS18B20 thermometer gives this value when it {_WHEN[code]}."
    )

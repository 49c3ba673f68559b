"""Units of data files and their conversion.

Fields are compared in vacuum: 1 Oe ↔ 1e-4 T ↔ 1e3/(4π) A/m.
"""

import math
from typing import Any

from smarig.core import UsageError, suggestion

_MU_0 = 4e-7 * math.pi

# unit: (dimension, factor, offset); value in the dimension's first unit = factor × value + offset
_UNITS: dict[str, tuple[str, float, float]] = {
    "s": ("time", 1.0, 0.0),
    "ms": ("time", 1e-3, 0.0),
    "us": ("time", 1e-6, 0.0),
    "min": ("time", 60.0, 0.0),
    "h": ("time", 3600.0, 0.0),
    "A": ("current", 1.0, 0.0),
    "mA": ("current", 1e-3, 0.0),
    "V": ("voltage", 1.0, 0.0),
    "mV": ("voltage", 1e-3, 0.0),
    "kV": ("voltage", 1e3, 0.0),
    "degC": ("temperature", 1.0, 0.0),
    "K": ("temperature", 1.0, -273.15),
    "degF": ("temperature", 5 / 9, -160 / 9),
    "mm": ("length", 1.0, 0.0),
    "um": ("length", 1e-3, 0.0),
    "nm": ("length", 1e-6, 0.0),
    "m": ("length", 1e3, 0.0),
    "deg": ("angle", 1.0, 0.0),
    "rad": ("angle", 180 / math.pi, 0.0),
    "count": ("raw counts", 1.0, 0.0),
    "mm/mm": ("ratio", 1.0, 0.0),
    "1": ("ratio", 1.0, 0.0),
    "%": ("ratio", 1e-2, 0.0),
    "MPa": ("stress", 1.0, 0.0),
    "kPa": ("stress", 1e-3, 0.0),
    "GPa": ("stress", 1e3, 0.0),
    "N": ("force", 1.0, 0.0),
    "kN": ("force", 1e3, 0.0),
    "Hz": ("frequency", 1.0, 0.0),
    "mHz": ("frequency", 1e-3, 0.0),
    "T": ("magnetic field", 1.0, 0.0),
    "mT": ("magnetic field", 1e-3, 0.0),
    "Oe": ("magnetic field", 1e-4, 0.0),
    "A/m": ("magnetic field", _MU_0, 0.0),
    "A m^2": ("magnetic moment", 1.0, 0.0),
    "emu": ("magnetic moment", 1e-3, 0.0),
    "uC/cm^2": ("polarisation", 1.0, 0.0),
    "C/m^2": ("polarisation", 100.0, 0.0),
}


def dimension(unit: str) -> str:
    """The quantity that a unit measures; UsageError with the nearest unit if it is unknown.

    >>> dimension("Oe")
    'magnetic field'
    """
    if unit not in _UNITS:
        raise UsageError(f"unit '{unit}' is unknown{suggestion(unit, list(_UNITS))}")
    return _UNITS[unit][0]


def convert(values: Any, unit: str, to: str) -> Any:
    """Convert ``values`` (number or array) from ``unit`` to ``to``; UsageError if they measure different
    quantities.

    >>> convert(300.0, "K", "degC"), convert(1.5, "%", "mm/mm")
    (26.85..., 0.015)
    """
    if dimension(unit) != dimension(to):
        raise UsageError(f"'{unit}' is a unit of {dimension(unit)}, '{to}' is a unit of {dimension(to)}")
    if unit == to:
        return values
    (_, a, b), (_, c, d) = _UNITS[unit], _UNITS[to]
    return (a * values + b - d) / c

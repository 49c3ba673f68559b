"""Conversion of the units of data files.

Fields are compared in vacuum: 1 Oe ↔ 1e-4 T ↔ 1e3/(4π) A/m. An unknown unit is a quantity of its own: its values stay
as they are.
"""

from collections.abc import Sequence
from typing import Any

from smarig.core import UsageError, shown
from smarig.exchange.units.units import UNITS, meant, spelled


def dimension(unit: str) -> str:
    """The quantity that a unit measures; that of an unknown unit is the unit itself.

    >>> dimension("Oe"), dimension("beats")
    ('magnetic field', 'beats')
    """
    return UNITS[spelled(unit)][0] if spelled(unit) in UNITS else spelled(unit)


def check_unit(unit: str, own: Sequence[str] = ()) -> None:
    """Raise UsageError for an unknown unit that is a slip of a known one, unless it is listed in ``own``."""
    if spelled(unit) in UNITS or unit in own:
        return
    if near := meant(unit):
        raise UsageError(
            f"unit {shown(unit)} is unknown; did you mean {near}? To use {shown(unit)} as it is, add the line "
            f'own_units = ["{unit}"] above the tables of the mapping'
        )


def convert(values: Any, unit: str, to: str) -> Any:
    """Convert ``values`` (number or array) from ``unit`` to ``to``; UsageError if they measure different
    quantities.

    >>> convert(300.0, "K", "degC"), convert(1.5, "%", "mm/mm")
    (26.85..., 0.015)
    """
    check_same_quantity(unit, to)
    if spelled(unit) == spelled(to):
        return values
    (_, a, b), (_, c, d) = UNITS[spelled(unit)], UNITS[spelled(to)]
    return (a * values + b - d) / c


def check_same_quantity(unit: str, to: str) -> None:
    """Raise UsageError if two units measure different quantities, or if one is unknown and the other is not it."""
    if dimension(unit) == dimension(to):
        return
    for one, other in ((unit, to), (to, unit)):
        if spelled(one) not in UNITS:
            raise UsageError(f"unit {shown(one)} is unknown and cannot be converted to {shown(other)}")
    raise UsageError(
        f"{shown(unit)} is a unit of {dimension(unit)}, but a unit of {dimension(to)} was expected"
    )

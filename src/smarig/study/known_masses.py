"""Masses that load a sensor, as those of calibration weights, are the input; a mass that something changes is none."""

from collections.abc import Sequence

from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess, as_force_reading

_CHANGES_MASS = (  # of a specimen on a balance
    q.TEMPERATURE,
    q.HUMIDITY,
    q.RELATIVE_PRESSURE,
    q.PRESSURE,
    q.FIELD,
    q.CURRENT,
)


def known_mass(columns: Sequence[ColumnGuess]) -> ColumnGuess | None:
    """The column of the masses that load a sensor: no other quantity that a name states moves and changes them."""
    moving = [c for c in columns if c.facts.known.size and not c.facts.constant and not c.by_numbers]
    if any(c.quantity in _CHANGES_MASS for c in moving):
        return None
    return next((c for c in moving if c.quantity == q.MASS), None)


def with_read_masses(columns: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The columns; beside known masses, whole numbers without a meaning are the readings of a sensor of force."""
    if known_mass(columns) is None:
        return list(columns)
    return [as_force_reading(c) if c.by_numbers and c.quantity not in q.NO_SIGNALS else c for c in columns]

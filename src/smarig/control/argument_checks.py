"""Checks of numbers from Python callers; invalid numbers raise UsageError.

``controller_settings`` reads texts of the command line.
"""

from math import isfinite
from numbers import Real

from smarig.core import UsageError


def positive(name: str, value: float) -> float:
    """The number. Raises UsageError unless it is positive and finite."""
    if not (isinstance(value, Real) and isfinite(value) and value > 0):
        raise UsageError(f"{name} must be a positive number, got {value}.")
    return float(value)


def not_negative(name: str, value: float) -> float:
    """The number. Raises UsageError unless it is finite and not negative."""
    if finite(name, value) < 0:
        raise UsageError(f"{name} must not be negative, got {value:g}.")
    return float(value)


def finite(name: str, value: float) -> float:
    """The number. Raises UsageError unless it is a finite number."""
    if not (isinstance(value, Real) and isfinite(value)):
        raise UsageError(f"{name} must be a finite number, got {value}.")
    return float(value)

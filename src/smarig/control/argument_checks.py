"""Numbers that a Python caller gives, as they are: UsageError for what nothing can be computed with.

Texts of a command line are read by ``settings`` instead.
"""

from math import isfinite
from numbers import Real

from smarig.core import UsageError


def positive(name: str, value: float) -> float:
    """UsageError unless it is a positive, finite number."""
    if not (isinstance(value, Real) and isfinite(value) and value > 0):
        raise UsageError(f"{name} must be a positive number, got {value}.")
    return float(value)


def not_negative(name: str, value: float) -> float:
    """UsageError unless it is a finite number from 0 on."""
    if finite(name, value) < 0:
        raise UsageError(f"{name} must not be negative, got {value:g}.")
    return float(value)


def finite(name: str, value: float) -> float:
    """UsageError for what is no number, and for numbers that nothing can be computed with."""
    if not (isinstance(value, Real) and isfinite(value)):
        raise UsageError(f"{name} must be a finite number, got {value}.")
    return float(value)

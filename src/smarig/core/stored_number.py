"""Numbers of model files: finite, and of a size that something measured can have."""

from typing import Any

from smarig.core.errors import DataError

LARGEST = 1e12


def stored_number(value: Any, name: str) -> float:
    """The number. Raises DataError for anything else, with the name of what holds it.

    >>> stored_number(3, "a knot")
    3.0
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
        raise DataError(f"{name} is not a number of plausible size: {value!r:.40}")
    return float(value)

"""Reads the values of a trace."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.report.components.figure import unpacked

Values = NDArray[Any]


def values(trace: dict[str, Any], key: str) -> Values:
    """The values under a key of a trace, or of its bars or markers: packed, numbers, or names."""
    given = trace[key]
    if isinstance(given, dict):
        return unpacked(given)
    return np.asarray(given)


def is_shown(trace: dict[str, Any]) -> bool:
    """Whether a trace is visible."""
    return trace.get("visible", True) is True

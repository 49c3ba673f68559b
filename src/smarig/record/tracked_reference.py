"""The reference of a tracked run as a column: what the position was to be at each sample."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from smarig.core import Array, DataError

REFERENCE = "reference"


def reference_column(t_s: Array, mark: Mapping[str, Any]) -> Array:
    """Positions (n,) at times (n,), in the unit of the run; NaN before and after the loop was closed.

    ``mark``: ``start_s`` and ``reference``, with times from there, positions, and whether each is held to the next.
    """
    try:
        reference = mark[REFERENCE]
        times, positions = (np.asarray(reference[k], dtype=float) for k in ("t_s", "position"))
        since, held = t_s - float(mark["start_s"]), bool(reference["held"])
        if held:  # the last position belongs to no step
            at = np.searchsorted(times, since, side="right") - 1
            found = positions[np.clip(at, 0, positions.size - 2)]
        else:
            found = np.interp(since, times, positions)
        return np.where((since >= 0) & (since <= times[-1]), found, np.nan)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DataError(f"The reference in this run is damaged ({error}).") from None

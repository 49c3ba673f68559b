"""Counts of a position whose register passes its ends, as those of an encoder of 12 bits from 4095 to 0: continued."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, shown
from smarig.record import ImportFinding, remarks

_FEWEST_BITS, _MOST_BITS = 8, 32


def continued_counts(x: Array) -> Array:
    """Whole numbers (n,) that jump by a register's number of values, less a step that they make elsewhere, without the
    jumps; others as they are, and NaN where they are.

    >>> continued_counts(np.array([4080.0, 4088.0, 2.0, 11.0, 3.0, 4090.0])).tolist()
    [4080.0, 4088.0, 4098.0, 4107.0, 4099.0, 4090.0]
    """
    known = np.isfinite(x)
    counts = x[known]
    if counts.size < 3 or (counts != np.round(counts)).any():
        return x
    turns = _turns(counts)
    if turns is None:
        return x
    found = x.copy()
    found[known] = counts + turns
    return found


def wrap_findings(name: str, written: Array, x: Array, line: NDArray[np.int64]) -> list[ImportFinding]:
    """A finding on counts ``written`` (n,) that were continued as ``x``."""
    known = np.isfinite(x)
    turns = np.diff((x - written)[known])
    rows = np.flatnonzero(turns)
    if not rows.size:
        return []
    size = abs(turns[rows[0]])
    return remarks(
        f"{shown(name)} counts from 0 to {size - 1:.0f} and begins again: it passes an end of its register {rows.size} "
        f"times (first: line {line[known][rows[0] + 1]}). It is continued there."
    )


def _turns(counts: Array) -> Array | None:
    """What to add to counts (n,) of a register that passes its ends; None for others.

    Its number of values is the least power of two that holds them. The other steps are less than a quarter of it, and
    those that are left at most twice as large: else nobody knows which way it went. A switch rests at both its ends.
    """
    if counts.min() < 0 or counts.max() >= 2.0**_MOST_BITS:
        return None
    size = 2.0 ** max(_FEWEST_BITS, int(counts.max()).bit_length())
    step = np.diff(counts)
    jumps = np.abs(step) > size / 2
    left = step - size * np.sign(step) * jumps
    most = np.abs(step[~jumps]).max(initial=0.0)
    if not jumps.any() or most >= size / 4 or np.abs(left).max() > 2 * most:
        return None
    return np.concatenate([[0.0], np.cumsum(left - step)])

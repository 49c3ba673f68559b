"""Where a model misses its runs: shares of its square error between runs, slow, by branch, by level, and fast."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

Integers = NDArray[np.int64]
PARTS = ("between_runs", "slow", "branch", "level", "fast")
SLOW_WAVES, LEVEL_WAVES = 6, 4


def error_parts(error: Array, run: Integers, block: Integers, output: Array) -> dict[str, float]:
    """Shares of the square of errors (n,) in time order, by part; they add up to 1.

    Each part explains what the parts before it left: means of runs, slow waves over the readings, means of blocks,
    waves over the measured output (n,). The rest is fast.
    """
    left, total, shares = error, float(error @ error), []
    for columns in (
        _means(run),
        _waves(np.arange(left.size, dtype=float), SLOW_WAVES),
        _means(block),
        _waves(output, LEVEL_WAVES),
    ):
        after = left - columns @ np.linalg.lstsq(columns, left, rcond=None)[0]
        shares.append(float(left @ left - after @ after))
        left = after
    values = [*shares, float(left @ left)]
    return {name: value / total if total else 0.0 for name, value in zip(PARTS, values)}


def _means(group: Integers) -> Array:
    """One column for each group of readings (m,)."""
    return (group[:, None] == np.unique(group)[None, :]).astype(float)


def _waves(z: Array, count: int) -> Array:
    """Cosines (m, count) over the ranks of z."""
    rank = (np.argsort(np.argsort(z, kind="stable"), kind="stable") + 0.5) / z.size
    return np.cos(np.pi * rank[:, None] * np.arange(1, count + 1))

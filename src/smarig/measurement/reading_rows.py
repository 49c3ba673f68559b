"""The rows of a branch that serve as readings: half evenly spaced, half where the output moves."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array


def spread_rows(y: Array, a: int, b: int, count: int) -> NDArray[np.int64]:
    """Up to ``count`` rows of (a, b], including the last."""
    moved = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(y[a : b + 1])))])
    even = np.linspace(0, 1, b - a + 1)
    place = 0.5 * even + 0.5 * (moved / moved[-1] if moved[-1] else even)
    return np.unique(a + np.searchsorted(place, np.arange(1, count + 1) / count - 1e-12)).astype(np.int64)

"""The correlation of two records, whatever their units."""

import numpy as np

from smarig.core.array import Array


def correlation(u: Array, y: Array) -> float:
    """Pearson's coefficient of two records that are not constant.

    Both are scaled by a power of two, which changes no digit: the square of 1e-310 would be 0, that of 1e200 infinite.

    >>> round(correlation(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1e-310, 3e-310])), 3)
    0.982
    """
    return float(np.corrcoef(_scaled(u), _scaled(y))[0, 1])


def _scaled(values: Array) -> Array:
    return np.ldexp(values, -np.frexp(np.abs(values).max())[1])

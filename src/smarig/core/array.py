"""The type of an array of numbers, and the size of its values."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]  # its shape and unit stand where it is used


def root_mean_square(values: ArrayLike, weight: Array | None = None) -> float:
    """Root of the mean square of ``values`` of any shape, with weights if given: sqrt(sum(w v²) / sum(w)).

    >>> root_mean_square([3.0, 4.0, 0.0, 0.0])
    2.5
    """
    return float(np.sqrt(np.average(np.asarray(values, dtype=float) ** 2, weights=weight)))

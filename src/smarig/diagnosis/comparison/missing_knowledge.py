"""Missing knowledge: an error of held-out runs that lies where the training runs determine nothing. It is no change."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ENDS = (0.05, 0.95)  # of the square error: the inputs between which it lies


@dataclass(frozen=True)
class MissingKnowledge:
    """``share`` of the held-out square error where the training runs determine nothing, and the ``inputs`` between
    which nine tenths of that error lie.
    """

    share: float
    inputs: tuple[float, float]


def inputs_of_error(u: Array, square: Array) -> tuple[float, float]:
    """The inputs between which nine tenths of the square errors (n,) at inputs u (n,) lie."""
    order = np.argsort(u)
    below = np.cumsum(square[order]) / square.sum()
    low, high = (float(u[order][np.searchsorted(below, q)]) for q in ENDS)
    return low, high

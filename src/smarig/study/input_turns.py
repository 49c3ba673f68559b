"""The wide branches of an input: between reversals that noise does not make."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.measurement import reversals

_LEAST_TRAVEL = 0.1  # of the range of the input: shorter branches do not count


def wide_turns(u: Array) -> NDArray[np.intp]:
    """Reversals, with both ends, between which the input travels a tenth of its range or more: noise turns it too.

    >>> wide_turns(np.array([0.0, 4.0, 8.0, 7.9, 10.0, 5.0, 1.0])).tolist()
    [0, 4, 6]
    """
    turns = reversals(u)
    kept = [int(turns[0])]
    for turn in turns[1:]:
        if len(kept) > 1 and (u[turn] - u[kept[-1]]) * (u[kept[-1]] - u[kept[-2]]) >= 0:
            kept[-1] = int(turn)  # the branch goes on
        elif abs(u[turn] - u[kept[-1]]) >= _LEAST_TRAVEL * np.ptp(u):
            kept.append(int(turn))
    kept[-1] = u.size - 1
    return np.array(kept)

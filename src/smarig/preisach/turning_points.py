"""Turning points of an input in spite of noise."""

from smarig.core import Array


def turning_points(u: Array, threshold: float) -> list[int]:
    """Indices of the first reading of u (n,), of every reversal by more than ``threshold``, and of the last reading.

    The start of the first branch is also a turning point if a small move in the other direction precedes it.

    >>> import numpy as np
    >>> turning_points(np.array([0.0, 3.0, 2.9, 4.0, 1.0, 2.0]), 1.5)
    [0, 3, 5]
    >>> turning_points(np.array([0.0, -0.1, 3.0]), 1.5)
    [0, 1, 2]
    """
    turns, low, high, direction = [0], 0, 0, 0
    for k, value in enumerate(u.tolist()):
        low, high = (k if value < u[low] else low), (k if value > u[high] else high)
        if direction >= 0 and value < u[high] - threshold:
            turns += [high] if high > turns[-1] else []
            direction, low = -1, k
        elif direction <= 0 and value > u[low] + threshold:
            turns += [low] if low > turns[-1] else []
            direction, high = 1, k
    last = u.size - 1
    return [*turns, last] if turns[-1] != last else turns

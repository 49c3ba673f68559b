"""The noise of a temperature that is recorded along a ramp.

A ramp rises. Where the recorded temperature goes back and forth, it carries noise, and a local line along the order of
the readings removes most of it. Records without such noise stay as they are.
"""

import numpy as np

from smarig.core import Array

_BACKWARD = 0.2  # share of the readings that go backward: fewer are no noise
_SMOOTH = 0.05  # share of backward readings at which the smoothing is enough
_WIDEST = 25  # readings


def smoothed_input(u: Array) -> Array | None:
    """A rising input in measured order, with the narrowest smoothing that leaves few backward readings.

    None for a record without noise. The smoothed input serves to find the parts of a curve and to fit its plateaus. A
    steep part must be fitted to the readings themselves: smoothing bends a ramp that slows down where the wire
    transforms.
    """
    if u.size < 10 or _backward(u) < _BACKWARD:
        return None
    found = u
    for width in range(3, min(_WIDEST, u.size // 3) + 1, 2):
        found = _local_lines(u.size, width) @ u
        if _backward(found) <= _SMOOTH:
            break
    return found


def _backward(u: Array) -> float:
    return float(np.mean(np.diff(u) < 0))


def _local_lines(n: int, width: int) -> Array:
    """The matrix (n, n) of lines over ``width`` readings about each; at the ends, over the last ``width``."""
    found = np.zeros((n, n))
    half = width // 2
    for k in range(half, n - half):
        found[k, k - half : k + half + 1] = 1 / width  # the middle of a line is the mean
    x = np.arange(width, dtype=float)
    ends = np.vander(x, 2) @ np.linalg.pinv(np.vander(x, 2))
    found[:half, :width], found[n - half :, n - width :] = ends[:half], ends[width - half :]
    return found

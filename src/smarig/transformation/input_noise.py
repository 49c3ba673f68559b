"""The noise of a temperature that is recorded along a ramp.

A ramp rises. Where the recorded temperature goes back and forth, it carries noise, and a local line along the order of
the readings removes most of it. Records without such noise stay as they are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_BACKWARD = 0.2  # share of the readings that go backward: fewer are no noise
_SMOOTH = 0.05  # share of backward readings at which the smoothing is enough
_WIDEST = 25  # readings


@dataclass(frozen=True, eq=False)
class SmoothedInput:
    """The input u (n,) after smoothing, the standard deviation of what was removed, and the smoother (n, n).

    ``sd`` is 0 and the smoother None if the record was left as it is.
    """

    u: Array
    sd: float = 0.0
    smoother: Array | None = None

    def draws(self, count: int, dice: np.random.Generator) -> Array:
        """Draws (count, n) of the noise that is left in u."""
        if self.smoother is None:
            return np.zeros((count, self.u.size))
        return self.sd * dice.standard_normal((count, self.u.size)) @ self.smoother.T


def smoothed_input(u: Array) -> SmoothedInput:
    """A rising input in measured order, with the narrowest smoothing that leaves few backward readings."""
    if u.size < 10 or _backward(u) < _BACKWARD:
        return SmoothedInput(u)
    smoother = np.eye(u.size)
    for width in range(3, min(_WIDEST, u.size // 3) + 1, 2):
        smoother = _local_lines(u.size, width)
        if _backward(smoother @ u) <= _SMOOTH:
            break
    residual = u - smoother @ u
    degrees = np.trace((np.eye(u.size) - smoother).T @ (np.eye(u.size) - smoother))
    return SmoothedInput(smoother @ u, float(np.sqrt(residual @ residual / degrees)), smoother)


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

"""The divergence check of a closed loop: errors that stay large end the run with zero current.

The check uses the rms error of time windows, so a loop that oscillates through zero error counts as one that stands
still at the same rms.
"""

import math
from dataclasses import dataclass

from smarig.core import LimitExceeded

_WINDOWS = 4  # into which the time limit is divided
_IMPROVEMENT = 0.9  # times the smallest rms so far: the error shrinks


@dataclass(frozen=True)
class DivergenceLimits:
    """When a loop counts as diverged: an rms above a share of the range, for this time without improvement."""

    share: float = 0.3
    seconds: float = 30.0


class DivergenceMonitor:
    """``check(t_s, error)`` at every sample. ``reach`` (low, high) are the positions within the rig's limits.

    >>> watch = DivergenceMonitor(DivergenceLimits(0.3, 3.0), (0.0, 10.0))
    >>> for tick in range(40):
    ...     watch.check(0.1 * tick, 2.9)
    """

    def __init__(self, divergence_limits: DivergenceLimits, reach: tuple[float, float]) -> None:
        self._largest_rms = divergence_limits.share * abs(reach[1] - reach[0])
        self._limits = divergence_limits
        self._least_rms: float | None = None
        self._windows_without_progress = 0
        self._since_s, self._sum_of_squares, self._n = math.nan, 0.0, 0

    def check(self, t_s: float, error: float) -> None:
        """Raise LimitExceeded after a time of large errors that do not shrink; NaN counts as large."""
        if not self._n:
            self._since_s = t_s
        self._sum_of_squares += error * error if math.isfinite(error) else math.inf
        self._n += 1
        if t_s - self._since_s >= self._limits.seconds / _WINDOWS:
            rms, self._sum_of_squares, self._n = math.sqrt(self._sum_of_squares / self._n), 0.0, 0
            self._check_window(rms)

    def _check_window(self, rms: float) -> None:
        if rms <= self._largest_rms:
            self._least_rms, self._windows_without_progress = None, 0
        elif self._least_rms is None or rms < _IMPROVEMENT * self._least_rms:
            self._least_rms, self._windows_without_progress = rms, 0
        else:
            self._windows_without_progress += 1
        if self._windows_without_progress >= _WINDOWS - 1:
            raise LimitExceeded(
                f"The loop diverges: its rms error is {rms:.3g} and has not improved for {self._limits.seconds:g} s."
            ).at_zero()

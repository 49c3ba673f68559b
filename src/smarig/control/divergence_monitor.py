"""Whether a closed loop still holds the wire: errors that stay large end the run with zero current.

Judged by the rms of whole stretches of time, so a loop that swings from end to end through zero error is no better than
one that stands still. Knows errors and times; refuses to know who made them.
"""

import math
from dataclasses import dataclass

from smarig.core import LimitExceeded

_WINDOWS = 4  # into which the patience is cut
_IMPROVEMENT = 0.9  # times the least rms so far: it is coming


@dataclass(frozen=True)
class DivergenceLimits:
    """When a loop counts as diverged: further off than a share of the range, for so long without coming closer."""

    share: float = 0.3
    seconds: float = 30.0


class DivergenceMonitor:
    """``look(t_s, error)`` at every sample; ``reach`` (low, high) are the positions within the rig's limits.

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
        """Raise LimitExceeded after a while of large errors that do not shrink; no error at all is a large one."""
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
                f"The loop diverges: {rms:.3g} off what is wanted, and no closer for {self._limits.seconds:g} s. "
                "The current is at zero."
            )

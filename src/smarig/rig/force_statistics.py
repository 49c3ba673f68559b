"""Mean and extremes of the measured force of a run."""

import math


class ForceStatistics:
    """``n`` readings; ``mean_N``, ``least_N``, ``largest_N`` are NaN without one."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the readings: another run begins."""
        self.n = 0
        self.mean_N = self.least_N = self.largest_N = math.nan

    def add(self, force_N: float) -> None:
        """Add a reading; NaN is none."""
        if not math.isfinite(force_N):
            return
        self.n += 1
        if self.n == 1:
            self.mean_N = self.least_N = self.largest_N = force_N
            return
        self.mean_N += (force_N - self.mean_N) / self.n
        self.least_N, self.largest_N = min(self.least_N, force_N), max(self.largest_N, force_N)

"""Detects that a wire has settled, by the rule of §5.2.1 made robust against encoder noise.

The window is divided into 25 blocks. The wire has settled when the means of the last 25 blocks lie within the band,
peak to peak.
"""

from collections import deque

import numpy as np

from smarig.core import Elapsed, Settled

BLOCKS = 25


class Approach:
    """Detects that the heating model has come near its steady state at a current; it then stays detected.

    What is left to the steady state shrinks by ``decay`` with each tick at the current as ordered. The measured
    current scatters: along it, the model may never come so near.
    """

    def __init__(self, distance_K: float, near_K: float, decay: float) -> None:
        self._distance_K, self._near_K, self._decay = abs(distance_K), near_K, decay

    def passed(self) -> bool:
        """Whether the model had arrived before a tick at the current, which passes."""
        arrived = self._distance_K < self._near_K
        self._distance_K *= self._decay
        return arrived


class SettleWindow:
    """The counts of one hold: ``settled`` and the statistics of the settle window."""

    def __init__(self, until: Settled | Elapsed, period_s: float) -> None:
        window_s = until.window_s if isinstance(until, Settled) else min(25.0, until.seconds)
        self.band_counts = until.band_counts if isinstance(until, Settled) else None
        self._block = max(1, round(window_s / BLOCKS / period_s))
        self._counts: deque[int] = deque(maxlen=max(1, round(window_s / period_s)))
        self._means: deque[float] = deque(maxlen=BLOCKS)
        self._sum, self._filled = 0, 0
        self.spread_counts = 0.0  # of the block means so far, peak to peak
        self.settled = False

    def add(self, counts: int, arrived: bool = True) -> None:
        """Add the counts of one sample; they count towards settling once the heating model has arrived."""
        self._counts.append(counts)
        if not arrived:
            return
        self._sum += counts
        self._filled += 1
        if self._filled == self._block:
            self._means.append(self._sum / self._block)
            self._sum = self._filled = 0
            self.spread_counts = max(self._means) - min(self._means)
            if self.band_counts is not None and len(self._means) == BLOCKS:
                self.settled = self.spread_counts <= self.band_counts

    @property
    def min_ticks_left(self) -> int:
        """Smallest number of ticks until it can have settled."""
        blocks = max(BLOCKS - len(self._means), 1)
        return blocks * self._block - self._filled

    @property
    def progress(self) -> float:
        """Filled part of the window, 0…1."""
        return len(self._means) / BLOCKS

    def statistics(self) -> tuple[float, float, int]:
        """Mean, standard deviation and number of the window's counts."""
        counts = np.array(self._counts, dtype=float)
        if not counts.size:
            return float("nan"), float("nan"), 0
        return float(counts.mean()), float(counts.std(ddof=1)) if counts.size > 1 else 0.0, counts.size

"""When does a wire stand still? The rule of §5.2.1 made robust against encoder noise.

The window is cut into 25 blocks; the wire has settled when the means of the last 25 blocks lie within
the band, peak to peak. Knows counts and ticks only.
"""

from collections import deque

import numpy as np

from smarig.command import Elapsed, Settled

BLOCKS = 25


class SettleWindow:
    """Watches counts during one hold; ``settled`` and the statistics of the window."""

    def __init__(self, until: Settled | Elapsed, period_s: float) -> None:
        window_s = until.window_s if isinstance(until, Settled) else min(25.0, until.seconds)
        self._band = until.band_counts if isinstance(until, Settled) else None
        self._block = max(1, round(window_s / BLOCKS / period_s))
        self._counts: deque[int] = deque(maxlen=max(1, round(window_s / period_s)))
        self._means: deque[float] = deque(maxlen=BLOCKS)
        self._sum, self._filled = 0, 0
        self.settled = False

    def add(self, counts: int, arrived: bool = True) -> None:
        """One sample's counts; they count towards settling once the heating model has arrived."""
        self._counts.append(counts)
        if not arrived:
            return
        self._sum += counts
        self._filled += 1
        if self._filled == self._block:
            self._means.append(self._sum / self._block)
            self._sum = self._filled = 0
            if self._band is not None and len(self._means) == BLOCKS:
                self.settled = max(self._means) - min(self._means) <= self._band

    @property
    def progress(self) -> float:
        """Share of the window filled, 0…1, for the person who waits."""
        return len(self._means) / BLOCKS

    def statistics(self) -> tuple[float, float, int]:
        """Mean, standard deviation and number of the window's counts."""
        counts = np.array(self._counts, dtype=float)
        if not counts.size:
            return float("nan"), float("nan"), 0
        return float(counts.mean()), float(counts.std(ddof=1)) if counts.size > 1 else 0.0, counts.size

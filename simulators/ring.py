"""The last samples of a device, by tick, as the words in which they will be read. Knows no device."""

from collections import deque
from typing import NamedTuple


class RingWindow(NamedTuple):
    """A stretch of the ring as it was when it was asked for."""

    first: int
    count: int
    words: list[int]


EMPTY_WINDOW = RingWindow(0, 0, [])


class Ring:
    """As many samples as fit; ticks count from 1."""

    def __init__(self, samples: int) -> None:
        self._samples: deque[list[int]] = deque(maxlen=samples)
        self.newest = 0

    def put(self, words: list[int]) -> None:
        """The sample of the next tick."""
        self._samples.append(words)
        self.newest += 1

    def window(self, first: int, want: int) -> RingWindow:
        """From tick ``first`` on, or from the oldest that is still there; empty where that is in the future."""
        oldest = self.newest - len(self._samples) + 1
        if first > self.newest or not self._samples:
            return RingWindow(first, 0, [])
        first = max(first, oldest)
        count = min(want, self.newest - first + 1)
        words = [word for k in range(first - oldest, first - oldest + count) for word in self._samples[k]]
        return RingWindow(first, count, words)

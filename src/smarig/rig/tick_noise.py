"""Reproducible noise: a value is a function of (seed, channel, tick), whatever is read when.

Counter-based (Philox), so a twin asked for the same tick twice, or over another link, says the same.
"""

import numpy as np

_BLOCK = 4096


class TickNoise:
    """Standard normal numbers by tick.

    >>> a, b = TickNoise(seed=3, channel=1), TickNoise(seed=3, channel=1)
    >>> late = b.at(9000)
    >>> [a.at(k) for k in range(9001)][-1] == late
    True
    """

    def __init__(self, seed: int, channel: int) -> None:
        self._key = np.array([seed, channel], dtype=np.uint64)
        self._block = -1
        self._values: list[float] = []

    def at(self, tick: int) -> float:
        """The number of one tick."""
        block, offset = divmod(tick, _BLOCK)
        if block != self._block:
            counter = np.array([0, 0, 0, block], dtype=np.uint64)
            generator = np.random.Generator(np.random.Philox(key=self._key, counter=counter))
            self._block, self._values = block, generator.standard_normal(_BLOCK).tolist()
        return self._values[offset]

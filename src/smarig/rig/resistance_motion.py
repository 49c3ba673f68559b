"""The resistance of a wire as a measure of its phase: what has transformed by its resistance must have moved.

It depends on no model of the hysteresis, so it also judges a wire that transforms elsewhere than its file says.
"""

import math
from collections import deque

LEAST_RANGE = 0.05  # ln of a resistance over the phases: less is noise, and change with temperature alone
TRANSFORMED, STARTED = 0.7, 0.2  # of that range: most of a transformation; hardly one
READINGS = 5  # whose median is one resistance: a switched current gives single wrong ones


class ResistanceMotion:
    """``add_counts`` and ``add`` take readings; ``unmoved`` tells whether the position stood meanwhile.

    >>> motion = ResistanceMotion(range_ln=0.1, still_counts=3)
    >>> for k in range(20):
    ...     motion.add_counts(7, tick=k)
    ...     motion.add(1.0 - 0.005 * k)
    >>> motion.unmoved, motion.started, motion.from_tick
    (True, True, 0)
    >>> motion.add_counts(12, tick=20)
    >>> motion.unmoved
    False
    """

    def __init__(self, range_ln: float, still_counts: float) -> None:
        """``range_ln``: ln of the largest over the smallest resistance; ``still_counts``: that are no motion yet."""
        self._range = range_ln if range_ln >= LEAST_RANGE else math.inf
        self._still = still_counts
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._readings: deque[float] = deque(maxlen=READINGS)
        self._counts: tuple[float, float] | None = None  # least and largest since the position last moved
        self.from_tick = 0  # since when
        self._since: tuple[float, float] | None = None  # ln of the resistance since then
        self._all: tuple[float, float] | None = None

    def add_counts(self, counts: int, tick: int) -> None:
        """The position of a tick."""
        low, high = self._counts or (math.inf, -math.inf)
        low, high = min(low, counts), max(high, counts)
        if self._counts is None or high - low > self._still:
            low, high, self.from_tick, self._since = counts, counts, tick, None
            self._readings.clear()
        self._counts = low, high

    def add(self, ln_ohm: float) -> None:
        """The resistance of the present tick, where it is known."""
        self._readings.append(ln_ohm)
        if len(self._readings) == READINGS:
            middle = sorted(self._readings)[READINGS // 2]
            self._since, self._all = _extended(self._since, middle), _extended(self._all, middle)

    @property
    def changed(self) -> float:
        """By how much ln of the resistance has changed while the position stood."""
        return self._since[1] - self._since[0] if self._since else 0.0

    @property
    def unmoved(self) -> bool:
        """Whether the position stood while the wire has transformed by its resistance."""
        return self.changed > TRANSFORMED * self._range

    @property
    def moved(self) -> bool | None:
        """Whether the wire has transformed since the position stood; None if no resistance tells."""
        if self._since is None or math.isinf(self._range):
            return None
        return self.changed > STARTED * self._range

    @property
    def started(self) -> bool | None:
        """Whether the wire has begun to transform by its resistance; None if that does not tell."""
        if self._all is None or math.isinf(self._range):
            return None
        return self._all[1] - self._all[0] > STARTED * self._range


def _extended(extent: tuple[float, float] | None, value: float) -> tuple[float, float]:
    return (min(extent[0], value), max(extent[1], value)) if extent else (value, value)

"""The resistance of a wire as a measure of its phase: what has transformed by its resistance must have moved.

It depends on no model of the hysteresis, so it also judges a wire that transforms elsewhere than its file says.
"""

import math
from collections import deque

LEAST_RANGE = 0.05  # ln of a resistance over the phases: less is noise, and change with temperature alone
TRANSFORMED, STARTED = 0.7, 0.2  # of that range: most of a transformation; hardly one
Extent = tuple[float, float]  # least and largest
READINGS = 5  # whose median is one resistance: a switched current gives single wrong ones


class ResistanceMotion:
    """``add_counts`` and ``add`` take readings; ``unmoved`` tells whether the position stood meanwhile.

    >>> motion = ResistanceMotion(range_ln=0.1, still_counts=3, heated_K=4.0)
    >>> for k in range(20):
    ...     motion.add_counts(7, tick=k)
    ...     motion.add(1.0 - 0.005 * k, input_K=20.0 + k)
    >>> motion.unmoved, motion.started, motion.from_tick
    (True, True, 0)
    >>> motion.add_counts(12, tick=20)
    >>> motion.unmoved
    False
    """

    def __init__(self, range_ln: float, still_counts: float, heated_K: float) -> None:
        """``range_ln``: ln of the largest over the smallest resistance; ``still_counts``: that are no motion yet.

        ``heated_K``: a smaller change of the input transforms nothing; what changes then is no resistance of a wire.
        """
        self._range = range_ln if range_ln >= LEAST_RANGE else math.inf
        self._still, self._heated_K = still_counts, heated_K
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._readings: deque[float] = deque(maxlen=READINGS)
        self._counts: Extent | None = None  # least and largest since the position last moved
        self.from_tick = 0  # since when
        self._since: Extent | None = None  # ln of the resistance since then
        self._inputs: Extent | None = None  # K, at these resistances
        self._all: Extent | None = None  # ln of the resistance

    def add_counts(self, counts: int, tick: int) -> None:
        """The position of a tick."""
        extent = self._counts
        if extent is not None and extent[0] <= counts <= extent[1]:
            return  # nearly always: this is asked in every tick
        self._counts = _extended(extent, counts)
        if extent is None or _span(self._counts) > self._still:
            self._counts, self.from_tick = (counts, counts), tick
            self._since = self._inputs = None
            self._readings.clear()

    def add(self, ln_ohm: float, input_K: float) -> None:
        """The resistance of the present tick, where it is known, and the predicted input."""
        self._readings.append(ln_ohm)
        if len(self._readings) == READINGS:
            middle = sorted(self._readings)[READINGS // 2]
            self._since, self._all = _extended(self._since, middle), _extended(self._all, middle)
            self._inputs = _extended(self._inputs, input_K)

    @property
    def changed(self) -> float:
        """By how much ln of the resistance has changed while the position stood."""
        return _span(self._since)

    @property
    def unmoved(self) -> bool:
        """Whether the position stood while the wire has transformed by its resistance."""
        return self.changed > TRANSFORMED * self._range and _span(self._inputs) >= self._heated_K

    @property
    def must_move(self) -> bool | None:
        """Whether the wire has transformed since the position stood; None if no current has told its resistance since.

        True, as by its model, if no resistance tells: it has never been known, or its range is too small.
        """
        if self.started is None:
            return True
        return None if self._since is None else self.changed > STARTED * self._range

    @property
    def started(self) -> bool | None:
        """Whether the wire has begun to transform by its resistance; None if that does not tell."""
        if self._all is None or math.isinf(self._range):
            return None
        return _span(self._all) > STARTED * self._range


def _extended(extent: Extent | None, value: float) -> Extent:
    return (min(extent[0], value), max(extent[1], value)) if extent else (value, value)


def _span(extent: Extent | None) -> float:
    return extent[1] - extent[0] if extent else 0.0

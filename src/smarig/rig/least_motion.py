"""Whether a reading has stayed the same to the last count while every wire within the tolerance has moved.

The bounds of like wires enclose each of them at every time, so that a wire which stood still from time s to t would be

    above max y_low   and   below min y_high   of these times.

Where the first exceeds the second, each of these wires has moved by the difference at least. The zero of the encoder
does not matter, and neither does its tolerance: a wire that is off in its amount moves nevertheless.
"""

from collections.abc import Sequence

HELD = 20  # samples that may repeat a reading until the next query


class LeastMotion:
    """``add`` takes a reading; ``unmoved``: whether it stands although no wire can have.

    >>> motion = LeastMotion(margin=5.0)
    >>> for k in range(60):
    ...     motion.add(7.0, [(k - 10.0, k + 10.0)], 1)
    >>> motion.unmoved, motion.doubtful_ticks
    (True, 59)
    >>> motion.add(8.0, None, 1)
    >>> motion.unmoved
    False
    """

    def __init__(self, margin: float) -> None:
        """``margin``: of the motion, which is no motion yet."""
        self._margin, self._tick, self._reading = margin, 0, 0.0
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._highest: list[tuple[float, int]] = []  # of the lower bounds, with its tick
        self._lowest: list[tuple[float, int]] = []  # of the upper bounds
        self._moved, self._repeated = False, 0  # every wire; samples since then
        self._from_tick = 0  # since which the readings contradict the wires

    def add(self, reading: float, bounds: Sequence[tuple[float, float]] | None, ticks: int) -> None:
        """The next reading, with the bounds of each group of like wires where they are known."""
        self._tick += ticks
        if reading != self._reading:
            self.forget()
            self._reading = reading
        if self._moved:
            self._repeated += 1
        elif bounds is not None:
            self._compare(bounds)

    def _compare(self, bounds: Sequence[tuple[float, float]]) -> None:
        tick = self._tick
        highest = self._highest or [(low, tick) for low, _ in bounds]
        lowest = self._lowest or [(high, tick) for _, high in bounds]
        self._highest = [a if a[0] >= low else (low, tick) for a, (low, _) in zip(highest, bounds)]
        self._lowest = [b if b[0] <= high else (high, tick) for b, (_, high) in zip(lowest, bounds)]
        pairs = list(zip(self._highest, self._lowest))
        self._moved = all(a[0] - b[0] > self._margin for a, b in pairs)
        self._from_tick = min(min(a[1], b[1]) for a, b in pairs)

    @property
    def unmoved(self) -> bool:
        """Whether the reading has stood longer than one can be held, after every wire has moved."""
        return self._repeated >= HELD

    @property
    def doubtful_ticks(self) -> int:
        """Before the present tick: since the readings with which it contradicts the wires."""
        return self._tick - self._from_tick if self._moved else 0

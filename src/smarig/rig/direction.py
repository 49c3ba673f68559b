"""Whether a position moves against the heat of every wire, whatever state the wire is in.

A Preisach operator with a measure that is not negative keeps the order of its inputs (``wire_bounds.py``), also that of
its input at two times. While the input rises, the position does not fall; where the input has fallen by d from its
highest, the position has fallen by at most c d, with c counts per kelvin of the steepest branch:

    y(s) − y(t) ≤ c d,   d = max over s ≤ r ≤ r' ≤ t of u(r) − u(r'),   if u(t) ≥ u(s) + δ

δ covers what is not known of the input: ambient temperature and noise. u is that of every wire at once: it counts as
risen if it is higher at all time constants of ``temperature_bounds.py``, and as fallen if it is lower at one. A slow
sensor shows what was: the same temperatures behind a lag are wires too.
"""

from collections import deque

from smarig.rig.temperature_bounds import TemperatureBounds

Signals = tuple[
    list[float], list[float]
]  # of wires that move the position up, and of those that move it down


class Rise:
    """``add`` returns by how much a reading is below what it was when every wire was colder.

    >>> rise = Rise(counts_per_K=1.0, least_K=3.0, tolerance=10.0)
    >>> [rise.add(([K], []), reading) for K, reading in ((0.0, 5.0), (2.0, 1.0), (4.0, 1.0), (3.5, 0.0))]
    [0.0, 0.0, 4.0, 4.5]
    """

    def __init__(self, counts_per_K: float, least_K: float, tolerance: float) -> None:
        self._per_K, self._least_K, self._tolerance = counts_per_K, least_K, tolerance
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._extremes: Signals | None = None
        self._fallen_K, self._top = 0.0, float("-inf")
        self._later: deque[tuple[Signals, float]] = deque()  # readings that every wire has not yet been above

    def add(self, signals: Signals, reading: float) -> float:
        """The reading at the temperatures of all wires, in counts."""
        if self._extremes is None:
            self._extremes = signals
        highest, lowest = self._extremes
        up, down = signals
        highest = [max(pair) for pair in zip(highest, up)]
        lowest = [min(pair) for pair in zip(lowest, down)]
        fallen_K = max((h - x for h, x in zip(highest, up)), default=0.0)
        fallen_K += max((x - low for low, x in zip(lowest, down)), default=0.0)
        self._extremes = highest, lowest
        self._fallen_K = max(self._fallen_K, fallen_K)
        if self._per_K * self._fallen_K > self._tolerance:
            self.forget()  # it may have fallen
            self._extremes = signals
        self._later.append((signals, reading))
        while self._later and _risen_K(self._later[0][0], signals) >= self._least_K:
            self._top = max(self._top, self._later.popleft()[1])
        return max(0.0, self._top - reading - self._per_K * self._fallen_K)


def _risen_K(then: Signals, now: Signals) -> float:
    """By how much the input of every wire has risen at least."""
    up = min((b - a for a, b in zip(then[0], now[0])), default=0.0)
    return up + min((a - b for a, b in zip(then[1], now[1])), default=0.0)


class Direction:
    """``add`` takes a reading at each beat of the bounds; ``against``: whether it moves in no wire's direction."""

    def __init__(self, counts_per_K: float, least_K: float, tolerance: float, lag: float) -> None:
        """``lag``: the share by which a slow sensor approaches its quantity in a beat."""
        self._rise = Rise(counts_per_K, least_K, tolerance)
        self._fall = Rise(counts_per_K, least_K, tolerance)
        self._tolerance, self._lag = tolerance, lag
        self._lagging: list[list[float]] = []
        self.against = False

    def add(self, temperature: TemperatureBounds, reading: float) -> None:
        """A reading, in counts."""
        wires = temperature.wires_K
        before = self._lagging or [list(wire) for wire in wires]
        self._lagging = [
            [late + self._lag * (now - late) for late, now in zip(old, wire)]
            for old, wire in zip(before, wires)
        ]
        up = [*wires[0], *self._lagging[0]]
        down = [*wires[1], *self._lagging[1]] if len(wires) > 1 else []
        excess = max(self._rise.add((up, down), reading), self._fall.add((down, up), -reading))
        self.against = excess > self._tolerance

    def forget(self) -> None:
        """The zero is another one now, or the wire may be in another state than assumed."""
        self._rise.forget()
        self._fall.forget()
        self.against = False

"""Whether a position moves against the heat of every wire, whatever state the wire is in.

A Preisach operator with a measure that is not negative keeps the order of its inputs (``wire_bounds.py``), also that of
its input at two times. While the input rises, the position does not fall; where the input has fallen by d from its
highest, the position has fallen by at most c d, with c counts per kelvin of the steepest branch:

    y(s) − y(t) ≤ c d,   d = max over s ≤ r ≤ r' ≤ t of u(r) − u(r'),   if u(t) ≥ u(s) + δ

δ covers what is not known of the input: ambient temperature and noise. u is that of every wire at once: it counts as
risen if it is higher at all time constants of ``temperature_bounds.py``, and as fallen if it is lower at one. A slow
sensor shows what was: the same temperatures behind a lag are wires too.
"""

import math
from collections import deque

from smarig.rig.temperature_bounds import TemperatureBounds

PARTS = 4  # of δ, within which readings are kept as one
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
        self._least_K, self._per_K = least_K, counts_per_K
        self._most_K = tolerance / counts_per_K  # by which the input may have fallen
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._highest: list[float] = []
        self._lowest: list[float] = []
        self._fallen_K, self._top = 0.0, -math.inf
        self._later: deque[tuple[Signals, float]] = deque()  # readings that every wire has not yet been above

    def add(self, signals: Signals, reading: float) -> float:
        """The reading at the temperatures of all wires, in counts."""
        fallen_K = _beyond(self._highest, signals[0], 1.0) + _beyond(self._lowest, signals[1], -1.0)
        if fallen_K > self._fallen_K:
            self._fallen_K = fallen_K
        if self._fallen_K > self._most_K or not self._later:  # it may have fallen by any amount
            self.forget()
            self._highest, self._lowest = list(signals[0]), list(signals[1])
            self._later.append((signals, reading))
            return 0.0
        self._keep(signals, reading)
        later, least_K = self._later, self._least_K
        while _risen_K(later[0][0], signals) >= least_K:
            self._top = max(self._top, later.popleft()[1])
        return max(0.0, self._top - reading - self._per_K * self._fallen_K)

    def _keep(self, signals: Signals, reading: float) -> None:
        """Readings at nearly the same temperatures are one: the highest."""
        highest = self._later[-1][1]
        if len(self._later) > 1 and _risen_K(self._later[-2][0], signals) < self._least_K / PARTS:
            self._later[-1] = signals, max(highest, reading)
        else:
            self._later.append((signals, reading))


def _beyond(extremes: list[float], now: list[float], sign: float) -> float:
    """By how much signals are on the inner side of their extremes, at most; moves those that they exceed."""
    most = 0.0
    for k, extreme in enumerate(extremes):
        by = sign * (extreme - now[k])
        if by < 0.0:
            extremes[k] = now[k]
        elif by > most:
            most = by
    return most


def _risen_K(then: Signals, now: Signals) -> float:
    """By how much the input of every wire has risen at least."""
    least = math.inf
    for a, b in zip(then[0], now[0]):
        if b - a < least:
            least = b - a
    if not now[1]:
        return least
    down = math.inf
    for a, b in zip(then[1], now[1]):
        if a - b < down:
            down = a - b
    return least + down if now[0] else down


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
        wires, lag = temperature.wires_K, self._lag
        before = self._lagging or wires
        self._lagging = late = [
            [a + lag * (b - a) for a, b in zip(old, wire)] for old, wire in zip(before, wires)
        ]
        up = wires[0] + late[0]
        down = wires[1] + late[1] if len(wires) > 1 else []
        rise, fall = self._rise.add((up, down), reading), self._fall.add((down, up), -reading)
        self.against = rise > self._tolerance or fall > self._tolerance

    def forget(self) -> None:
        """The zero is another one now, or the wire may be in another state than assumed."""
        self._rise.forget()
        self._fall.forget()
        self.against = False

"""The restricted Preisach model of order n: only the last n dominant extrema are remembered.

Two minor loops are comparable here when the same n extrema precede them (thesis §3.5, where the weights
depend on those). A branch from the last extremum e runs towards a target t: the extremum before e, or, when
that is forgotten, saturation. Where nothing has been forgotten since saturation the branch is Preisach's,

    y = y_e + F(u, e) rising,  y = y_e − F(e, u) falling;     else, from the present point (v, y_v), it is
    y = y_v + (y_t − y_v) [F_e(u) − F_e(v)] / [F_e(t) − F_e(v)],      F_e(x) = F(x, e) or F(e, x),

the Preisach branch scaled to arrive at (t, y_t); e is the end of the range when it is forgotten too. So loops
between remembered extrema close and wipe out, saturation is the same for all, and order None (∞) is the
classical model, bit for bit. Knows no data.
"""

from dataclasses import dataclass
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core.errors import UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, State, input_number
from smarig.theory.extended.operator_base import simulate_steps

Array = NDArray[np.float64]
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class RestrictedState:
    """The last extrema (u, y), oldest first; the present point; whether anything older was forgotten."""

    extrema: tuple[Point, ...]
    u: float
    y: float
    rising: bool
    forgotten: bool


class RestrictedPreisach:
    """Preisach with a memory of ``order`` n ≥ 1 extrema, None for all; see the module.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import surface
    >>> turns = [120.0, 30.0, 100.0, 40.0, 90.0, 50.0, 80.0, 50.0]
    >>> y = RestrictedPreisach(surface("one_c"), order=2).simulate([*turns, 120.0])
    >>> bool(y[5] == y[7]), bool(y[8] == y[0])      # the last loop closes, the forgotten one does not
    (True, False)
    """

    def __init__(
        self, hysteresis: Everett, order: int | None, initial: Initial | RestrictedState = "negative"
    ) -> None:
        if order is not None and not (isinstance(order, Integral) and order >= 1):
            raise UsageError(
                "A restricted model remembers at least one extremum, a whole number of them or None for all; "
                f"got order {order!r:.40}."
            )
        self.hysteresis, self.order = hysteresis, order
        h = hysteresis
        self._ends = (h.lower, h.y_lower), (h.upper, h.y_lower + h.everett(h.upper, h.lower))
        self.reset(initial)

    @property
    def state(self) -> RestrictedState:
        """A frozen copy of the memory."""
        return RestrictedState(tuple(self._points), self.u, self.y, self._rising, self._forgotten)

    def reset(self, initial: Initial | RestrictedState = "negative") -> float:
        """Go to negative or positive saturation or to a state; returns y."""
        if isinstance(initial, RestrictedState):
            self._points, self._rising = list(initial.extrema), initial.rising
            self.u, self.y, self._forgotten = initial.u, initial.y, initial.forgotten
        elif initial in ("negative", "positive"):
            self._saturate(initial == "positive")
        else:
            what = "a classical memory" if isinstance(initial, State) else f"'{initial}'"
            raise UsageError(
                f"A restricted model starts negative, positive or from its own state, not {what}."
            )
        return self.y

    def step(self, u: float) -> float:
        """Move monotonically to u; returns y."""
        u = input_number(u)
        if not self.hysteresis.lower < u < self.hysteresis.upper:
            self._saturate(u >= self.hysteresis.upper)
        elif u != self.u:
            self._move(u)
        return self.y

    def simulate(self, u: ArrayLike, initial: Initial | RestrictedState = "negative") -> Array:
        """Outputs (n,) for inputs u (n,)."""
        return simulate_steps(self, u, initial)

    def _saturate(self, upper: bool) -> None:
        """At an end of the range nothing is remembered, and nothing needs to be."""
        self.u, self.y = self._ends[upper]
        self._points: list[Point] = []
        self._rising, self._forgotten = upper, False

    def _move(self, u: float) -> None:
        rising = u > self.u
        points = self._points
        if rising != self._rising and (self.u, self.y) not in self._ends:
            points.append((self.u, self.y))
            if self.order is not None and len(points) > self.order:
                del points[0]
                self._forgotten = True
        self._rising = rising
        sign = 1 if rising else -1
        while len(points) > 1 and sign * u >= sign * points[-2][0]:
            self.u, self.y = points[-2]
            del points[-2:]
        if self._forgotten:
            self.y = self._scaled(u)
        else:
            origin, y = points[-1] if points else self._ends[not rising]
            self.y = y + sign * self._branch(u, origin)
        self.u = u

    def _scaled(self, u: float) -> float:
        """From the present point along the shape of the branch to where it must arrive."""
        origin = self._points[-1][0] if self._points else self._ends[not self._rising][0]
        target, y = self._points[-2] if len(self._points) > 1 else self._ends[self._rising]
        done = self._branch(self.u, origin)
        ahead = self._branch(target, origin) - done
        return self.y + (y - self.y) * ((self._branch(u, origin) - done) / ahead if ahead else 0.0)

    def _branch(self, u: float, origin: float) -> float:
        F = self.hysteresis.everett
        return F(u, origin) if self._rising else F(origin, u)

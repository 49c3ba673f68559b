"""A large number of relays with random thresholds, switched one by one, as the hysteresis of a wire.

A relay switches on at α and off at β, and keeps its state in between. Masses are whole numbers, so sums are
exact in any order. The cost of a monotone move is the number of relays that it passes.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
InputOfShare = Callable[[Array], Array]  # shares of relays on → the hysteresis input then


@dataclass(frozen=True, eq=False)
class RelayHysteresis:
    """Thresholds (n,) in kelvin, whole masses (n,); output from ``y_lower`` (all off) over ``stroke``."""

    alpha: Array
    beta: Array
    mass: Array
    stroke: float
    y_lower: float

    @property
    def lower(self) -> float:
        """The smallest β: negative saturation."""
        return float(self.beta.min())

    @property
    def upper(self) -> float:
        """The largest α: positive saturation."""
        return float(self.alpha.max())

    def initial(self, *, two_wire: bool) -> "Relays":
        """The relays of a cold wire, or of two wires after a decaying oscillation."""
        return demagnetised(self) if two_wire else Relays(self)


class Relays:
    """The state of the relays of a hysteresis; initially all off.

    >>> pile = Relays(RelayHysteresis(np.array([2.0, 3.0]), np.array([1.0, 0.5]), np.array([1.0, 3.0]), 1.0, 0.0))
    >>> pile.move(2.5), pile.move(3.0), pile.move(0.8)
    (0.25, 1.0, 0.75)
    """

    def __init__(self, hysteresis: RelayHysteresis) -> None:
        rising = np.argsort(hysteresis.alpha, kind="stable")
        self._alpha, beta = hysteresis.alpha[rising], hysteresis.beta[rising]
        self._mass = hysteresis.mass[rising]
        self._order = np.argsort(beta, kind="stable")  # of β, as positions in the order of α
        self._beta = beta[self._order]
        self._alphas, self._betas = self._alpha.tolist(), self._beta.tolist()
        self._on = np.zeros(self._mass.size, dtype=bool)
        self._all = float(self._mass.sum())
        self._sum = 0.0
        self.u = min(self._betas[0], 0.0) - 1.0

    @property
    def share(self) -> float:
        """Share of the mass that is on, 0…1."""
        return self._sum / self._all

    def own_austenite(self, wire: int) -> float:
        """Austenite of one of two wires: of the relays that it switches both ways by itself, the share that it has
        switched.
        """
        beta = np.empty(self._mass.size)
        beta[self._order] = self._beta
        mass = self._mass * ((self._alpha <= 0) if wire else (beta >= 0))
        return float(mass @ (self._on != bool(wire)) / mass.sum()) if mass.any() else 0.0

    def move(self, u: float) -> float:
        """Move to a temperature directly; returns the share that is on then."""
        if u > self.u:
            self._switch_on(bisect_right(self._alphas, self.u), bisect_right(self._alphas, u))
        elif u < self.u:
            self._switch_off(bisect_left(self._betas, u), bisect_left(self._betas, self.u))
        self.u = u
        return self._sum / self._all

    def move_coupled(self, hysteresis_input: InputOfShare) -> float:
        """Move until the hysteresis input, which depends on the share that is on, is at rest.

        Relays switch one after the other, each at the input just before it. The first relay that is not
        reached ends the move. Positive feedback therefore gives an avalanche, as it should.
        """
        now = self._input_at(hysteresis_input, self._sum)
        if now > self.u:
            self._coupled_rise(hysteresis_input, now)
        elif now < self.u:
            self._coupled_fall(hysteresis_input, now)
        return self._sum / self._all

    def _input_at(self, hysteresis_input: InputOfShare, total: float) -> float:
        return float(hysteresis_input(np.array([total / self._all]))[0])

    def _coupled_rise(self, hysteresis_input: InputOfShare, now: float) -> None:
        first, most = (
            bisect_right(self._alphas, self.u),
            max(now, self._input_at(hysteresis_input, self._all)),
        )
        last = bisect_right(self._alphas, most)
        mass = np.where(self._on[first:last], 0.0, self._mass[first:last])
        before = self._sum + np.cumsum(mass) - mass
        not_reached = hysteresis_input(before / self._all) < self._alpha[first:last]
        end = first + (int(np.argmax(not_reached)) if not_reached.any() else last - first)
        self._switch_on(first, end)
        reached = self._alphas[end - 1] if end > first else self.u
        self.u = max(reached, self._input_at(hysteresis_input, self._sum))

    def _coupled_fall(self, hysteresis_input: InputOfShare, now: float) -> None:
        last, least = bisect_left(self._betas, self.u), min(now, self._input_at(hysteresis_input, 0.0))
        first = bisect_left(self._betas, least)
        places = self._order[first:last][::-1]
        mass = np.where(self._on[places], self._mass[places], 0.0)
        before = self._sum - np.cumsum(mass) + mass
        not_reached = hysteresis_input(before / self._all) > self._beta[first:last][::-1]
        end = last - (int(np.argmax(not_reached)) if not_reached.any() else last - first)
        self._switch_off(end, last)
        reached = self._betas[end] if end < last else self.u
        self.u = min(reached, self._input_at(hysteresis_input, self._sum))

    def _switch_on(self, first: int, last: int) -> None:
        """Switch on, in the order of α."""
        if last > first:
            on = self._on[first:last]
            self._sum += float(self._mass[first:last][~on].sum())
            on[:] = True

    def _switch_off(self, first: int, last: int) -> None:
        """Switch off, in the order of β."""
        if last > first:
            places = self._order[first:last]
            self._sum -= float(self._mass[places[self._on[places]]].sum())
            self._on[places] = False


def demagnetised(hysteresis: RelayHysteresis, half_cycles: int = 150) -> Relays:
    """Relays after a decaying oscillation about zero that starts beyond both saturations."""
    relays = Relays(hysteresis)
    size = 1.01 * max(hysteresis.upper, -hysteresis.lower)
    for k in range(half_cycles + 1):
        relays.move((-1) ** (k + 1) * size * (1 - k / half_cycles))
    return relays

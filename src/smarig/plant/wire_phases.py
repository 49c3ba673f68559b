"""The phase of each of two antagonist wires, from its own temperature and the identified hysteresis.

    ξ₁ = Γ₊[T₁] / F(u₊, 0),    ξ₂ = Γ₋[T₂] / F(0, u₋)        T ≥ 0 above ambient, 0 ≤ ξ ≤ 1

Γ₊ is the operator of the relays with α, β ≥ 0, which wire 1 switches both ways by its own temperature: they are the
part of the output that the wire gives back when it cools. Γ₋ is that of wire 2, with α, β ≤ 0. The relays between
(α > 0 > β) are set by one wire and reset by the other. They are strain of martensite that remains, not a phase, so
both wires are martensite when both are cold, whatever the position (thesis §5.5.1).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach import Everett, Preisach


class WirePhases:
    """Phases of two wires. ``step(wire_K)`` advances to their temperatures; ``fraction(k)`` is the austenite of wire k.

    An operator depends on the turning points of its input alone. So a temperature that goes on in its direction is only
    remembered, and the phase is computed when it is asked for, with the same numbers.

    >>> from smarig.preisach import thesis_surface
    >>> wires = WirePhases(thesis_surface("two_e"))
    >>> wires.step([185.0, 0.0])
    >>> [round(xi, 3) for xi in wires.austenite]
    [1.0, 0.0]
    """

    def __init__(self, hysteresis: Everett) -> None:
        self._wires = _OwnPhase(hysteresis, 1.0), _OwnPhase(hysteresis, -1.0)

    def step(self, wire_K: Sequence[float], ambient_K: float = 0.0) -> None:
        """Advance both wires to their temperatures above an ambient temperature that has changed by so much."""
        first, second = self._wires
        first.move(wire_K[0] + ambient_K)
        second.move(wire_K[1] + ambient_K)

    def fraction(self, wire: int) -> float:
        """The austenite fraction of a wire, 0 or 1."""
        return self._wires[wire].fraction()

    @property
    def austenite(self) -> tuple[float, float]:
        """The austenite fractions of both wires."""
        return self.fraction(0), self.fraction(1)


def austenite_along(hysteresis: Everett, wires_K: Sequence[Array], at: NDArray[np.int64]) -> Array:
    """Austenite fractions (2, m) at the samples ``at`` (m,) of both wires' temperatures (n,) above their first ambient.

    They are those of ``WirePhases.step`` at each sample. Only the turning points of the paths and ``at`` are simulated.
    """
    found = np.empty((2, at.size))
    for fractions, own_K, sign in zip(found, wires_K, (1.0, -1.0), strict=True):
        path = np.maximum(own_K, 0.0)
        move = np.diff(path, prepend=path[:1], append=path[-1:])
        needed = move[:-1] * move[1:] <= 0
        needed[at] = True
        kept = np.flatnonzero(needed)
        fractions[:] = _OwnPhase(hysteresis, sign).follow(path[kept])[np.searchsorted(kept, at)]
    return found


class _OwnPhase:
    """The phase of the wire whose temperature has this sign in the input; cold at first.

    The operator of all relays is used on one side of 0 only, where it switches only those of that side.
    """

    def __init__(self, hysteresis: Everett, sign: float) -> None:
        self._sign = sign
        self._operator = Preisach(hysteresis, compiled=False)
        end = hysteresis.upper if sign > 0 else hysteresis.lower
        self._operator.step(end)
        hot = self._operator.y
        self._cold = self._operator.step(0.0)
        self._per_output = 1.0 / (hot - self._cold) if sign * (hot - self._cold) > 0 else 0.0
        self._per_K = 1.0 / abs(end) if end else 0.0
        self._at_K = self._now_K = self._fraction = 0.0  # where the operator is, and where the wire is

    def move(self, wire_K: float) -> None:
        """Go to a temperature; where the way turns, the operator goes along."""
        now_K = self._now_K
        if (wire_K - now_K) * (now_K - self._at_K) < 0:
            self._fraction, self._at_K = self.step(now_K), now_K
        self._now_K = wire_K

    def fraction(self) -> float:
        """The austenite fraction at the present temperature."""
        if self._now_K != self._at_K:
            self._fraction, self._at_K = self.step(self._now_K), self._now_K
        return self._fraction

    def step(self, wire_K: float) -> float:
        """The austenite fraction. A wire that gives nothing back is taken to transform as its temperature rises."""
        wire_K = max(wire_K, 0.0)
        if not self._per_output:
            return min(wire_K * self._per_K, 1.0)
        share = (self._operator.step(self._sign * wire_K) - self._cold) * self._per_output
        return min(max(share, 0.0), 1.0) + 0.0  # not −0

    def follow(self, wire_K: Array) -> Array:
        """``step`` for temperatures (n,), none of them below 0, one after the other."""
        if not self._per_output:
            return np.minimum(wire_K * self._per_K, 1.0)
        share = (self._operator.follow(self._sign * wire_K) - self._cold) * self._per_output
        return np.clip(share, 0.0, 1.0) + 0.0

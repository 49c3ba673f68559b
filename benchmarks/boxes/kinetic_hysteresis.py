"""Wires that follow a kinetic law of phase fractions: no Preisach operator, minor loops do not return.

    heating:  ξ_M(T) = ξ_M(T₀) c_A(T)/c_A(T₀)        cooling:  ξ_A(T) = ξ_A(T₀) c_M(T)/c_M(T₀)

c_A falls from 1 at A_s to 0 at A_f, c_M rises from 0 at M_f to 1 at M_s: half a cosine (Liang and Rogers 1990) or an
exponential that leaves one percent (Tanaka 1986), each in the differential form that is continuous at reversals. The
grains of a wire transform in parallel, each between temperatures of its own.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from benchmarks.boxes.relays import RelayHysteresis
from benchmarks.boxes.wire import BoxWire

Array = NDArray[np.float64]
_REMAINS = 0.01  # of a phase at its finish temperature, under the exponential law
_LEAST = 1e-12
_HALVINGS = 50


@dataclass(frozen=True, eq=False)
class KineticHysteresis:
    """Start and finish temperatures (g,) of the grains in kelvin, their shares, and the ``law`` of their kinetics."""

    austenite_start: Array
    austenite_finish: Array
    martensite_start: Array
    martensite_finish: Array
    weight: Array
    law: str
    stroke: float
    y_lower: float = 0.0

    @property
    def alpha(self) -> Array:
        """Temperatures of transformation on heating."""
        return np.concatenate([self.austenite_start, self.austenite_finish])

    @property
    def beta(self) -> Array:
        """Temperatures of transformation on cooling."""
        return np.concatenate([self.martensite_finish, self.martensite_start])

    @property
    def lower(self) -> float:
        """The temperature below which the wire is martensite."""
        return float(self.martensite_finish.min())

    @property
    def upper(self) -> float:
        """The temperature above which the wire is austenite."""
        return float(self.austenite_finish.max())

    def initial(self, *, two_wire: bool) -> "KineticState":
        """The state of a cold wire; two wires are not described by this law."""
        if two_wire:
            raise ValueError("a kinetic law describes one wire")
        return KineticState(self)


@dataclass
class KineticState:
    """The austenite fraction of every grain of a wire; initially none."""

    hysteresis: KineticHysteresis
    u: float = 0.0
    _austenite: Array = field(init=False)

    def __post_init__(self) -> None:
        self._austenite = np.zeros(self.hysteresis.weight.size)

    @property
    def share(self) -> float:
        """Austenite fraction of the wire, 0…1."""
        return float(self.hysteresis.weight @ self._austenite)

    def move(self, u: float) -> float:
        """Move to a temperature directly; returns the austenite fraction there."""
        self._austenite, self.u = self._at(u), u
        return self.share

    def move_coupled(self, hysteresis_input: Callable[[Array], Array]) -> float:
        """Move until the temperature, which depends on the fraction, agrees with it (bisection)."""

        def excess(u: float) -> float:
            fraction = self.hysteresis.weight @ self._at(u)
            return float(hysteresis_input(np.array([fraction]))[0]) - u

        ends = [float(hysteresis_input(np.array([x]))[0]) for x in (0.0, self.share, 1.0)]
        low, high = min(*ends, self.u), max(*ends, self.u)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if excess(middle) > 0 else (low, middle)
        return self.move(0.5 * (low + high))

    def _at(self, u: float) -> Array:
        h = self.hysteresis
        if u > self.u:
            ends = h.austenite_start, h.austenite_finish
            factor = _remaining(u, *ends, h.law) / np.maximum(_remaining(self.u, *ends, h.law), _LEAST)
            return 1 - (1 - self._austenite) * np.minimum(factor, 1.0)
        ends = h.martensite_start, h.martensite_finish
        factor = _remaining(u, *ends, h.law) / np.maximum(_remaining(self.u, *ends, h.law), _LEAST)
        return self._austenite * np.minimum(factor, 1.0)


BoxHysteresis = RelayHysteresis | KineticHysteresis


def _remaining(u: float, start: Array, finish: Array, law: str) -> Array:
    """Share of a phase that remains at a temperature, if all of it was there before the start."""
    done = np.clip((u - start) / (finish - start), 0.0, 1.0)
    if law == "cosine":
        return 0.5 * (1 + np.cos(np.pi * done))
    return np.where(done < 1, _REMAINS**done, 0.0)


def random_kinetic_hysteresis(rng: np.random.Generator, wire: BoxWire) -> KineticHysteresis:
    """A wire of one to thirty grains within the reach of the wire's current."""
    high = 0.86 * wire.reference_K
    grains = int(rng.choice([1, 3, 8, 30]))
    law = str(rng.choice(["cosine", "exponential"]))
    middle_K = high * rng.uniform(0.45, 0.6) + rng.uniform(2, 6) * rng.standard_normal(grains)
    width_K = rng.uniform(6, 28) * np.exp(0.2 * rng.standard_normal(grains))
    spans = rng.uniform(8, 22, 2) * np.exp(0.2 * rng.standard_normal((grains, 2)))
    rising, falling = middle_K + width_K / 2, middle_K - width_K / 2
    weight = rng.dirichlet(np.full(grains, 4.0))
    return KineticHysteresis(
        austenite_start=np.clip(rising - spans[:, 0] / 2, 8.0, high - 4.0),
        austenite_finish=np.clip(rising + spans[:, 0] / 2, 12.0, high),
        martensite_start=np.clip(falling + spans[:, 1] / 2, 10.0, high - 2.0),
        martensite_finish=np.clip(falling - spans[:, 1] / 2, 6.0, high - 6.0),
        weight=weight,
        law=law,
        stroke=float(rng.uniform(8, 14)),
    )

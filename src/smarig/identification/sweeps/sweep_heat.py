"""The heat of a wire along a sweep, where its time constant is not constant: latent heat and free convection.

With θ the temperature above ambient, y the measured position and s the steady input of the current (5.3),

    τ d(θ + Λ y)/dt = ρ s − q,      q = u₀ (θ/u₀)^(1+n),      u = q/ρ

The transformation takes the heat of Λ kelvin per unit of position, ρ is the wire's resistance over its mean, and n is
the exponent of h ∝ θⁿ. u is the input whose current would hold the wire there: the input of settled points. So τ is
m c/(h A) at θ = u₀, half the range, without transformation. With Λ = n = 0 and ρ = 1 this is (5.1).
"""

import math
from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.plant import Actuator, free_convection_W_per_m2_K

ROOM_DEGC = 22.0  # the exponent hardly depends on it
_FLATTEST = 0.01  # of u₀: below it the slope of q is that at this temperature


@dataclass(frozen=True)
class SweepHeat:
    """What (5.1) leaves out. ``resistances`` at the positions ``ends``; None: constant."""

    latent_K_per_unit: float = 0.0
    exponent: float = 0.0
    resistances_ohm: tuple[float, float] | None = None
    ends: tuple[float, float] = (0.0, 1.0)

    @property
    def is_constant_tau(self) -> bool:
        """Whether the law is (5.1)."""
        return self.latent_K_per_unit == 0 and self.exponent == 0 and self.resistances_ohm is None

    def relative_resistance(self, position: Array) -> Array:
        """ρ (n,) at positions (n,)."""
        if self.resistances_ohm is None:
            return np.ones_like(position)
        low, high = self.resistances_ohm
        share = np.clip((position - self.ends[0]) / (self.ends[1] - self.ends[0]), 0.0, 1.0)
        return (low + (high - low) * share) / ((low + high) / 2)


def heated_along(
    heat: SweepHeat,
    tau_s: float,
    source_K: Array,
    dt_s: Array,
    position: Array,
    start_K: float,
    middle_K: float,
) -> tuple[Array, Array]:
    """θ and u (n,) after each sample, from rest at ``start_K``; ``middle_K`` is u₀.

    A step is exact for a constant slope of q over it.
    """
    rho = heat.relative_resistance(position)
    drops = heat.latent_K_per_unit * np.diff(position, prepend=position[0])
    one_n = 1.0 + heat.exponent
    theta = math.copysign(middle_K * (abs(start_K * rho[0]) / middle_K) ** (1 / one_n), start_K)
    lost, found = start_K * rho[0], np.empty((2, position.size))
    over_step = (rho + np.concatenate((rho[:1], rho[:-1]))) / 2
    samples = zip((over_step * source_K).tolist(), dt_s.tolist(), rho.tolist(), drops.tolist())
    for k, (source, dt, resistance, drop) in enumerate(samples):
        size = max(abs(theta) / middle_K, _FLATTEST)
        slope = one_n * size**heat.exponent
        theta += (source - lost) / slope * (1 - math.exp(-dt * slope / tau_s)) - drop
        lost = math.copysign(middle_K * (abs(theta) / middle_K) ** one_n, theta)
        found[0, k], found[1, k] = theta, lost / resistance
    return found[0], found[1]


def convection_exponent(actuator: Actuator, range_K: float) -> float:
    """n of h ∝ θⁿ in still air by Churchill and Chu (1975), from a quarter of a range of temperature to all of it.

    >>> round(convection_exponent(Actuator.named("gorbet_one_wire"), 100.0), 3)
    0.126
    """
    diameter_m = actuator.file.wire.diameter.value / 1000
    low, high = (
        free_convection_W_per_m2_K(diameter_m, ROOM_DEGC + share * range_K, ROOM_DEGC)
        for share in (0.25, 1.0)
    )
    return math.log(high / low) / math.log(4.0)

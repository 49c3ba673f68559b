"""Joule heating of a wire (5.1), exact for a current that is constant over a tick.

    ρ c_p V dT/dt = R i² − h A T   ⇒   T(t+dt) = T_ss + (T(t) − T_ss) e^(−dt/τ),   T_ss = (R/hA) i²

T is above ambient. R, h and c_p are the thesis's constants; effects change them.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array
from smarig.plant.actuator import Actuator


class JouleHeating:
    """Temperatures of the rig's wires. In the differential rig the diodes steer i > 0 to wire 1.

    >>> heating = JouleHeating(Actuator.named("gorbet_two_wire"), dt_s=0.1)
    >>> for _ in range(1000):
    ...     u = heating.step(-1.0)
    >>> round(u, 1), round(heating.wire_K[1], 1)
    (-185.0, 185.0)
    """

    def __init__(self, actuator: Actuator, dt_s: float) -> None:
        self.two_wire = actuator.two_wire
        self.gain_K_per_A2 = actuator.gain_K_per_A2
        self.tau_s = actuator.tau_s
        self.tick(dt_s)
        self.wire_K = [0.0, 0.0]

    def step(self, current_A: float) -> float:
        """Advance one tick at a constant current and return the hysteresis input u (T, or T₁ − T₂) in kelvin."""
        return self.relax(self.source(current_A))

    def source(self, current_A: float) -> float:
        """Steady hysteresis input of a current (5.3) in kelvin; negative if wire 2 is heated."""
        source = self.gain_K_per_A2 * current_A * current_A
        return -source if current_A < 0 and self.two_wire else source

    def tick(self, dt_s: float) -> None:
        """Set the length of a tick."""
        self.dt_s, self.decay = dt_s, math.exp(-dt_s / self.tau_s)

    def relax(self, source_K: float, lag: float = 1.0, second_lag: float = 1.0) -> float:
        """Advance one tick towards a steady temperature, whose sign selects the heated wire.

        ``lag`` scales the time constant of wire 1 and ``second_lag`` that of wire 2.
        """
        wires, decay = self.wire_K, self.decay if lag == 1.0 else self._decay(lag)
        if not self.two_wire:
            wires[0] = source_K + (wires[0] - source_K) * decay
            return wires[0]
        first, second = self.ends(source_K)
        wires[0] = first + (wires[0] - first) * decay
        decay = self.decay if second_lag == 1.0 else self._decay(second_lag)
        wires[1] = second + (wires[1] - second) * decay
        return wires[0] - wires[1]

    def ends(self, source_K: float) -> tuple[float, float]:
        """Final temperature of each wire for a signed steady temperature. A single wire is the first value."""
        return (source_K, 0.0) if source_K > 0 or not self.two_wire else (0.0, -source_K)

    def _decay(self, lag: float) -> float:
        return math.exp(-self.dt_s / (self.tau_s * lag))

    @property
    def input_K(self) -> float:
        """The present hysteresis input."""
        return self.wire_K[0] - self.wire_K[1]


def temperature_along(actuator: Actuator, current_A: ArrayLike, dt_s: float) -> Array:
    """Hysteresis input u (n,) after each tick of a current record (n,), from a cold wire."""
    heating = JouleHeating(actuator, dt_s)
    return np.array([heating.step(i) for i in np.asarray(current_A, dtype=float).tolist()])

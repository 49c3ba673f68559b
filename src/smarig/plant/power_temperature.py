"""Temperature of a single wire from its electrical power, by the heat loss that its actuator file states.

    ρ c_p V dT/dt = V·I − h(T) A (T − T_amb)

h is that of free convection (Churchill and Chu 1975) if the table [thermomechanical] says so, else the constant of
[heating]. Unlike (5.1), the power follows the resistance, which falls with the phase. Latent heat is left out, so the
result holds for a wire at rest, and during slow changes.
"""

import math
from collections.abc import Callable

import numpy as np

from smarig.core import Array
from smarig.plant.actuator import Actuator
from smarig.plant.thermomechanical.free_convection import free_convection_W_per_m2_K

ITERATIONS, TOLERANCE_K = 60, 1e-9


class PowerTemperature:
    """Steady and transient temperatures above ambient of one wire.

    >>> wire = PowerTemperature(Actuator.named("thermomechanical_one_wire"))
    >>> round(wire.steady_K(1.0, 22.0), 1)
    45.7
    """

    def __init__(self, actuator: Actuator) -> None:
        wire, thermomechanical = actuator.file.wire, actuator.file.thermomechanical
        diameter_m, length_m = wire.diameter.value / 1000, wire.active_length.value / 1000
        self._surface_m2 = math.pi * diameter_m * length_m
        self._heat_J_per_K = (
            wire.density.value * wire.specific_heat.value * math.pi / 4 * diameter_m**2 * length_m
        )
        free = thermomechanical is not None and thermomechanical.heat_loss == "free_convection"
        constant = actuator.h_W_per_m2_K
        self._h: Callable[[float, float], float] = (
            (lambda rise_K, ambient_degC: free_convection_W_per_m2_K(diameter_m, ambient_degC + rise_K, ambient_degC))
            if free
            else (lambda _rise_K, _ambient_degC: constant)
        )  # fmt: skip

    def steady_K(self, power_W: float, ambient_degC: float) -> float:
        """The steady temperature above ambient at a power; 0 for none."""
        rise_K = 0.0
        for _ in range(ITERATIONS):  # h hardly depends on the temperature, so this converges fast
            before, rise_K = rise_K, power_W / self._conductance(max(rise_K, 1.0), ambient_degC)
            if abs(rise_K - before) <= TOLERANCE_K:
                break
        return rise_K

    def along(self, power_W: Array, dt_s: Array, ambient_degC: Array, start_K: float = 0.0) -> Array:
        """Temperatures above ambient (n,) at the ends of ticks (n,) with these powers."""
        rise_K, found = start_K, np.empty(power_W.size)
        for k, (power, dt, ambient) in enumerate(zip(power_W.tolist(), dt_s.tolist(), ambient_degC.tolist())):
            conductance = self._conductance(max(rise_K, 1.0), ambient)
            steady = power / conductance
            rise_K = steady + (rise_K - steady) * math.exp(-dt * conductance / self._heat_J_per_K)
            found[k] = rise_K
        return found

    def _conductance(self, rise_K: float, ambient_degC: float) -> float:
        return self._surface_m2 * self._h(rise_K, ambient_degC)

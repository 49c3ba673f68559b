"""The limit of stress in two wires that pull against each other: what both being hot would do is refused beforehand."""

import math

from smarig.config import RigFile
from smarig.core import ConfigError
from smarig.plant import Actuator, AntagonistStress, JouleHeating

HOT_K = 1000.0  # above any transformation
TICKS_AHEAD = 2  # a command flows from the next tick on, and its first reading comes after that


def stress_limit(file: RigFile, actuator: Actuator) -> "StressLimit | None":
    """The limit of a rig file, None if it has none. Raises ConfigError if no wire can keep it."""
    limit_MPa = file.limits.stress_max_MPa
    return None if limit_MPa is None else StressLimit(limit_MPa, actuator, file.ambient_degC, file.lease_s)


class StressLimit:
    """``refusal`` says why a current must not flow, ``update`` follows both wires.

    A command may be in effect for a whole lease, if the host is late. So that is how far it is followed beforehand.
    """

    def __init__(self, limit_MPa: float, actuator: Actuator, ambient_degC: float, lease_s: float) -> None:
        if not actuator.two_wire:
            raise ConfigError("limits.stress_max_MPa applies to two wires; this actuator has one. Remove it.")
        self._limit_MPa, self._lease_s = limit_MPa, lease_s
        self._wires = AntagonistStress(ambient_degC)
        self._wires.step((0.0, 0.0))
        one_hot_MPa = self._wires.stress_at((HOT_K, 0.0))
        if limit_MPa < one_hot_MPa:
            raise ConfigError(
                f"limits.stress_max_MPa = {limit_MPa:g} is below {one_hot_MPa:.0f} MPa, the stress with one hot wire "
                f"at ambient_degC = {ambient_degC:g}. Raise it, or cool the room."
            )

    def start_hot(self, wire_K: list[float]) -> None:
        """Start with wires that may be this hot."""
        self._wires.start(wire_K)

    def update(self, wire_K: list[float]) -> None:
        """Follow both wires for one tick."""
        self._wires.step(wire_K)

    def refusal(self, heating: JouleHeating, current_A: float) -> str:
        """Why this current must not flow until the lease ends; "" if it may."""
        if not current_A:
            return ""
        decay = math.exp(-(self._lease_s + TICKS_AHEAD * heating.dt_s) / heating.tau_s)
        heated = 0 if current_A > 0 else 1
        ahead = list(heating.wire_K)
        steady_K = abs(heating.source(current_A))
        ahead[heated] = max(ahead[heated], steady_K + (ahead[heated] - steady_K) * decay)
        stress_MPa = self._wires.stress_at(ahead)
        if stress_MPa <= self._limit_MPa:
            return ""
        return (
            f"Both wires would be hot ({ahead[0]:.0f} K and {ahead[1]:.0f} K above ambient), with a stress of up to "
            f"{stress_MPa:.0f} MPa; the limit is stress_max_MPa = {self._limit_MPa:g}. Let one wire cool before the "
            "other is heated."
        )

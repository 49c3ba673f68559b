"""The shaft that two antagonist wires turn: an external torque as a difference of their stresses, and its angle.

    (σ₁ − σ₂) A r = M,      ε₁ + ε₂ = 2 ε_p if both are tight,      θ = L (ε_p − ε₁)/r = L (ε₂ − ε₁)/(2r)

M > 0 acts against positive angles, so wire 1 lifts it. A wire cannot push. Where the less loaded one is slack, the
other alone carries the torque and gives the angle.
"""

import math
from typing import TypeVar

from smarig.config import ActuatorFile
from smarig.core import Array

Strain = TypeVar("Strain", float, Array)


def load_MPa_of(file: ActuatorFile) -> float:
    """σ₁ − σ₂ = M/(A r) of the torque in an actuator file; 0 without one."""
    torque = file.thermomechanical.shaft_torque if file.thermomechanical else None
    if torque is None:
        return 0.0
    section_mm2 = math.pi / 4 * file.wire.diameter.value**2
    return torque.value / (section_mm2 * file.transmission.radius.value)


def extra_stresses_MPa(load_MPa: float) -> tuple[float, float]:
    """By how much the stress of each wire exceeds the smaller of both.

    >>> extra_stresses_MPa(50.0), extra_stresses_MPa(-50.0)
    ((50.0, 0.0), (0.0, 50.0))
    """
    return max(load_MPa, 0.0), max(-load_MPa, 0.0)


def shaft_strain(first: Strain, second: Strain, pre_strain: float, load_MPa: float) -> Strain:
    """2 r θ/L from the strains of both wires: ε₂ − ε₁, or with a load from the strain of the loaded wire alone.

    >>> round(shaft_strain(0.02, 0.05, 0.03, 100.0), 3)  # wire 2 is slack: it is longer than 2 ε_p − ε₁
    0.02
    """
    if load_MPa > 0.0:
        return 2.0 * (pre_strain - first)
    if load_MPa < 0.0:
        return 2.0 * (second - pre_strain)
    return second - first

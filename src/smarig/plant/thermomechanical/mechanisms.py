"""What loads the wires: a dead weight on one, or two wires on one shaft that pull against each other."""

import math
from typing import Protocol

from smarig.config import ActuatorFile
from smarig.core import ConfigError
from smarig.plant.thermomechanical.monotone_root import increasing_root
from smarig.plant.thermomechanical.shaft import extra_stresses_MPa, load_MPa_of, shaft_strain
from smarig.plant.thermomechanical.wire import Heating, Wire, WireState

MM, TOLERANCE_MPA = 1000.0, 1e-5
LEAST_WAY_MPA, LEAST_SHARE = 1e-3, 0.001  # a root so near tells nothing about the next one
SAFETY = 0.8  # of the least slope of strain over stress


class WireMechanism(Protocol):
    """Wires and their load."""

    @property
    def wires(self) -> tuple[Wire, ...]:
        """One, or two on one shaft."""
        ...

    def advance(self, heating: tuple[Heating, ...], force_N: float | None) -> None:
        """Let one step pass, with one heating for each wire. ``force_N``: the load, if it is not that of the start."""
        ...

    @property
    def position(self) -> float:
        """Position in the rig's unit; 0 at the start."""
        ...


class DeadWeight:
    """One wire under a force: σ = F/A. The position is the contraction in mm. ``force_N``: in place of the file's."""

    def __init__(
        self, wire: Wire, file: ActuatorFile, ambient_degC: float, force_N: float | None = None
    ) -> None:
        force = file.thermomechanical.force if file.thermomechanical else None
        if force is None:
            raise ConfigError(f"Actuator {file.name} has no thermomechanical.force. Give the weight in N.")
        self.wires, self.force_N = (wire,), force.value if force_N is None else force_N
        wire.start(ambient_degC)
        wire.load(self._stress_MPa(self.force_N))
        self._rest = wire.state.strain

    def advance(self, heating: tuple[Heating, ...], force_N: float | None) -> None:
        """One step; the force changes linearly over it."""
        wire = self.wires[0]
        stress_MPa = self._stress_MPa(self.force_N if force_N is None else force_N)
        wire.begin(heating[0])
        wire.commit(wire.at_stress(stress_MPa))

    @property
    def position(self) -> float:
        """Contraction in mm."""
        wire = self.wires[0]
        return MM * wire.length_m * (self._rest - wire.state.strain)

    def _stress_MPa(self, force_N: float) -> float:
        return force_N / self.wires[0].section_m2 / 1e6


class Antagonists:
    """Two equal wires on one shaft: strains that add up to twice the pre-strain, and stresses that carry the torque.

        σ₁ − σ₂ = M/(A r),      ε₁(σ₁) + ε₂(σ₂) = 2 ε_p,      θ = L (ε₂ − ε₁)/(2 r)

    Wires cannot push: where the sum of the strains is larger with the smaller stress at 0, that wire is slack; without
    a torque both are. The angle is in degrees, positive if wire 1 contracts.
    """

    def __init__(self, wires: tuple[Wire, Wire], file: ActuatorFile, ambient_degC: float) -> None:
        pre_strain = file.thermomechanical.pre_strain if file.thermomechanical else None
        if pre_strain is None:
            raise ConfigError(
                f"Actuator {file.name} has no thermomechanical.pre_strain. Give the strain of both wires."
            )
        self.wires, self.pre_strain, self.total_strain = wires, pre_strain.value, 2.0 * pre_strain.value
        self.load_MPa = load_MPa_of(file)
        self._extra_MPa = extra_stresses_MPa(self.load_MPa)
        self._degrees = math.degrees(wires[0].length_m * MM / (2.0 * file.transmission.radius.value))
        stiffest_MPa = max(wires[0].material.austenite_MPa, wires[0].material.martensite_MPa)
        self._least_slope = SAFETY * 2.0 / stiffest_MPa
        self._share, self._rise_MPa = 1.0, 0.0  # of the last step: nearly the same in the next one
        for wire in wires:
            wire.start(ambient_degC)
        self._stress_MPa = self._assembled_MPa()  # the smaller one
        for wire, extra_MPa in zip(wires, self._extra_MPa):
            wire.load(self._stress_MPa + extra_MPa)

    def _assembled_MPa(self) -> float:
        """The smaller stress after both cold wires were stretched by the pre-strain, under the torque."""

        def excess(stress_MPa: float) -> tuple[float, None]:
            each = zip(self.wires, self._extra_MPa)
            return sum(
                wire.loaded(stress_MPa + extra).strain for wire, extra in each
            ) - self.total_strain, None

        at_zero = excess(0.0)
        return increasing_root(excess, 0.0, at_zero, self._least_slope)[0] if at_zero[0] < 0 else 0.0

    def advance(self, heating: tuple[Heating, ...], force_N: float | None) -> None:
        """One step, to the stress at which both wires fit."""
        if force_N is not None:
            raise ConfigError("Two wires load each other; they take no force.")
        first, second = self.wires
        first_extra, second_extra = self._extra_MPa
        first.begin(heating[0])
        second.begin(heating[1])

        def excess(stress_MPa: float) -> tuple[float, tuple[WireState, WireState]]:
            ends = first.at_stress(stress_MPa + first_extra), second.at_stress(stress_MPa + second_extra)
            return ends[0].strain + ends[1].strain - self.total_strain, ends

        before_MPa = self._stress_MPa
        guess = max(before_MPa + self._rise_MPa, 0.0)
        at_guess = excess(guess)
        way = at_guess[0] / self._least_slope
        if way > 0.0 and guess == 0.0:
            stress_MPa, ends = 0.0, at_guess[1]  # slack
        else:
            end = 0.0 if way > guess else None
            stress_MPa, ends = increasing_root(
                excess, guess, at_guess, self._least_slope, self._share, end, TOLERANCE_MPA
            )
        if abs(way) > LEAST_WAY_MPA:
            self._share = min(max((guess - stress_MPa) / way, LEAST_SHARE), 1.0)
        self._stress_MPa, self._rise_MPa = stress_MPa, stress_MPa - before_MPa
        first.commit(ends[0])
        second.commit(ends[1])

    @property
    def position(self) -> float:
        """Angle of the shaft in degrees."""
        first, second = (wire.state.strain for wire in self.wires)
        return self._degrees * shaft_strain(first, second, self.pre_strain, self.load_MPa)

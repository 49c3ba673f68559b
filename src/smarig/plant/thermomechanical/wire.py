"""One wire: its state, and one step of time at a given stress, from the balance of energy.

    d/dt [ρ c_p T − ρ L ξ + σ²/(2E)] V  =  i² R − h A (T − T_amb) + σ V dε/dt

The left side is stored: sensible heat, latent heat, elastic energy. σ dε is the work of the load on the wire. What the
load does against the transformation strain is therefore heat, and a wire that lifts its load takes it from its heat.
A step is implicit, with the means of its start and end, so the terms sum up exactly.

    R = ρ(ξ, T) L (1 + ε)² / A       (constant volume)
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from smarig.config import ActuatorFile
from smarig.plant.thermomechanical.free_convection import free_convection_W_per_m2_K
from smarig.plant.thermomechanical.kinetics import TWINNED_MARTENSITE, Phase, transformed
from smarig.plant.thermomechanical.material import Material
from smarig.plant.thermomechanical.monotone_root import increasing_root

PA = 1e6  # per MPa
SAFETY = 0.9  # of the least slope: resistance and thermal expansion lower it slightly
TOLERANCE_K = 1e-8
LEAST_WAY_K, LEAST_SHARE = 1e-6, 0.02  # a root so near tells nothing about the next one


class WireState(NamedTuple):
    """Temperature, stress, phase, strain from the stress-free martensite at T_ref, resistance, stored energy."""

    temperature_degC: float
    stress_MPa: float
    phase: Phase
    strain: float
    resistance_ohm: float
    stored_J_per_m3: float


class Heating(NamedTuple):
    """What heats a wire during one step: current and ambient temperature, for a time."""

    current_A: float
    ambient_degC: float
    dt_s: float


@dataclass
class Energy:
    """Sums of a wire in joules since its start: electrical + work = lost + stored."""

    electrical_J: float = 0.0
    work_J: float = 0.0  # of the load on the wire
    lost_J: float = 0.0  # to the air
    stored_J: float = 0.0  # sensible, latent and elastic

    @property
    def imbalance_J(self) -> float:
        """What does not balance; rounding and the tolerance of the solver."""
        return self.electrical_J + self.work_J - self.lost_J - self.stored_J


class Wire:
    """A wire with its energy sums; ``begin`` a step, find its end ``at_stress``, and ``commit`` it."""

    def __init__(self, file: ActuatorFile, h_W_per_m2_K: float | None) -> None:
        """``h_W_per_m2_K``: constant heat transfer coefficient; None: free convection."""
        self.material = Material.of(file)
        self.length_m = file.wire.active_length.value / 1000
        self.diameter_m = file.wire.diameter.value / 1000
        self.section_m2 = math.pi / 4 * self.diameter_m**2
        self.volume_m3 = self.section_m2 * self.length_m
        self.surface_m2 = math.pi * self.diameter_m * self.length_m
        self.heat_capacity = self.material.density * self.material.specific_heat  # J/(m³ K)
        self._h = h_W_per_m2_K
        self._share = 1.0  # where the last root lay in its bracket: nearly the same in the next step
        self._guess = self._rise_K = 0.0  # of the end's temperature: the last rise goes on
        self.energy = Energy()
        self.state: WireState

    def start(self, temperature_degC: float, phase: Phase = TWINNED_MARTENSITE) -> None:
        """Start without stress, in twinned martensite if nothing else is said."""
        self.state = self._state(temperature_degC, 0.0, phase)

    def load(self, stress_MPa: float) -> None:
        """Load at the present temperature; the energy sums start from there."""
        self.state, self.energy = self.loaded(stress_MPa), Energy()

    def loaded(self, stress_MPa: float) -> WireState:
        """The state after loading to this stress at the present temperature."""
        before = self.state
        phase = transformed(self.material, before.phase, before.temperature_degC, stress_MPa)
        return self._state(before.temperature_degC, stress_MPa, phase)

    def begin(self, heating: Heating) -> None:
        """Begin a step: what its end does not change is computed once."""
        before, self._heating = self.state, heating
        T_before = before.temperature_degC
        self._guess = T_before + self._rise_K
        h = self._h or free_convection_W_per_m2_K(self.diameter_m, T_before, heating.ambient_degC)
        self._conductance = h * self.surface_m2
        self._half_square = 0.5 * heating.current_A * heating.current_A
        self._per_m3_s = heating.dt_s / self.volume_m3
        self._constant_W = (
            self._half_square * before.resistance_ohm
            + self._conductance * (heating.ambient_degC - 0.5 * T_before)
        )  # fmt: skip
        self._least_slope = SAFETY * (self.heat_capacity + self._per_m3_s * 0.5 * self._conductance)

    def at_stress(self, stress_MPa: float) -> WireState:
        """The end of the step if it ends at this stress."""
        material, before = self.material, self.state
        _, stress_before, phase_before, strain_before, _, stored_before = before
        half_square, half_loss, per_m3_s = self._half_square, 0.5 * self._conductance, self._per_m3_s
        half_stress, constant_W = 0.5 * PA * (stress_MPa + stress_before), self._constant_W

        def imbalance(temperature_degC: float) -> tuple[float, WireState]:
            phase = transformed(material, phase_before, temperature_degC, stress_MPa)
            end = self._state(temperature_degC, stress_MPa, phase)
            heat_W = constant_W + half_square * end.resistance_ohm - half_loss * temperature_degC
            work = half_stress * (end.strain - strain_before)
            return end.stored_J_per_m3 - stored_before - work - per_m3_s * heat_W, end

        guess, at_guess = self._guess, imbalance(self._guess)
        self._guess, end = increasing_root(
            imbalance, guess, at_guess, self._least_slope, self._share, tolerance=TOLERANCE_K
        )
        way = at_guess[0] / self._least_slope
        if abs(way) > LEAST_WAY_K:
            self._share = min(max((guess - self._guess) / way, LEAST_SHARE), 1.0)
        return end

    def commit(self, end: WireState) -> None:
        """Accept the end of the step and add its energies."""
        before, heating, e = self.state, self._heating, self.energy
        self._rise_K = end.temperature_degC - before.temperature_degC
        mean_degC = 0.5 * (before.temperature_degC + end.temperature_degC)
        ohm = 0.5 * (before.resistance_ohm + end.resistance_ohm)
        e.electrical_J += heating.current_A * heating.current_A * ohm * heating.dt_s
        e.lost_J += self._conductance * (mean_degC - heating.ambient_degC) * heating.dt_s
        mean_stress = 0.5 * PA * (before.stress_MPa + end.stress_MPa)
        e.work_J += mean_stress * (end.strain - before.strain) * self.volume_m3
        e.stored_J += (end.stored_J_per_m3 - before.stored_J_per_m3) * self.volume_m3
        self.state = end

    def _state(self, temperature_degC: float, stress_MPa: float, phase: Phase) -> WireState:
        m = self.material
        martensite = phase.detwinned + phase.twinned
        strain = m.strain(stress_MPa, temperature_degC, martensite, phase.detwinned)
        length = self.length_m * (1.0 + strain)
        ohm = m.resistivity_ohm_m(temperature_degC, martensite) * length * length
        stored = (
            self.heat_capacity * temperature_degC
            - m.density * m.latent_J_per_kg * martensite
            + 0.5 * PA * stress_MPa * stress_MPa / m.modulus_MPa(martensite)
        )
        return WireState(temperature_degC, stress_MPa, phase, strain, ohm / self.volume_m3, stored)

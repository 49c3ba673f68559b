"""Synthetic wires: constants drawn about two known rigs, and the actuator file that a lab would write."""

import math
from dataclasses import dataclass

import numpy as np

DENSITY = 6450.0  # kg/m³
_OHM_MM = 8.8e-4  # resistivity, Ω mm


@dataclass(frozen=True)
class BoxWire:
    """Constants of a wire rig; temperatures above ambient.

    ``reference_K`` is the steady temperature of ``reference_A``, the largest commanded current.
    """

    arrangement: str
    diameter_mm: float
    length_mm: float
    specific_heat: float  # J/(kg K)
    resistance_ohm: float
    reference_A: float
    reference_K: float
    radius_mm: float

    @property
    def two_wire(self) -> bool:
        """Two wires against each other; the sign of the current selects the heated wire."""
        return self.arrangement == "two_wire"

    @property
    def unit(self) -> str:
        """The unit of position."""
        return "deg" if self.two_wire else "mm"

    @property
    def gain_K_per_A2(self) -> float:
        """Steady temperature per squared current."""
        return self.reference_K / self.reference_A**2

    @property
    def tau_s(self) -> float:
        """Heat capacity divided by heat loss."""
        capacity = DENSITY * self.specific_heat * math.pi / 4 * self.diameter_mm**2 * self.length_mm * 1e-9
        return capacity * self.gain_K_per_A2 / self.resistance_ohm

    @property
    def per_count(self) -> float:
        """Position of a count of a wheel of 2000."""
        return 0.18 if self.two_wire else 2 * math.pi * self.radius_mm / 2000

    @property
    def per_radian(self) -> float:
        """Position of a radian of the pulley."""
        return math.degrees(1) if self.two_wire else self.radius_mm

    def command(self, target_K: float) -> float:
        """The current whose steady temperature is the target, by these constants."""
        return math.copysign(math.sqrt(abs(target_K) / self.gain_K_per_A2), target_K)


def random_wire(rng: np.random.Generator, *, two_wire: bool | None = None) -> BoxWire:
    """A wire with a time constant between 1 and 15 s; one in five is a pair, unless ``two_wire`` decides."""
    pair = rng.random() < 0.2
    two_wire = pair if two_wire is None else two_wire
    while True:
        diameter_mm = rng.uniform(0.15, 0.5)
        length_mm = rng.uniform(100, 250) if two_wire else rng.uniform(200, 450)
        resistance_ohm = _OHM_MM * length_mm / (math.pi / 4 * diameter_mm**2) * rng.uniform(0.9, 1.1)
        h_W_per_m2_K = 76 * (0.3 / diameter_mm) ** 0.6 * rng.uniform(0.8, 1.25)
        loss_W_per_K = h_W_per_m2_K * math.pi * diameter_mm * length_mm * 1e-6
        reference_K = rng.uniform(150, 200)
        wire = BoxWire(
            arrangement="two_wire" if two_wire else "one_wire",
            diameter_mm=_rounded(diameter_mm),
            length_mm=_rounded(length_mm),
            specific_heat=_rounded(rng.uniform(460, 900)),
            resistance_ohm=_rounded(resistance_ohm),
            reference_A=_rounded(math.sqrt(reference_K * loss_W_per_K / resistance_ohm)),
            reference_K=_rounded(reference_K),
            radius_mm=3.0 if two_wire else _rounded(rng.uniform(12, 18)),
        )
        if 1 <= wire.tau_s <= 15:
            return wire


def _rounded(value: float) -> float:
    """The value with four figures, as a lab would write it; the file is then exact."""
    return float(f"{value:.4g}")


def actuator_toml(wire: BoxWire, name: str) -> str:
    """The actuator file: the constants of the wire without hidden effects."""
    r = f'{{ value = {wire.resistance_ohm!r}, unit = "ohm", source = "measured cold" }}'
    return f'''\
name = "{name}"
arrangement = "{wire.arrangement}"
source = "an imaginary wire of the diagnosis benchmark"

[wire]
material = "NiTi"
diameter = {{ value = {wire.diameter_mm!r}, unit = "mm", source = "calliper" }}
active_length = {{ value = {wire.length_mm!r}, unit = "mm", source = "ruler" }}
density = {{ value = {DENSITY!r}, unit = "kg/m^3", source = "typical NiTi" }}
specific_heat = {{ value = {wire.specific_heat!r}, unit = "J/(kg K)", source = "typical NiTi" }}

[heating]
resistance_martensite = {r}
resistance_austenite = {r}
reference_current = {{ value = {wire.reference_A!r}, unit = "A", source = "the largest current" }}
reference_temperature = {{ value = {wire.reference_K!r}, unit = "K", source = "steady state above ambient" }}

[transmission]
unit = "{wire.unit}"
radius = {{ value = {wire.radius_mm!r}, unit = "mm", source = "calliper" }}

[hysteresis]
surface = "{"two_e" if wire.two_wire else "one_e"}"
initial = "{"anhysteretic" if wire.two_wire else "negative"}"
'''

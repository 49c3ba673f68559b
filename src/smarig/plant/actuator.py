"""The constants of an actuator, given and derived: equations (5.1)–(5.3).

For the differential rig the temperature is signed.
"""

import math
from dataclasses import dataclass
from functools import cached_property

from smarig.config import ActuatorFile, EncoderFile, load_actuator
from smarig.core import ConfigError, DataError
from smarig.preisach import Everett, load_hysteresis, thesis_surface


@dataclass(frozen=True)
class Actuator:
    """Constants of the wires and their mechanism, in SI units. Inputs are kelvin above ambient, signed for two wires.

    >>> wire = Actuator.named("gorbet_one_wire")
    >>> round(wire.hA_W_per_K, 4), round(wire.tau_s, 1)
    (0.0273, 5.3)
    """

    file: ActuatorFile

    @classmethod
    def named(cls, name: str) -> "Actuator":
        """The actuator of a file in configs/actuators, by name or path."""
        return cls(load_actuator(name))

    @property
    def name(self) -> str:
        """Name of the parameter set."""
        return self.file.name

    @property
    def two_wire(self) -> bool:
        """Whether the rig is differential: the sign of current and temperature then selects the wire."""
        return self.file.arrangement == "two_wire"

    @property
    def unit(self) -> str:
        """Unit of position: mm or deg."""
        return self.file.transmission.unit

    @cached_property
    def hysteresis(self) -> Everett:
        """The operator of a twin, with which a bench compares its readings: of Table 5.1, or the file's model.

        Raises ConfigError for values that are no hysteresis, or none of a rig: in another unit, or falling when heated.
        """
        section = self.file.hysteresis
        if section.surface is not None:
            return thesis_surface(section.surface)
        where = f"Actuator {self.name}: key 'hysteresis.model'"
        try:
            found = load_hysteresis(section.model)
        except DataError as error:
            raise ConfigError(f"{where}: {error}") from None
        unit = getattr(found, "unit", self.unit)
        if unit != self.unit:
            raise ConfigError(f"{where} is in {unit}, but the position of this wire in {self.unit}.")
        if not found.everett(found.upper, found.lower) > 0:
            raise ConfigError(f"{where}: its output falls when the wire is heated; a rig's position rises.")
        return found

    @property
    def stroke(self) -> float:
        """Position between both saturations of the hysteresis, mm or deg."""
        h = self.hysteresis
        return h.everett(h.upper, h.lower)

    @property
    def resistance_ohm(self) -> float:
        """Mean resistance R = (R_M + R_A)/2 of (5.3)."""
        h = self.file.heating
        return (h.resistance_martensite.value + h.resistance_austenite.value) / 2

    @property
    def resistance_range_ohm(self) -> tuple[float, float]:
        """The smallest and the largest resistance of the wire, of its two phases."""
        low, high = sorted((self.resistance_at_ohm(0.0), self.resistance_at_ohm(1.0)))
        return low, high

    def resistance_at_ohm(self, austenite: float) -> float:
        """R(ξ) = R_M + ξ (R_A − R_M), ξ the austenite fraction in [0, 1]."""
        martensite, change = self._phases_ohm
        return martensite + austenite * change

    @cached_property
    def _phases_ohm(self) -> tuple[float, float]:
        """R_M and R_A − R_M; kept, because every tick of a twin needs them."""
        h = self.file.heating
        return h.resistance_martensite.value, h.resistance_austenite.value - h.resistance_martensite.value

    @cached_property
    def gain_K_per_A2(self) -> float:
        """R/hA: steady temperature per squared current (5.3)."""
        h = self.file.heating
        return h.reference_temperature.value / h.reference_current.value**2

    @property
    def hA_W_per_K(self) -> float:
        """Heat loss per kelvin, hA = R/(R/hA)."""
        return self.resistance_ohm / self.gain_K_per_A2

    @property
    def h_W_per_m2_K(self) -> float:
        """Heat transfer coefficient over the wire's surface π d L."""
        return self.hA_W_per_K / (math.pi * self._diameter_m * self._length_m)

    @cached_property
    def tau_s(self) -> float:
        """τ = ρ c_p V / (hA), thesis §5.1.3."""
        wire = self.file.wire
        volume_m3 = math.pi / 4 * self._diameter_m**2 * self._length_m
        return wire.density.value * wire.specific_heat.value * volume_m3 / self.hA_W_per_K

    def current_for(self, input_K: float) -> float:
        """I = sign(T) √(|T| hA/R), the steady current for a temperature (§5.2.1)."""
        return math.copysign(math.sqrt(abs(input_K) / self.gain_K_per_A2), input_K)

    def input_for(self, current_A: float) -> float:
        """T_ss = (R/hA) i² (5.3); in the differential rig with the sign of i, which selects the wire."""
        steady = self.gain_K_per_A2 * current_A**2
        return -steady if current_A < 0 and self.two_wire else steady

    def position_per_count(self, counts_per_rev: int) -> float:
        """Position per encoder count: 2πr/N in mm, 360/N in degrees."""
        turn = 360.0 if self.unit == "deg" else 2 * math.pi * self.file.transmission.radius.value
        return turn / counts_per_rev

    def resolution(self, encoder: EncoderFile) -> float:
        """Position of one count: that of the rig file for analogue sensors, else that of the encoder (mm or deg)."""
        return encoder.resolution or self.position_per_count(encoder.counts_per_rev)

    @property
    def _diameter_m(self) -> float:
        return self.file.wire.diameter.value / 1000

    @property
    def _length_m(self) -> float:
        return self.file.wire.active_length.value / 1000

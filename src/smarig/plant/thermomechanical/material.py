"""The constants of the alloy in Brinson's model, and its algebraic laws: modulus, strain, resistivity, phase diagram.

Temperatures are in °C, stresses in MPa, strains are dimensionless; tension is positive. References:
L. C. Brinson, J. Intell. Mater. Syst. Struct. 4 (1993) 229-242; L. C. Brinson and M. S. Huang, J. Intell. Mater. Syst.
Struct. 7 (1996) 108-114.
"""

import math
from dataclasses import dataclass

from smarig.config import ActuatorFile
from smarig.core import ConfigError


@dataclass(frozen=True, slots=True)
class Material:
    """The alloy. ``stress_start_MPa`` and ``stress_finish_MPa`` are σ_s^cr and σ_f^cr at and below M_s."""

    austenite_MPa: float  # E_A
    martensite_MPa: float  # E_M
    residual_strain: float  # ε_L, of detwinned martensite
    martensite_finish_degC: float
    martensite_start_degC: float
    austenite_start_degC: float
    austenite_finish_degC: float
    martensite_slope: float  # C_M, MPa/K
    austenite_slope: float  # C_A, MPa/K
    stress_start_MPa: float
    stress_finish_MPa: float
    austenite_expansion: float  # α_A, 1/K
    martensite_expansion: float  # α_M, 1/K
    reference_degC: float  # thermal expansion and resistivities refer to it
    austenite_ohm_m: float  # ρ_A
    martensite_ohm_m: float  # ρ_M
    austenite_ohm_slope: float  # 1/K
    martensite_ohm_slope: float  # 1/K
    density: float  # kg/m³
    specific_heat: float  # J/(kg K)
    latent_J_per_kg: float  # released by A → M

    @classmethod
    def of(cls, file: ActuatorFile) -> "Material":
        """The alloy of an actuator file. ConfigError if the file has no table [thermomechanical]."""
        t = file.thermomechanical
        if t is None:
            raise ConfigError(f"Actuator {file.name} has no table [thermomechanical]. Add one.")
        return cls(
            austenite_MPa=t.modulus_austenite.value,
            martensite_MPa=t.modulus_martensite.value,
            residual_strain=t.residual_strain.value,
            martensite_finish_degC=t.martensite_finish.value,
            martensite_start_degC=t.martensite_start.value,
            austenite_start_degC=t.austenite_start.value,
            austenite_finish_degC=t.austenite_finish.value,
            martensite_slope=t.slope_martensite.value,
            austenite_slope=t.slope_austenite.value,
            stress_start_MPa=t.critical_stress_start.value,
            stress_finish_MPa=t.critical_stress_finish.value,
            austenite_expansion=t.expansion_austenite.value,
            martensite_expansion=t.expansion_martensite.value,
            reference_degC=t.reference_temperature.value,
            austenite_ohm_m=t.resistivity_austenite.value,
            martensite_ohm_m=t.resistivity_martensite.value,
            austenite_ohm_slope=t.resistivity_slope_austenite.value,
            martensite_ohm_slope=t.resistivity_slope_martensite.value,
            density=file.wire.density.value,
            specific_heat=file.wire.specific_heat.value,
            latent_J_per_kg=t.latent_heat.value,
        )

    def modulus_MPa(self, martensite: float) -> float:
        """E(ξ) = E_A + ξ (E_M − E_A), Brinson (1993)."""
        return self.austenite_MPa + martensite * (self.martensite_MPa - self.austenite_MPa)

    def strain(
        self, stress_MPa: float, temperature_degC: float, martensite: float, detwinned: float
    ) -> float:
        """ε = σ/E(ξ) + ε_L ξ_S + α(ξ) (T − T_ref), Brinson and Huang (1996), with α(ξ) = α_A + ξ (α_M − α_A)."""
        expansion = self.austenite_expansion + martensite * (
            self.martensite_expansion - self.austenite_expansion
        )
        return (
            stress_MPa / self.modulus_MPa(martensite)
            + self.residual_strain * detwinned
            + expansion * (temperature_degC - self.reference_degC)
        )

    def resistivity_ohm_m(self, temperature_degC: float, martensite: float) -> float:
        """ρ(ξ, T) = (1 − ξ) ρ_A (1 + β_A ΔT) + ξ ρ_M (1 + β_M ΔT), ΔT = T − T_ref."""
        above_K = temperature_degC - self.reference_degC
        austenite = self.austenite_ohm_m * (1.0 + self.austenite_ohm_slope * above_K)
        return austenite + martensite * (
            self.martensite_ohm_m * (1.0 + self.martensite_ohm_slope * above_K) - austenite
        )

    def reverse_share(self, z_degC: float) -> float:
        """What M → A leaves of the martensite at z = T − σ/C_A: ½ [1 + cos π (z − A_s)/(A_f − A_s)], 1 below A_s."""
        return _falling(z_degC, self.austenite_start_degC, self.austenite_finish_degC)

    def stress_share(self, s_MPa: float) -> float:
        """What the stress s = σ − C_M max(T − M_s, 0) leaves of 1 − ξ_S: 1 below σ_s^cr, 0 above σ_f^cr."""
        return _falling(s_MPa, self.stress_start_MPa, self.stress_finish_MPa)

    def cooling_share(self, temperature_degC: float) -> float:
        """What cooling leaves of the austenite: 1 above M_s, 0 below M_f."""
        return _falling(-temperature_degC, -self.martensite_start_degC, -self.martensite_finish_degC)


def _falling(x: float, start: float, finish: float) -> float:
    """½ [1 + cos π (x − start)/(finish − start)]: 1 before the start, 0 after the finish."""
    if x <= start:
        return 1.0
    if x >= finish:
        return 0.0
    return 0.5 + 0.5 * math.cos(math.pi * (x - start) / (finish - start))

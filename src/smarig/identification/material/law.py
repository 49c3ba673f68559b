"""The constitutive law of Lagoudas et al. (2012) in one dimension, explicit in the fraction of martensite.

    strain          ε = σ S(ξ) + ε^t + α(ξ) (T − T_ref),   S = 1/E_A + ξ ΔS,   ΔS = 1/E_M − 1/E_A
    cooling         T = T_M(σ) − (M_s − M_f) h(ξ; n₁, n₂)
    heating         T = T_A(σ) − (A_f − A_s) h(ξ; n₃, n₄)
    hardening       h(ξ; n, m) = ½ [1 + ξⁿ − (1 − ξ)ᵐ],    0 < n, m ≤ 1

Source: D. Lagoudas, D. Hartl, Y. Chemisky, L. Machado, P. Popov, Int. J. Plasticity 32–33 (2012) 155–183: the
transformation functions (their eqs. 18 and 19) set to zero and solved for T, with the constants ρΔs₀ and D expressed by
the slopes C_A and C_M (their section 3.3). Temperatures are in °C, stresses in MPa, strains dimensionless.
"""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from smarig.core import Array

REFERENCE_DEGC = 22.0  # of thermal expansion: a choice of zero
_LEAST_STRAIN = 1e-6  # a trial law that recovers less has no slope of its boundaries
_LOGITS = np.linspace(-20.0, 20.0, 2001)
_FRACTIONS = np.concatenate([[0.0], 1.0 / (1.0 + np.exp(-_LOGITS)), [1.0]])
_AUSTENITE = np.concatenate([[1.0], 1.0 / (1.0 + np.exp(_LOGITS)), [0.0]])  # 1 − ξ, exact near ξ = 1


@dataclass(frozen=True)
class MaterialLaw:
    """The constants, named as the keys of an actuator file where it has them.

    ``slope_austenite`` and ``slope_martensite`` are C_A and C_M at ``reference_stress``; the strain law has its own
    four constants: ε_L(σ) = H_min + (H_sat − H_min) (1 − e^{−k (σ − σ_crit)}).
    """

    modulus_austenite: float  # E_A
    modulus_martensite: float  # E_M
    strain_least: float  # H_min
    strain_saturated: float  # H_sat
    strain_rate: float  # k, 1/MPa
    strain_stress: float  # σ_crit, MPa
    austenite_start: float  # A_s, at no stress
    austenite_finish: float  # A_f
    martensite_start: float  # M_s
    martensite_finish: float  # M_f
    slope_austenite: float  # C_A, MPa/K
    slope_martensite: float  # C_M, MPa/K
    exponent_cooling_start: float  # n₁
    exponent_cooling_finish: float  # n₂
    exponent_heating_finish: float  # n₃
    exponent_heating_start: float  # n₄
    expansion_austenite: float  # α_A, 1/K
    expansion_martensite: float  # α_M, 1/K
    reference_stress: float  # σ*, MPa
    wide_share: float = 0.0  # w, of the material that transforms over a wider range
    wide_factor: float = 1.0  # q, how many times as wide

    @cached_property
    def compliance_change(self) -> float:
        """ΔS = 1/E_M − 1/E_A in 1/MPa."""
        return 1.0 / self.modulus_martensite - 1.0 / self.modulus_austenite

    @cached_property
    def entropy(self) -> float:
        """−ρΔs₀ in MPa/K: 2 C_A C_M (H + σ H′ + σ ΔS)/(C_A + C_M) at σ*."""
        C_A, C_M = self.slope_austenite, self.slope_martensite
        return 2.0 * C_A * C_M * self._driving_slope / (C_A + C_M)

    @cached_property
    def dissipation(self) -> float:
        """D, which makes the slopes differ: (C_M − C_A)/(C_M + C_A) · (H + σ H′ + σ ΔS)/(H + σ H′) at σ*."""
        C_A, C_M = self.slope_austenite, self.slope_martensite
        return (C_M - C_A) / (C_M + C_A) * self._driving_slope / self._strain_slope

    @cached_property
    def _driving_slope(self) -> float:
        """H + σ H′ + σ ΔS at σ*."""
        return max(self._strain_slope + self.reference_stress * self.compliance_change, _LEAST_STRAIN)

    @cached_property
    def _strain_slope(self) -> float:
        """d(σ H)/dσ = H + σ H′ at σ*."""
        stress, rate = self.reference_stress, self.strain_rate
        slope = 0.0
        if stress > self.strain_stress:
            decay = math.exp(-rate * (stress - self.strain_stress))
            slope = (self.strain_saturated - self.strain_least) * rate * decay
        return max(float(transformation_strain(self, stress)) + stress * slope, _LEAST_STRAIN)


def transformation_strain(law: MaterialLaw, stress_MPa: Array | float) -> Array:
    """ε_L(σ): H_min up to σ_crit, from there on it approaches H_sat exponentially (their eq. 22)."""
    above = np.maximum(np.asarray(stress_MPa) - law.strain_stress, 0.0)
    return law.strain_least + (law.strain_saturated - law.strain_least) * -np.expm1(-law.strain_rate * above)


def hardening(austenite: Array, martensite: Array, first: float, second: float) -> Array:
    """h = ½ [1 + ξⁿ − (1 − ξ)ᵐ], which rises from 0 to 1 (their eq. 20); ``austenite`` is 1 − ξ."""
    return 0.5 * (1.0 + martensite**first - austenite**second)


@lru_cache(maxsize=64)
def _hardening_table(first: float, second: float) -> Array:
    """The hardening function at the fractions of the table."""
    return hardening(_AUSTENITE, _FRACTIONS, first, second)


def fraction_at(progress: Array, first: float, second: float) -> Array:
    """The fraction ξ (n,) of martensite at which the hardening function is ``progress``; 0 below 0, 1 above 1."""
    return np.interp(progress, _hardening_table(first, second), _FRACTIONS)


def _both_parts(law: MaterialLaw, progress: Array, first: float, second: float) -> Array:
    """ξ = (1 − w) ξ(p) + w ξ(½ + (p − ½)/q): of all the material, with the part that transforms over a wider range."""
    narrow = fraction_at(progress, first, second)
    if law.wide_share == 0.0:
        return narrow
    wide = fraction_at(0.5 + (progress - 0.5) / law.wide_factor, first, second)
    return narrow + law.wide_share * (wide - narrow)


def driving_strain_work(law: MaterialLaw, stress_MPa: Array, strain: Array, sign: float) -> Array:
    """(1 ± D) σ Λ + ½ ΔS σ² in MPa: the mechanical part of the driving force; Λ is the direction of transformation."""
    return (1.0 + sign * law.dissipation) * stress_MPa * strain + 0.5 * law.compliance_change * stress_MPa**2


def cooling_start(law: MaterialLaw, stress_MPa: Array) -> Array:
    """T_M(σ) = M_s + [(1 − D) σ H + ½ ΔS σ²]/(−ρΔs₀): where martensite begins to form."""
    work = driving_strain_work(law, stress_MPa, transformation_strain(law, stress_MPa), -1.0)
    return law.martensite_start + work / law.entropy


def heating_finish(law: MaterialLaw, stress_MPa: Array, strain: Array | float | None = None) -> Array:
    """T_A(σ) = A_f + [(1 + D) σ Λ + ½ ΔS σ²]/(−ρΔs₀): where the last martensite vanishes.

    Λ is the transformation strain per fraction of martensite at the reversal; None: H(σ).
    """
    direction = transformation_strain(law, stress_MPa) if strain is None else np.asarray(strain)
    return law.austenite_finish + driving_strain_work(law, stress_MPa, direction, 1.0) / law.entropy


def cooled_fraction(law: MaterialLaw, temperature_degC: Array, stress_MPa: Array) -> Array:
    """ξ (n,) of a wire that was cooled, or loaded, there from austenite."""
    progress = (cooling_start(law, stress_MPa) - temperature_degC) / (
        law.martensite_start - law.martensite_finish
    )
    return _both_parts(law, progress, law.exponent_cooling_start, law.exponent_cooling_finish)


def heated_fraction(
    law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, strain: float | None = None
) -> Array:
    """ξ (n,) of a wire that was heated, or unloaded, there from martensite."""
    progress = (heating_finish(law, stress_MPa, strain) - temperature_degC) / (
        law.austenite_finish - law.austenite_start
    )
    return _both_parts(law, progress, law.exponent_heating_finish, law.exponent_heating_start)


def total_strain(
    law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, fraction: Array, transformed: Array
) -> Array:
    """ε = σ S(ξ) + ε^t + [α_A + ξ (α_M − α_A)] (T − T_ref)."""
    compliance = 1.0 / law.modulus_austenite + fraction * law.compliance_change
    expansion = law.expansion_austenite + fraction * (law.expansion_martensite - law.expansion_austenite)
    return stress_MPa * compliance + transformed + expansion * (temperature_degC - REFERENCE_DEGC)

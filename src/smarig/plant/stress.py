"""Stress in the differential actuator (thesis §5.5.1), and why one input is sufficient.

Both wires have the same stress, and their strains add up to a constant. Heating one wire to austenite moves the
operating point along the martensite plateau of the other, so the stress hardly changes.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class StressStrain:
    """Piecewise linear characteristics (§5.5.1, measured by others). Moduli in MPa per unit strain."""

    martensite_MPa: float = 16800.0
    plateau_MPa: float = 826.0
    plateau_from: float = 0.0136
    austenite_MPa: float = 35917.0
    total_strain: float = 0.06


@dataclass(frozen=True)
class DifferentialStress:
    """Stress σ₀ (cold), strain ε_a of the heated wire, stress σ₁ (hot), and relative change (σ₁ − σ₀)/σ₀."""

    cold_MPa: float
    heated_strain: float
    hot_MPa: float
    relative_change: float


def differential_stress(curve: StressStrain | None = None) -> DifferentialStress:
    """σ₀ = E_m ε_k + E_p (ε_t/2 − ε_k);  E_a ε_a = σ₀ + E_p (ε_t/2 − ε_a);  Δσ/σ₀.

    The thesis prints 242 MPa, 0.7 % and 7.77 %. The last value follows if σ₀ is rounded to 242 in the ratio only.

    >>> s = differential_stress()
    >>> round(s.cold_MPa), round(100 * s.heated_strain, 3), round(100 * s.relative_change, 2)
    (242, 0.726, 7.76)
    >>> round(100 * (s.hot_MPa - 242) / 242, 2)             # as printed: σ₀ rounded
    7.77
    """
    c = curve or StressStrain()
    half = c.total_strain / 2
    cold = c.martensite_MPa * c.plateau_from + c.plateau_MPa * (half - c.plateau_from)
    heated = (cold + c.plateau_MPa * half) / (c.austenite_MPa + c.plateau_MPa)
    hot = c.austenite_MPa * heated
    return DifferentialStress(cold, heated, hot, (hot - cold) / cold)

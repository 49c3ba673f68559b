"""Transformation kinetics of Brinson (1993), in incremental form: phase fractions from temperature and stress.

Three processes, each with a cosine between its start and its finish in the phase diagram:

    A, M_T → M_S   by stress      1 − ξ_S scales with g_S(s),  s = σ − C_M max(T − M_s, 0)       (eqs. 18, 19)
    A → M_T        by cooling     A = 1 − ξ scales with g_T(T)                                   (eq. 19, Δ_Tξ)
    M_S, M_T → A   by heating     ξ_S and ξ_T scale with h(z),  z = T − σ/C_A                    (eq. 20)

A process that starts at its start boundary with ξ₀ and runs monotonically gives Brinson's equations. Interrupted, it
continues where it stopped: within one branch only a further advance transforms. A transformation in the opposite
direction begins a new branch, which starts from the fraction reached and runs over the whole strip. So minor loops of
temperature do not close onto the extremum at which they began: there is no wiping-out, and loops between equal extrema
accommodate. The product form does not depend on how a step is subdivided, and avoids the fractions above 1 of the
printed Δ_Tξ (Chung, Heo and Lee, Smart Mater. Struct. 16 (2007) N1).
"""

from typing import NamedTuple

from smarig.plant.thermomechanical.material import Material


class Phase(NamedTuple):
    """ξ_S and ξ_T, and for each process the least share that its present branch has reached (1: not begun)."""

    detwinned: float  # ξ_S
    twinned: float  # ξ_T
    stress_share: float = 1.0
    cooling_share: float = 1.0
    reverse_share: float = 1.0

    @property
    def martensite(self) -> float:
        """ξ = ξ_S + ξ_T."""
        return self.detwinned + self.twinned


AUSTENITE = Phase(0.0, 0.0)
TWINNED_MARTENSITE = Phase(0.0, 1.0)


def transformed(m: Material, phase: Phase, temperature_degC: float, stress_MPa: float) -> Phase:
    """The phase after a monotone path to this temperature and stress.

    The result does not depend on the subdivision of the path.
    """
    detwinned, twinned, by_stress, by_cooling, reverse = phase
    z = temperature_degC - stress_MPa / m.austenite_slope
    if z > m.austenite_start_degC:
        share = m.reverse_share(z)
        if share < reverse:
            left = share / reverse
            return Phase(detwinned * left, twinned * left, 1.0, 1.0, share)
    above = temperature_degC - m.martensite_start_degC
    stress_share = m.stress_share(stress_MPa - m.martensite_slope * above if above > 0.0 else stress_MPa)
    cooling_share = m.cooling_share(temperature_degC) if above < 0.0 else 1.0
    if stress_share >= by_stress and cooling_share >= by_cooling:
        return phase
    austenite = 1.0 - detwinned - twinned
    if stress_share < by_stress:
        left, by_stress = stress_share / by_stress, stress_share
        austenite *= left
        twinned *= left
    if cooling_share < by_cooling:
        cooled = austenite * (1.0 - cooling_share / by_cooling)
        by_cooling = cooling_share
        austenite -= cooled
        twinned += cooled
    return Phase(1.0 - twinned - austenite, twinned, by_stress, by_cooling)

"""Wires that follow the law of Lagoudas et al. (2012), simulated reading by reading with roots of its functions.

Nothing is shared with the package: the transformation functions are written with the constants ρΔs₀, D, a₁, a₂, a₃ and
Y₀ of the paper, and each reading is the root of Φ = 0 over ξ.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class Wire:
    """Constants of the paper (MPa, °C, 1)."""

    E_A: float = 70e3
    E_M: float = 30e3
    H_min: float = 0.012
    H_sat: float = 0.045
    k: float = 0.012
    stress_crit: float = 0.0
    A_s: float = 62.0
    A_f: float = 78.0
    M_s: float = 55.0
    M_f: float = 38.0
    C_A: float = 8.5
    C_M: float = 7.0
    n: tuple[float, float, float, float] = (0.4, 0.5, 0.35, 0.45)
    alpha_A: float = 12e-6
    alpha_M: float = 8e-6
    at_stress: float = 150.0  # where C_A and C_M are the slopes

    def H(self, stress):
        above = max(stress - self.stress_crit, 0.0)
        return self.H_min + (self.H_sat - self.H_min) * (1 - np.exp(-self.k * above))

    def __post_init__(self):
        s, dS = self.at_stress, 1 / self.E_M - 1 / self.E_A
        step = 1e-4
        moment = ((s + step) * self.H(s + step) - (s - step) * self.H(s - step)) / (2 * step)
        drive = moment + s * dS
        rds = -2 * self.C_M * self.C_A * drive / (self.C_M + self.C_A)
        n1, n2, n3, n4 = self.n
        a1, a2 = rds * (self.M_f - self.M_s), rds * (self.A_s - self.A_f)
        a3 = -a1 / 4 * (1 + 1 / (n1 + 1) - 1 / (n2 + 1)) + a2 / 4 * (1 + 1 / (n3 + 1) - 1 / (n4 + 1))
        found = {
            "dS": dS,
            "rds": rds,
            "D": (self.C_M - self.C_A) * drive / ((self.C_M + self.C_A) * moment),
            "a1": a1,
            "a2": a2,
            "a3": a3,
            "rdu": rds / 2 * (self.M_s + self.A_f),
            "Y0": rds / 2 * (self.M_s - self.A_f) - a3,
        }
        for name, value in found.items():
            object.__setattr__(self, name, value)

    def forward(self, xi, T, stress):
        """Φ_fwd: positive where more martensite forms."""
        f = self.a1 / 2 * (1 + xi ** self.n[0] - (1 - xi) ** self.n[1]) + self.a3
        drive = stress * self.H(stress) + 0.5 * self.dS * stress**2 + self.rds * T - self.rdu
        return drive - f - (self.Y0 + self.D * stress * self.H(stress))

    def reverse(self, xi, T, stress, direction):
        """Φ_rev: positive where martensite vanishes."""
        f = self.a2 / 2 * (1 + xi ** self.n[2] - (1 - xi) ** self.n[3]) - self.a3
        drive = stress * direction + 0.5 * self.dS * stress**2 + self.rds * T - self.rdu
        return -drive + f - (self.Y0 + self.D * stress * direction)

    def follow(self, T, stress, *, martensite):
        """Strain along full or partial branches, each reading a root; partial branches start at a whole phase only."""
        xi, e = (1.0, self.H(stress[0])) if martensite else (0.0, 0.0)
        strain = []
        before = stress[0]
        for t, s in zip(T, stress):
            direction = e / xi if xi > 1e-12 else self.H(s)
            if self.forward(xi, t, s) > 0 and xi < 1:
                new = (
                    1.0
                    if self.forward(1.0, t, s) >= 0
                    else brentq(self.forward, xi, 1.0, args=(t, s), xtol=1e-13)
                )
                e += 0.5 * (self.H(s) + self.H(before)) * (new - xi)
                xi = new
            elif self.reverse(xi, t, s, direction) > 0 and xi > 0:
                new = (
                    0.0
                    if self.reverse(0.0, t, s, direction) >= 0
                    else brentq(self.reverse, 0.0, xi, args=(t, s, direction), xtol=1e-13)
                )
                e, xi = direction * new, new
            before = s
            alpha = self.alpha_A + xi * (self.alpha_M - self.alpha_A)
            strain.append(s * (1 / self.E_A + xi * self.dS) + e + alpha * (t - 22.0))
        return np.array(strain)

    def isobaric(self, stress, n=100):
        """Temperature, stress, strain: heated and cooled over the whole loop under constant stress."""
        low = brentq(lambda T: self.forward(1.0, T, stress), -300.0, 600.0) - 25.0
        high = brentq(lambda T: self.reverse(0.0, T, stress, self.H(stress)), -300.0, 600.0) + 25.0
        T = np.concatenate([np.linspace(low, high, n), np.linspace(high, low, n)[1:]])
        s = np.full(T.size, float(stress))
        return T, s, self.follow(T, s, martensite=True)

    def isothermal(self, T, most=None, n=100):
        """Temperature, stress, strain: loaded and unloaded at constant temperature above A_f."""
        most = most or 1.1 * brentq(lambda s: self.forward(1.0, T, s), 1.0, 5000.0) + 50
        s = np.concatenate([np.linspace(0, most, n), np.linspace(most, 0, n)[1:]])
        at = np.full(s.size, float(T))
        return at, s, self.follow(at, s, martensite=False)


def random_wire(rng):
    """A wire somewhere in the range of NiTi, whose boundaries do not cross at any stress of its loops."""
    A_s, C_M = rng.uniform(40, 90), rng.uniform(6, 11)
    M_s = A_s - rng.uniform(2, 12)
    return Wire(
        E_A=rng.uniform(50e3, 90e3),
        E_M=rng.uniform(20e3, 40e3),
        H_min=rng.uniform(0.004, 0.015),
        H_sat=rng.uniform(0.03, 0.06),
        k=rng.uniform(0.006, 0.02),
        A_s=A_s,
        A_f=A_s + rng.uniform(8, 25),
        M_s=M_s,
        M_f=M_s - rng.uniform(10, 25),
        C_A=C_M * rng.uniform(0.75, 1.05),
        C_M=C_M,
        n=tuple(rng.uniform(0.25, 0.8, 4)),
        alpha_A=rng.uniform(9e-6, 14e-6),
        alpha_M=rng.uniform(5e-6, 9e-6),
    )


def with_slopes_at(wire, stress):
    """The wire whose C_A and C_M are the slopes at another stress; its constants are the same."""
    step = 1e-4
    moment = ((stress + step) * wire.H(stress + step) - (stress - step) * wire.H(stress - step)) / (2 * step)
    cooling = -wire.rds / ((1 - wire.D) * moment + wire.dS * stress)
    heating = -wire.rds / ((1 + wire.D) * moment + wire.dS * stress)
    return replace(wire, C_M=cooling, C_A=heating, at_stress=stress)


def noise(rng, n, white=3e-5, drift=3e-5, correlation=0.95):
    """Noise of a strain: white, and a drift that forgets itself over some twenty readings."""
    found = np.empty(n)
    now = rng.normal() * drift
    for k in range(n):
        now = correlation * now + np.sqrt(1 - correlation**2) * drift * rng.normal()
        found[k] = now
    return found + white * rng.normal(size=n)

"""Brinson's equations (1993) as printed, and the constants of her table 1: a reference that shares no code.

A branch keeps the fractions at its start and evaluates the printed equations at its furthest point.
"""

from math import cos, pi
from types import SimpleNamespace

# Nitinol of Dye (1990) and Liang (1990), as in Brinson (1993), table 1; the rest is zero or of no importance here
TABLE_1 = {
    "austenite_MPa": 67e3,
    "martensite_MPa": 26.3e3,
    "residual_strain": 0.067,
    "martensite_finish_degC": 9.0,
    "martensite_start_degC": 18.4,
    "austenite_start_degC": 34.5,
    "austenite_finish_degC": 49.0,
    "martensite_slope": 8.0,
    "austenite_slope": 13.8,
    "stress_start_MPa": 100.0,
    "stress_finish_MPa": 170.0,
    "austenite_expansion": 0.0,
    "martensite_expansion": 0.0,
    "reference_degC": 20.0,
    "austenite_ohm_m": 1e-6,
    "martensite_ohm_m": 1e-6,
    "austenite_ohm_slope": 0.0,
    "martensite_ohm_slope": 0.0,
    "density": 6450.0,
    "specific_heat": 837.0,
    "latent_J_per_kg": 24000.0,
}


def constants(**changes):
    """The constants with short names."""
    c = TABLE_1 | changes
    short = {
        "EA": "austenite_MPa", "EM": "martensite_MPa", "eL": "residual_strain", "Mf": "martensite_finish_degC",
        "Ms": "martensite_start_degC", "As": "austenite_start_degC", "Af": "austenite_finish_degC",
        "CM": "martensite_slope", "CA": "austenite_slope", "ss": "stress_start_MPa", "sf": "stress_finish_MPa",
        "aA": "austenite_expansion", "aM": "martensite_expansion", "T0": "reference_degC",
    }  # fmt: skip
    return SimpleNamespace(**{k: c[v] for k, v in short.items()})


def strain(c, sigma, T, xi, xi_S):
    expansion = c.aA + xi * (c.aM - c.aA)
    return sigma / (c.EA + xi * (c.EM - c.EA)) + c.eL * xi_S + expansion * (T - c.T0)


def to_detwinned(c, sigma, T, xi_S0):
    """ξ_S of conversion to detwinned martensite, eqs. 18 and 19."""
    s = min(max(sigma - c.CM * max(T - c.Ms, 0.0), c.ss), c.sf)
    return (1 - xi_S0) / 2 * cos(pi / (c.ss - c.sf) * (s - c.sf)) + (1 + xi_S0) / 2


def to_austenite(c, sigma, T, xi0):
    """ξ of conversion to austenite, eq. 20."""
    z = min(max(T - sigma / c.CA, c.As), c.Af)
    return xi0 / 2 * (cos(pi / (c.Af - c.As) * (z - c.As)) + 1)


def cooled(c, T, austenite):
    """Austenite that cooling between M_s and M_f leaves."""
    return austenite * (1 - (cos(pi / (c.Ms - c.Mf) * (min(max(T, c.Mf), c.Ms) - c.Mf)) + 1) / 2)


class Branches:
    """The fractions along a path, from the start of the present branch and its furthest point."""

    def __init__(self, xi_S=0.0, xi_T=0.0):
        self.xi_S, self.xi_T = xi_S, xi_T
        self.kind, self.start = "", (xi_S, xi_T)
        self.z = self.s = self.T = None

    def peek(self, c, sigma, T):
        """(ξ_S, ξ_T, kind, start, furthest values) after a monotone step."""
        z, s = T - sigma / c.CA, sigma - c.CM * max(T - c.Ms, 0.0)
        furthest = (-1e9, -1e9, 1e9) if not self.kind else (self.z, self.s, self.T)
        if z > c.As and z > (furthest[0] if self.kind == "A" else c.As):
            start = self.start if self.kind == "A" else (self.xi_S, self.xi_T)
            xi0 = sum(start)
            xi = to_austenite(c, sigma, T, xi0)
            share = xi / xi0 if xi0 else 0.0
            return start[0] * share, start[1] * share, "A", start, (z, -1e9, 1e9)
        same = self.kind == "M"
        start = self.start if same else (self.xi_S, self.xi_T)
        s_most = max(s, furthest[1] if same else -1e9)
        T_least = min(T, furthest[2] if same else 1e9)
        if s_most <= c.ss and T_least >= c.Ms:
            return self.xi_S, self.xi_T, self.kind, self.start, (self.z, self.s, self.T)
        xi_S = to_detwinned(c, s_most, c.Ms, start[0])
        left = (1 - xi_S) / (1 - start[0]) if start[0] < 1 else 0.0
        austenite = cooled(c, T_least, (1 - sum(start)) * left)
        return xi_S, 1 - xi_S - austenite, "M", start, (-1e9, s_most, T_least)

    def go(self, c, sigma, T):
        self.xi_S, self.xi_T, self.kind, self.start, (self.z, self.s, self.T) = self.peek(c, sigma, T)
        return self

"""Heat loss of a horizontal wire in still air: free convection after Churchill and Chu (1975).

    Nu = {0.60 + 0.387 Ra^(1/6) / [1 + (0.559/Pr)^(9/16)]^(8/27)}²,   h = Nu k/d

S. W. Churchill and H. H. S. Chu, Int. J. Heat Mass Transfer 18 (1975) 1049-1053. Air at the film temperature: ideal gas
at 101325 Pa, c_p = 1007 J/(kg K), viscosity and conductivity by Sutherland's law with the constants of F. M. White,
Viscous Fluid Flow, 3rd ed. (2006), tables 1-2 and 1-3.
"""

from typing import NamedTuple

ZERO_K = 273.15
GRAVITY = 9.80665
PRESSURE_PA, GAS_CONSTANT, SPECIFIC_HEAT = 101325.0, 287.05, 1007.0
_LEAST_DIFFERENCE_K = 1e-3  # below it Ra is zero and its root has no slope


class Air(NamedTuple):
    """Density, viscosity and conductivity of air, in SI units."""

    density: float
    viscosity: float
    conductivity: float


def air(temperature_degC: float) -> Air:
    """Dry air at atmospheric pressure.

    >>> [float(f"{v:.3g}") for v in air(26.85)]     # 300 K: 1.16 kg/m³, 18.5e-6 Pa s, 26.3e-3 W/(m K) in tables
    [1.18, 1.85e-05, 0.0262]
    """
    kelvin = temperature_degC + ZERO_K
    scale = (kelvin / ZERO_K) ** 1.5
    return Air(
        PRESSURE_PA / (GAS_CONSTANT * kelvin),
        1.716e-5 * scale * (ZERO_K + 110.4) / (kelvin + 110.4),
        0.0241 * scale * (ZERO_K + 194.0) / (kelvin + 194.0),
    )


def free_convection_W_per_m2_K(diameter_m: float, wire_degC: float, ambient_degC: float) -> float:
    """The heat transfer coefficient h of a horizontal cylinder.

    >>> round(free_convection_W_per_m2_K(0.3e-3, 196.1, 22.0), 1)
    74.7
    """
    difference_K = max(abs(wire_degC - ambient_degC), _LEAST_DIFFERENCE_K)
    film_degC = 0.5 * (wire_degC + ambient_degC)
    gas = air(film_degC)
    prandtl = gas.viscosity * SPECIFIC_HEAT / gas.conductivity
    rayleigh = (
        GRAVITY * difference_K * diameter_m**3 * gas.density**2 * SPECIFIC_HEAT
        / ((film_degC + ZERO_K) * gas.viscosity * gas.conductivity)
    )  # fmt: skip
    root = 0.60 + 0.387 * rayleigh ** (1 / 6) / (1.0 + (0.559 / prandtl) ** (9 / 16)) ** (8 / 27)
    return root * root * gas.conductivity / diameter_m

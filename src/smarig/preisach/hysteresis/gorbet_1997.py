"""The six identified surfaces of Table 5.1 (Gorbet 1997), by name: one_c … two_e.

Printed parameters are rounded (x₅ = −0.0010 has two digits), so errors recomputed from them differ in the third digit.
One-wire outputs are in mm and two-wire outputs in degrees; inputs are in kelvin above ambient.
"""

from smarig.core import UsageError, suggestion
from smarig.preisach.hysteresis.fod_surface import FodSurface

_ONE = {"lower": 0.0, "upper": 174.1, "y_lower": 0.0, "y_upper": 12.54, "unit": "mm"}
_TWO = {"lower": -185.0, "upper": 185.0, "y_lower": -16.5234, "y_upper": 18.1055, "unit": "deg"}

_TABLE_5_1: dict[str, tuple[str, tuple[float, ...], dict]] = {
    "one_c": ("constant", (0.0483, -47.2120, 0.1041, -23.7060), _ONE),
    "one_p": ("parabolic", (0.0439, -44.1660, 0.0996, -0.0010, 0.2392, -36.3101), _ONE),
    "one_e": ("exponential", (0.0394, -43.0003, 0.1034, 269.6849, 0.0765, -23.6099), _ONE),
    "two_c": ("constant", (0.0255, -16.7731, 0.0330, 38.4726), _TWO),
    "two_p": ("parabolic", (0.0297, -25.0694, 0.0344, 0.0017, -0.4900, 68.6903), _TWO),
    "two_e": ("exponential", (0.0293, -24.2772, 0.0343, 27.2773, 0.0207, 36.0267), _TWO),
}
THESIS_SURFACES = tuple(_TABLE_5_1)

# §5.4.1: the partitions of the identification inputs, in kelvin above ambient.
THESIS_PARTITIONS: dict[str, tuple[float, ...]] = {
    "one_wire": (0.0, 1.7, 7.0, 15.7, 27.8, 43.5, 62.7, 85.3, 111.4, 141.0, 174.1),
    "two_wire": (-185.0, -145.0, -105.0, -75.0, -45.0, -15.0, 15.0, 45.0, 75.0, 105.0, 145.0, 185.0),
}


def thesis_surface(name: str) -> FodSurface:
    """A surface of Table 5.1.

    >>> thesis_surface("one_c").x[1]
    -47.212
    """
    if name not in _TABLE_5_1:
        raise UsageError(f"No surface '{name}'{suggestion(name, list(THESIS_SURFACES))}.")
    form, x, ends = _TABLE_5_1[name]
    return FodSurface(form, x, **ends)

"""The strips of transformation of a thermomechanical twin that follows the identified material at one stress.

The twin has Brinson's cosines. At this stress, each is a quarter and three quarters through where the law is:

    ½ (1 − cos πx) = ¼ and ¾ at x = ⅓ and ⅔,   so   width = 3 |T(¾) − T(¼)|

Slopes are those of the phase boundaries there. The twin cannot transform in both directions at one temperature. Where
the strips of the law overlap, those of the twin get one slope; where they still do, they are narrowed about their
middles.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from smarig.core import Array
from smarig.identification.material.law import (
    MaterialLaw,
    cooled_fraction,
    cooling_start,
    heated_fraction,
    heating_finish,
)

Fraction = Callable[[MaterialLaw, Array, Array], Array]
Boundary = Callable[[MaterialLaw, Array], Array]
GAP_K = 0.5  # between strips that were narrowed
LEAST_STRESS_MPA = 1.0  # σ_s: the twin's wire is trained


@dataclass(frozen=True)
class TwinStrips:
    """Middles and widths of both strips in K at a stress, their slopes, and how they were changed, in words."""

    stress_MPa: float
    cooling_middle: float
    cooling_width: float
    heating_middle: float
    heating_width: float
    C_M: float
    C_A: float
    changed: str = ""


def twin_strips(law: MaterialLaw, stress: float) -> TwinStrips:
    """The cosines with the quarters of the law, and the slopes of its boundaries."""
    cooled = _quarters(law, stress, cooled_fraction)
    heated = _quarters(law, stress, heated_fraction)
    C_M, C_A = (_slope(boundary, law, stress) for boundary in (cooling_start, heating_finish))
    return TwinStrips(
        stress,
        sum(cooled) / 2,
        3 * (cooled[0] - cooled[1]),
        sum(heated) / 2,
        3 * (heated[0] - heated[1]),
        C_M,
        C_A,
    )


def as_they_are(strips: TwinStrips) -> TwinStrips:
    """Unchanged."""
    return strips


def parallel(strips: TwinStrips) -> TwinStrips:
    """With one slope, the harmonic mean."""
    slope = 2 * strips.C_M * strips.C_A / (strips.C_M + strips.C_A)
    return replace(strips, C_M=slope, C_A=slope, changed="its strips are parallel")


def narrowed(strips: TwinStrips) -> TwinStrips | None:
    """Strips that touch at no temperature; None if the middles are in the wrong order."""
    free = strips.heating_middle - strips.cooling_middle - GAP_K
    if free <= GAP_K:
        return None
    share = min(1.0, 2 * free / (strips.cooling_width + strips.heating_width))
    return replace(
        parallel(strips),
        cooling_width=share * strips.cooling_width,
        heating_width=share * strips.heating_width,
        changed=f"its strips are parallel and {100 * (1 - share):.0f} % narrower, as they must not overlap",
    )


def strip_values(strips: TwinStrips) -> dict[str, tuple[float, str]]:
    """Values and units by the keys of an actuator file."""
    stress = strips.stress_MPa
    M_s = strips.cooling_middle + strips.cooling_width / 2 - (stress - LEAST_STRESS_MPA) / strips.C_M
    A_s = strips.heating_middle - strips.heating_width / 2 - stress / strips.C_A
    finish = min(LEAST_STRESS_MPA + strips.C_M * strips.cooling_width, max(stress, 2 * LEAST_STRESS_MPA))
    return {
        "martensite_start": (M_s, "degC"),
        "martensite_finish": (M_s - strips.cooling_width, "degC"),
        "austenite_start": (A_s, "degC"),
        "austenite_finish": (A_s + strips.heating_width, "degC"),
        "slope_martensite": (strips.C_M, "MPa/K"),
        "slope_austenite": (strips.C_A, "MPa/K"),
        "critical_stress_start": (LEAST_STRESS_MPA, "MPa"),
        "critical_stress_finish": (finish, "MPa"),
    }


def _quarters(law: MaterialLaw, stress: float, fraction: Fraction) -> tuple[float, float]:
    """Where the fraction of martensite is a quarter, and three quarters."""
    at = np.array([stress])
    middle = 0.5 * float(cooling_start(law, at)[0] + heating_finish(law, at)[0])

    def beyond(T: float, share: float) -> float:
        return float(fraction(law, np.array([T]), at)[0]) - share

    quarter, three = (brentq(beyond, middle - 1000, middle + 1000, args=(share,)) for share in (0.25, 0.75))
    return float(quarter), float(three)


def _slope(boundary: Boundary, law: MaterialLaw, stress: float) -> float:
    """dσ/dT of a phase boundary at a stress."""
    ends = boundary(law, np.array([stress - 1.0, stress + 1.0]))
    return 2.0 / float(ends[1] - ends[0])

"""Characteristics of the alloy alone: stress over strain at one temperature, strain over temperature at one stress.

The thesis measures its actuator only (5.1.2); these are the curves of a tensile test and of a wire under dead weight.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import UsageError
from smarig.plant.thermomechanical.kinetics import AUSTENITE, TWINNED_MARTENSITE, Phase, transformed
from smarig.plant.thermomechanical.material import Material
from smarig.plant.thermomechanical.monotone_root import increasing_root

SAFETY, TOLERANCE_MPA = 0.9, 1e-9


def isothermal_loop(
    material: Material, temperature_degC: float, strains: ArrayLike, start: Phase | None = None
) -> NDArray[np.float64]:
    """Stress (n,) in MPa at each strain (n,) of a slow tensile test at constant temperature.

    Strain is monotone between two values. ``start``: the phase without stress; None: austenite from M_s on, below it
    twinned martensite. Strain counts from the martensite at the reference temperature. A wire that is longer than the
    strain is slack: its stress is 0.
    """
    cold = temperature_degC < material.martensite_start_degC
    phase = start or (TWINNED_MARTENSITE if cold else AUSTENITE)
    phase = transformed(material, phase, temperature_degC, 0.0)
    stiffest_MPa = max(material.austenite_MPa, material.martensite_MPa)
    stress_MPa, found = 0.0, []
    for strain in _numbers(strains, "strains"):

        def excess(sigma: float, phase: Phase = phase, strain: float = strain) -> tuple[float, Phase]:
            end = transformed(material, phase, temperature_degC, sigma)
            reached = material.strain(sigma, temperature_degC, end.martensite, end.detwinned)
            return reached - strain, end

        now = excess(stress_MPa)
        slack = now[0] > 0.0 and stress_MPa == 0.0
        end = 0.0 if now[0] * stiffest_MPa / SAFETY > stress_MPa else None
        if not slack:
            stress_MPa, phase = increasing_root(
                excess, stress_MPa, now, SAFETY / stiffest_MPa, end=end, tolerance=TOLERANCE_MPA
            )
        found.append(stress_MPa)
    return np.array(found)


def isobaric_loop(
    material: Material, stress_MPa: float, temperatures_degC: ArrayLike, start: Phase | None = None
) -> NDArray[np.float64]:
    """Strain (n,) at each temperature (n,) of a wire under constant stress, loaded at the first temperature.

    Temperature is monotone between two values; ``start`` as in ``isothermal_loop``.
    """
    temperatures = list(_numbers(temperatures_degC, "temperatures"))
    if stress_MPa < 0:
        raise UsageError(f"The stress {stress_MPa:g} MPa is negative. A wire only pulls: give 0 or more.")
    found, phase = [], start
    for temperature_degC in temperatures:
        if phase is None:
            cold = temperature_degC < material.martensite_start_degC
            phase = TWINNED_MARTENSITE if cold else AUSTENITE
        phase = transformed(material, phase, temperature_degC, stress_MPa)
        found.append(material.strain(stress_MPa, temperature_degC, phase.martensite, phase.detwinned))
    return np.array(found)


def _numbers(values: ArrayLike, what: str) -> Iterable[float]:
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or not np.all(np.isfinite(array)):
        raise UsageError(f"The {what} must be a list of finite numbers.")
    return array.tolist()

"""Characteristics of the alloy alone: stress over strain at one temperature, strain over temperature at one stress, and
two wires against each other at given temperatures.

The thesis measures its actuator only (5.1.2); these are the curves of a tensile test, of a wire under dead weight, and
of both wires of the differential actuator without their heating.
"""

import math
from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.plant.thermomechanical.kinetics import AUSTENITE, TWINNED_MARTENSITE, Phase, transformed
from smarig.plant.thermomechanical.material import Material
from smarig.plant.thermomechanical.monotone_root import increasing_root
from smarig.plant.thermomechanical.shaft import extra_stresses_MPa

SAFETY, TOLERANCE_MPA = 0.9, 1e-9


def isothermal_loop(
    material: Material, temperature_degC: float, strains: ArrayLike, start: Phase | None = None
) -> Array:
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
) -> Array:
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


def antagonist_path(
    material: Material, pre_strain: float, temperatures_degC: ArrayLike, load_MPa: float = 0.0
) -> tuple[Array, Array]:
    """Smaller stress (n,) in MPa of two equal wires, and their strains (n, 2), at each pair of temperatures (n, 2).

        σ₁ − σ₂ = load,      ε₁(σ₁) + ε₂(σ₂) = 2 ε_p

    Both start as twinned martensite, stretched by the pre-strain at the first pair. Temperatures are monotone between
    two pairs. ``load_MPa``: the torque on the shaft over A r, which wire 1 carries (wire 2, if negative). The less
    loaded wire is slack (σ = 0) where both are longer than that; without a load both are.
    """
    pairs = np.asarray(temperatures_degC, dtype=float)
    if pairs.ndim != 2 or pairs.shape[1:] != (2,) or not np.all(np.isfinite(pairs)):
        raise UsageError("The temperatures must be pairs of finite numbers, one of each wire.")
    if not math.isfinite(load_MPa):
        raise UsageError(f"The load must be a finite number of MPa, not {load_MPa}.")
    phases, stress_MPa, extra_MPa = (
        (TWINNED_MARTENSITE, TWINNED_MARTENSITE),
        0.0,
        extra_stresses_MPa(load_MPa),
    )
    least_slope = 2.0 * SAFETY / max(material.austenite_MPa, material.martensite_MPa)
    stresses, strains = [], []
    for pair in pairs.tolist():
        evaluate = partial(_excess, material, pair, phases, 2.0 * pre_strain, extra_MPa)
        now = evaluate(stress_MPa)
        if now[0] > 0.0 and now[0] / least_slope >= stress_MPa > 0.0:
            at_zero = evaluate(0.0)
            stress_MPa, now = (0.0, at_zero) if at_zero[0] > 0.0 else (stress_MPa, now)
        if now[0] <= 0.0 or stress_MPa > 0.0:
            stress_MPa, (phases, reached) = increasing_root(
                evaluate, stress_MPa, now, least_slope, tolerance=TOLERANCE_MPA
            )
        else:
            phases, reached = now[1]
        stresses.append(stress_MPa)
        strains.append(reached)
    return np.array(stresses), np.array(strains)


_Pair = tuple[tuple[Phase, Phase], tuple[float, float]]


def _excess(
    material: Material,
    temperatures_degC: Sequence[float],
    phases: tuple[Phase, Phase],
    total_strain: float,
    extra_MPa: tuple[float, float],
    stress_MPa: float,
) -> tuple[float, _Pair]:
    """By how much both strains exceed their sum at a smaller stress, with the phases and strains there."""
    stresses = [stress_MPa + extra for extra in extra_MPa]
    ends = [transformed(material, p, T, s) for p, T, s in zip(phases, temperatures_degC, stresses)]
    first, second = (
        material.strain(s, T, end.martensite, end.detwinned)
        for end, T, s in zip(ends, temperatures_degC, stresses)
    )
    return first + second - total_strain, ((ends[0], ends[1]), (first, second))


def _numbers(values: ArrayLike, what: str) -> Iterable[float]:
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or not np.all(np.isfinite(array)):
        raise UsageError(f"The {what} must be a list of finite numbers.")
    return array.tolist()

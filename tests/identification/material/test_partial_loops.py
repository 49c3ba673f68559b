"""Partial transformation: branches that begin inside the loop scale what is left."""

import numpy as np
import pytest

from smarig.identification import MaterialLaw, cooled_fraction, heated_fraction, transformation_strain
from smarig.identification.material.material_path import MaterialBranch, strain_along

LAW = MaterialLaw(
    modulus_austenite=70e3, modulus_martensite=70e3, strain_least=0.02, strain_saturated=0.05, strain_rate=0.01,
    strain_stress=0.0, austenite_start=60.0, austenite_finish=80.0, martensite_start=50.0, martensite_finish=30.0,
    slope_austenite=8.0, slope_martensite=7.0, exponent_cooling_start=0.4, exponent_cooling_finish=0.5,
    exponent_heating_finish=0.3, exponent_heating_start=0.6, expansion_austenite=0.0, expansion_martensite=0.0,
    reference_stress=100.0,
)  # fmt: skip
STRESS = np.array([100.0])


def fractions(temperatures, branches):
    """ξ (n,) from the strain, of which nothing else changes."""
    strain = strain_along(LAW, np.array(temperatures), STRESS, branches)
    return (strain - 100.0 / 70e3) / float(transformation_strain(LAW, 100.0))


def middle_of(fraction):
    at = np.linspace(20.0, 150.0, 20001)
    return float(np.interp(-0.5, -fraction(LAW, at, STRESS), at))


def test_a_loop_that_turns_half_way():
    """Heated to the middle, cooled: the austenite, one half, scales with the share that cooling leaves."""
    turn, cold = middle_of(heated_fraction), middle_of(cooled_fraction)
    xi = fractions([10.0, turn, cold, 10.0], [MaterialBranch(0, 2, False), MaterialBranch(2, 4, True)])
    assert xi == pytest.approx([1.0, 0.5, 0.75, 1.0], abs=1e-3)


def test_a_second_partial_heating_scales_the_martensite_that_is_there():
    turn, cold = middle_of(heated_fraction), middle_of(cooled_fraction)
    branches = [MaterialBranch(0, 2, False), MaterialBranch(2, 3, True), MaterialBranch(3, 5, False)]
    xi = fractions([10.0, turn, cold, turn, 150.0], branches)
    assert xi == pytest.approx([1.0, 0.5, 0.75, 0.375, 0.0], abs=1e-3)


def test_a_branch_does_not_depend_on_its_readings():
    few = fractions([10.0, 85.0, 10.0], [MaterialBranch(0, 2, False), MaterialBranch(2, 3, True)])
    heating, cooling = np.linspace(10, 85, 50), np.linspace(85, 10, 60)[1:]
    many = fractions([*heating, *cooling], [MaterialBranch(0, 50, False), MaterialBranch(50, 109, True)])
    assert many[[0, 49, -1]] == pytest.approx(few, abs=1e-9)

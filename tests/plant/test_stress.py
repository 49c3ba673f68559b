"""Stress in the differential actuator (§5.5.1): nearly constant, which is why one input is enough."""

import pytest
from scipy.optimize import brentq

from smarig.plant.stress import StressStrain, differential_stress


def martensite(strain: float) -> float:
    return 16800 * strain if strain <= 0.0136 else 16800 * 0.0136 + 826 * (strain - 0.0136)


def test_figures_of_the_thesis():
    s = differential_stress()
    assert s.cold_MPa == pytest.approx(242, abs=0.5)
    assert 100 * s.heated_strain == pytest.approx(0.726, abs=0.0005)
    assert 100 * s.relative_change == pytest.approx(7.76, abs=0.005)
    assert 100 * (s.hot_MPa - 242) / 242 == pytest.approx(7.77, abs=0.005)  # as printed, σ₀ rounded


def test_both_wires_share_one_stress_and_their_strains_add_up():
    """Cold: two martensite wires; hot: austenite against martensite; found by a root finder instead."""
    s = differential_stress()
    assert s.cold_MPa == pytest.approx(martensite(0.03))
    balance = brentq(lambda e: 35917 * e - martensite(0.06 - e), 0, 0.03, xtol=1e-15)
    assert s.heated_strain == pytest.approx(balance, rel=1e-9)
    assert s.hot_MPa == pytest.approx(martensite(0.06 - balance), rel=1e-9)


def test_a_flat_plateau_gives_constant_stress():
    s = differential_stress(StressStrain(plateau_MPa=0.0))
    assert s.relative_change == pytest.approx(0.0, abs=1e-15)

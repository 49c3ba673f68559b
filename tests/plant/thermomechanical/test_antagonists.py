"""Two wires on one shaft: stress and angle against a root finder on the printed equations."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from plant.thermomechanical.brinson import TABLE_1, Branches, constants, strain
from smarig.core import UsageError
from smarig.plant import Actuator, Material, ThermomechanicalPlant, antagonist_path, differential_stress

NAME = "thermomechanical_two_wire"
C = constants(**{k: getattr(Material.of(Actuator.named(NAME).file), k) for k in TABLE_1})
TOTAL, LENGTH_MM, RADIUS_MM = 0.06, 150.0, 3.0


def excess(sigma, wires, temperatures):
    found = [w.peek(C, sigma, T)[:2] for w, T in zip(wires, temperatures, strict=True)]
    return sum(
        strain(C, sigma, T, sum(xi), xi[0]) for xi, T in zip(found, temperatures, strict=True)
    ) - TOTAL  # fmt: skip


def solved(wires, temperatures):
    """The stress at which both wires fit; both wires are moved there."""
    if excess(0.0, wires, temperatures) >= 0.0:
        sigma = 0.0
    else:
        sigma = brentq(excess, 0.0, 3000.0, args=(wires, temperatures), xtol=1e-11, rtol=1e-14)
    for wire, T in zip(wires, temperatures, strict=True):
        wire.go(C, sigma, T)
    return sigma


@pytest.mark.parametrize("seed", range(4))
def test_stress_and_angle_at_every_tick(seed):
    rng = np.random.default_rng(seed)
    plant = ThermomechanicalPlant(Actuator.named(NAME), 0.1, 22.0)
    wires = [Branches(0.0, 1.0), Branches(0.0, 1.0)]
    assert solved(wires, [22.0, 22.0]) == pytest.approx(plant.stress_MPa, rel=1e-6)
    stresses = []
    for k in range(900):
        if k % 60 == 0:
            current_A = rng.uniform(-1, 1)
        plant.step(current_A)
        temperatures = [T + 22.0 for T in plant.wire_K]
        sigma = solved(wires, temperatures)
        stresses.append(sigma)
        assert plant.stress_MPa == pytest.approx(sigma, rel=1e-6)
        first, second = (
            strain(C, sigma, T, w.xi_S + w.xi_T, w.xi_S) for w, T in zip(wires, temperatures, strict=True)
        )
        angle = np.degrees(LENGTH_MM * (second - first) / (2 * RADIUS_MM))
        assert plant.position == pytest.approx(angle, abs=1e-4)
    assert max(stresses) - min(stresses) > 50.0


@pytest.mark.parametrize("seed", range(3))
def test_a_path_of_temperatures_against_the_root_finder(seed):
    """Both wires anywhere between cold and hot, also both hot and both cold again, and slack."""
    rng = np.random.default_rng(seed)
    corners = [[22.0, 22.0], *rng.uniform(15.0, 180.0, (8, 2)).tolist(), [22.0, 22.0], [170.0, 22.0]]
    pairs = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(corners)])
    stress_MPa, strains = antagonist_path(Material.of(Actuator.named(NAME).file), 0.03, pairs)
    wires = [Branches(0.0, 1.0), Branches(0.0, 1.0)]
    for pair, sigma, reached in zip(pairs.tolist(), stress_MPa.tolist(), strains.tolist(), strict=True):
        assert sigma == pytest.approx(solved(wires, pair), rel=1e-6, abs=1e-6)
        assert sum(reached) == pytest.approx(TOTAL, abs=1e-9) or sigma == 0.0
        expected = [strain(C, sigma, T, w.xi_S + w.xi_T, w.xi_S) for w, T in zip(wires, pair, strict=True)]
        assert reached == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_a_path_needs_pairs():
    material = Material.of(Actuator.named(NAME).file)
    for wrong in ([22.0, 30.0], [[22.0, np.nan]], [[1.0, 2.0, 3.0]]):
        with pytest.raises(UsageError, match="pairs of finite numbers"):
            antagonist_path(material, 0.03, wrong)


def test_the_thesis_s_force_balance_lies_near():
    """§5.5.1: 242 MPa cold, 261 MPa with one hot wire, on straight lines in place of cosines."""
    thesis = differential_stress()
    plant = ThermomechanicalPlant(Actuator.named(NAME), 0.1, 22.0)
    assert plant.stress_MPa == pytest.approx(thesis.cold_MPa, rel=0.02)
    for _ in range(600):
        plant.step(1.0)
    assert plant.austenite[0] == 1.0
    assert plant.stress_MPa == pytest.approx(thesis.hot_MPa, rel=0.08)
    assert plant.wire_K[1] == pytest.approx(0.0, abs=0.2)
    assert plant.position > 0


def test_the_pair_is_symmetric():
    first, second = (ThermomechanicalPlant(Actuator.named(NAME), 0.1, 22.0) for _ in range(2))
    for k in range(600):
        current_A = 0.9 if k % 200 < 100 else 0.0
        assert first.step(current_A) == pytest.approx(-second.step(-current_A), abs=1e-6)
        assert first.resistance_ohm(1.0) == pytest.approx(second.resistance_ohm(-1.0), rel=1e-9)
    assert abs(first.position) > 10.0

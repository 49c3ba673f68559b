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


SECTION_MM2 = np.pi / 4 * 0.3**2


def both(sigma, load):
    """The stresses of both wires, whose difference carries the load; the smaller one is sigma."""
    return (sigma + load, sigma) if load > 0 else (sigma, sigma - load)


def excess(sigma, wires, temperatures, load=0.0):
    total = -TOTAL
    for wire, s, T in zip(wires, both(sigma, load), temperatures, strict=True):
        xi = wire.peek(C, s, T)[:2]
        total += strain(C, s, T, sum(xi), xi[0])
    return total


def solved(wires, temperatures, load=0.0):
    """The smaller stress, at which both wires fit; both wires are moved there."""
    if excess(0.0, wires, temperatures, load) >= 0.0:
        sigma = 0.0
    else:
        sigma = brentq(excess, 0.0, 3000.0, args=(wires, temperatures, load), xtol=1e-11, rtol=1e-14)
    for wire, s, T in zip(wires, both(sigma, load), temperatures, strict=True):
        wire.go(C, s, T)
    return sigma


def with_torque(load):
    """The actuator whose shaft carries a torque that needs this difference of stresses."""
    file = Actuator.named(NAME).file
    values = file.model_dump(mode="json")
    values["thermomechanical"]["shaft_torque"] = {
        "value": load * SECTION_MM2 * RADIUS_MM, "unit": "N mm", "source": "a test"
    }  # fmt: skip
    return Actuator(type(file).model_validate(values))


@pytest.mark.parametrize(("seed", "load"), [(0, 0.0), (1, 0.0), (2, 60.0), (3, -150.0)])
def test_stress_and_angle_at_every_tick(seed, load):
    rng = np.random.default_rng(seed)
    plant = ThermomechanicalPlant(with_torque(load) if load else Actuator.named(NAME), 0.1, 22.0)
    wires = [Branches(0.0, 1.0), Branches(0.0, 1.0)]
    smaller = solved(wires, [22.0, 22.0], load)
    assert both(smaller, load)[0] == pytest.approx(plant.stress_MPa, rel=1e-6)
    stresses = []
    for k in range(900):
        if k % 60 == 0:
            current_A = rng.uniform(-1, 1)
        plant.step(current_A)
        temperatures = [T + 22.0 for T in plant.wire_K]
        each = both(solved(wires, temperatures, load), load)
        stresses.append(each[0])
        assert [w.state.stress_MPa for w in plant.mechanism.wires] == pytest.approx(each, rel=1e-6)
        first, second = (
            strain(C, s, T, w.xi_S + w.xi_T, w.xi_S)
            for w, s, T in zip(wires, each, temperatures, strict=True)
        )
        angle = np.degrees(LENGTH_MM * (second - first) / (2 * RADIUS_MM))
        assert plant.position == pytest.approx(angle, abs=1e-4)
    assert max(stresses) - min(stresses) > 40.0


def test_a_loaded_shaft_whose_other_wire_is_slack_hangs_on_one_wire():
    """M/(A r) = 290 MPa on a cold pair: wire 1 alone carries it, and the angle is that of a single wire."""
    plant = ThermomechanicalPlant(with_torque(290.0), 0.1, 22.0)
    first, second = (wire.state for wire in plant.mechanism.wires)
    assert second.stress_MPa == 0.0
    wire = Branches(0.0, 1.0)
    wire.go(C, 290.0, 22.0)
    alone = strain(C, 290.0, 22.0, wire.xi_S + wire.xi_T, wire.xi_S)
    assert first.strain == pytest.approx(alone, rel=1e-9)
    assert plant.position == pytest.approx(np.degrees(LENGTH_MM * (0.03 - alone) / RADIUS_MM), rel=1e-9)


def test_the_work_of_the_torque_balances():
    """Electrical energy and work of both wires' loads are stored or lost; the work of both is that on the shaft."""
    plant = ThermomechanicalPlant(with_torque(100.0), 0.1, 22.0)
    for current_A in (1.0, 0.0, -1.0, 0.5):
        for _ in range(300):
            plant.step(current_A)
    assert max(abs(e.imbalance_J) / e.electrical_J for e in plant.energy) < 1e-6
    torque_Nm = 100.0 * SECTION_MM2 * RADIUS_MM / 1000
    start = ThermomechanicalPlant(with_torque(100.0), 0.1, 22.0).position
    lifted_J = torque_Nm * np.radians(plant.position - start)
    assert sum(e.work_J for e in plant.energy) == pytest.approx(-lifted_J, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (
            {"value": 1e4, "unit": "N mm", "source": "s"},
            "shaft_torque stresses a wire by .* MPa; at most 1000 MPa",
        ),
        ({"value": 1.0, "unit": "N m", "source": "s"}, "expected 'N mm'"),
    ],
)
def test_a_torque_that_no_wire_bears_is_refused(values, says):
    file = Actuator.named(NAME).file
    tables = file.model_dump(mode="json")
    tables["thermomechanical"]["shaft_torque"] = values
    with pytest.raises(ValueError, match=says):
        type(file).model_validate(tables)


@pytest.mark.parametrize(
    ("table", "key", "value", "says"),
    [
        ("thermomechanical", "force", 1e5, "force stresses a wire by .* MPa; at most 1000 MPa"),
        (
            "thermomechanical",
            "resistivity_austenite",
            1e-4,
            "give .* ohm, but heating.resistance_austenite is 4.5",
        ),
        ("wire", "active_length", 1e5, "time constant|heating.resistance_martensite is 5 ohm"),
        ("transmission", "radius", 1e5, "must lie between 0.01 and 1000"),
    ],
)
def test_values_that_no_wire_has_are_refused(table, key, value, says):
    file = Actuator.named("thermomechanical_one_wire").file
    tables = file.model_dump(mode="json")
    tables[table][key]["value"] = value
    with pytest.raises(ValueError, match=says):
        type(file).model_validate(tables)


def test_one_wire_has_no_shaft_torque():
    file = Actuator.named("thermomechanical_one_wire").file
    tables = file.model_dump(mode="json")
    tables["thermomechanical"]["shaft_torque"] = {"value": 1.0, "unit": "N mm", "source": "s"}
    with pytest.raises(ValueError, match="one wire has no thermomechanical.shaft_torque"):
        type(file).model_validate(tables)


@pytest.mark.parametrize(("seed", "load"), [(0, 0.0), (1, 120.0), (2, -60.0)])
def test_a_path_of_temperatures_against_the_root_finder(seed, load):
    """Both wires anywhere between cold and hot, also both hot and both cold again, and slack."""
    rng = np.random.default_rng(seed)
    corners = [[22.0, 22.0], *rng.uniform(15.0, 180.0, (8, 2)).tolist(), [22.0, 22.0], [170.0, 22.0]]
    pairs = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(corners)])
    stress_MPa, strains = antagonist_path(Material.of(Actuator.named(NAME).file), 0.03, pairs, load)
    wires = [Branches(0.0, 1.0), Branches(0.0, 1.0)]
    for pair, sigma, reached in zip(pairs.tolist(), stress_MPa.tolist(), strains.tolist(), strict=True):
        assert sigma == pytest.approx(solved(wires, pair, load), rel=1e-6, abs=1e-6)
        assert sum(reached) == pytest.approx(TOTAL, abs=1e-9) or sigma == 0.0
        each = zip(wires, both(sigma, load), pair, strict=True)
        expected = [strain(C, s, T, w.xi_S + w.xi_T, w.xi_S) for w, s, T in each]
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

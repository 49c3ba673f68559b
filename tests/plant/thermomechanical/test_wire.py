"""One wire: the balance of energy recomputed from what can be seen, a stiff solver, and air from tables."""

import math
import os

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from plant.thermomechanical.brinson import TABLE_1, Branches, constants, strain
from smarig.plant import Actuator, Material, ThermomechanicalPlant
from smarig.plant.thermomechanical.free_convection import air, free_convection_W_per_m2_K

RUNS = 100 if os.environ.get("SMARIG_LONG") else 30
AMBIENT, DT = 22.0, 0.1
RIGS = ("thermomechanical_one_wire", "thermomechanical_two_wire", "flexinol_015", "flexinol_031")


def churchill_chu(d, T_wire, T_air):
    """h, written anew; properties of air from Sutherland's law."""
    film = 273.15 + (T_wire + T_air) / 2
    mu = 1.716e-5 * (film / 273.15) ** 1.5 * 383.55 / (film + 110.4)
    k = 0.0241 * (film / 273.15) ** 1.5 * 467.15 / (film + 194.0)
    rho, cp = 101325 / (287.05 * film), 1007.0
    nu, alpha = mu / rho, k / (rho * cp)
    Ra = 9.80665 / film * abs(T_wire - T_air) * d**3 / (nu * alpha)
    Pr = nu / alpha
    return (0.6 + 0.387 * Ra ** (1 / 6) / (1 + (0.559 / Pr) ** (9 / 16)) ** (8 / 27)) ** 2 * k / d


def balance(name, seed, ticks=900):
    """(electrical, work, lost, stored) of all wires in joules from temperatures, phases, stress, resistance."""
    actuator, rng = Actuator.named(name), np.random.default_rng(seed)
    plant, file = ThermomechanicalPlant(actuator, DT, AMBIENT), actuator.file
    m = Material.of(file)
    d, L = file.wire.diameter.value / 1000, file.wire.active_length.value / 1000
    V, largest_A = math.pi / 4 * d * d * L, file.heating.reference_current.value
    wires = plant.mechanism.wires

    def seen(wire):
        s = wire.state
        xi = s.phase.detwinned + s.phase.twinned
        E = m.austenite_MPa + xi * (m.martensite_MPa - m.austenite_MPa)
        stored = m.density * (m.specific_heat * s.temperature_degC - m.latent_J_per_kg * xi)
        ohm = plant.resistance_ohm(1.0 if wire is wires[0] else -1.0)
        return s.temperature_degC, s.stress_MPa, s.strain, ohm, stored + s.stress_MPa**2 / (2 * E) * 1e6

    sums, start = np.zeros(4), [seen(w) for w in wires]
    before, current_A = start, 0.0
    for k in range(ticks):
        if k % 90 == 0:
            current_A = rng.uniform(-largest_A if actuator.two_wire else 0.0, largest_A)
        plant.step(current_A)
        now = [seen(w) for w in wires]
        for n, (a, b) in enumerate(zip(before, now, strict=True)):
            i = current_A if (current_A >= 0) == (n == 0) else 0.0
            mean = [(x + y) / 2 for x, y in zip(a, b, strict=True)]
            loss = churchill_chu(d, mean[0], AMBIENT) * math.pi * d * L * (mean[0] - AMBIENT)
            sums += [i * i * mean[3] * DT, mean[1] * 1e6 * (b[2] - a[2]) * V, loss * DT, 0.0]
        before = now
    sums[3] = sum((b[4] - a[4]) * V for a, b in zip(start, before, strict=True))
    return sums, plant


@pytest.mark.parametrize("name", RIGS)
def test_energy_balances(name):
    for seed in range(RUNS // len(RIGS) + 1):
        (electrical, work, lost, stored), plant = balance(name, seed)
        assert electrical > 10.0
        assert abs(work) < 0.1 * electrical
        assert electrical + work == pytest.approx(lost + stored, abs=1e-3 * electrical)
        sums = plant.energy
        assert sum(e.electrical_J for e in sums) == pytest.approx(electrical, rel=1e-4)
        assert sum(e.work_J for e in sums) == pytest.approx(work, abs=1e-4 * electrical)
        assert sum(e.lost_J for e in sums) == pytest.approx(lost, rel=1e-3)
        assert sum(e.stored_J for e in sums) == pytest.approx(stored, abs=1e-4 * electrical)
        assert all(abs(e.imbalance_J) < 1e-6 * electrical for e in sums)


def test_a_lifted_weight_has_its_potential_energy():
    plant = ThermomechanicalPlant(Actuator.named("thermomechanical_one_wire"), DT, AMBIENT)
    for _ in range(300):
        plant.step(0.9)
    assert plant.position > 12.0
    assert plant.energy[0].work_J == pytest.approx(-19.61 * plant.position / 1000, rel=1e-6)


def test_heating_and_cooling_against_a_stiff_solver():
    """dT/dt of the continuous balance, with the slope of Brinson's equations in T, for a dead weight."""
    file = Actuator.named("thermomechanical_one_wire").file
    material = Material.of(file)
    c = constants(**{name: getattr(material, name) for name in TABLE_1})
    d, L, sigma = 0.3e-3, 0.38, 19.61 / (math.pi / 4 * 0.3e-3**2) / 1e6
    V, rho = math.pi / 4 * d * d * L, material.density

    def slope(current_A, branch):
        def of_T(T):
            xi_S, xi_T, *_ = branch.peek(c, sigma, T)
            xi = xi_S + xi_T
            eps = strain(c, sigma, T, xi, xi_S)
            ohm = material.resistivity_ohm_m(T, xi) * L * (1 + eps) ** 2 / (math.pi / 4 * d * d)
            E = c.EA + xi * (c.EM - c.EA)
            stored = rho * (material.specific_heat * T - material.latent_J_per_kg * xi) + 1e6 * sigma**2 / (
                2 * E
            )
            return stored - 1e6 * sigma * eps, ohm

        def rate(_, y):
            T, step = y[0], 1e-4
            capacity = (of_T(T + step)[0] - of_T(T - step)[0]) / (2 * step)
            loss = churchill_chu(d, T, AMBIENT) * math.pi * d * L * (T - AMBIENT) if T != AMBIENT else 0.0
            return [(current_A**2 * of_T(T)[1] - loss) / V / capacity]

        return rate

    plant = ThermomechanicalPlant(Actuator.named("thermomechanical_one_wire"), DT, AMBIENT)
    T, branch = AMBIENT, Branches(1.0, 0.0)
    moved = []
    for current_A, seconds in ((0.8, 4.0), (0.3, 6.0), (0.9, 3.0), (0.0, 20.0)):
        found = solve_ivp(slope(current_A, branch), (0, seconds), [T], rtol=1e-8, atol=1e-8, max_step=0.02)
        T = float(found.y[0, -1])
        branch.go(c, sigma, T)
        for _ in range(round(seconds / DT)):
            plant.step(current_A)
        assert plant.wire_K[0] + AMBIENT == pytest.approx(T, abs=0.03)
        moved.append(plant.austenite[0])
        assert plant.austenite[0] == pytest.approx(1 - branch.xi_S - branch.xi_T, abs=2e-3)
    assert max(moved) - min(moved) > 0.7


@pytest.mark.parametrize(
    ("kelvin", "table"),
    [
        (300.0, (1.1614, 184.6e-7, 26.3e-3)),
        (350.0, (0.9950, 208.2e-7, 30.0e-3)),
        (400.0, (0.8711, 230.1e-7, 33.8e-3)),
        (450.0, (0.7740, 250.7e-7, 37.3e-3)),
    ],
)
def test_air_is_that_of_tables(kelvin, table):
    """Incropera et al., Fundamentals of Heat and Mass Transfer, table A.4."""
    assert air(kelvin - 273.15) == pytest.approx(table, rel=0.02)


def test_convection_of_a_steam_pipe():
    """Incropera et al., example 9.4: 0.1 m, 165 °C in air of 23 °C: h = 7.29 W/(m² K)."""
    assert free_convection_W_per_m2_K(0.1, 165.0, 23.0) == pytest.approx(7.29, rel=0.005)


def test_convection_is_continuous_where_wire_and_air_agree():
    assert free_convection_W_per_m2_K(3e-4, 22.0, 22.0) == pytest.approx(
        free_convection_W_per_m2_K(3e-4, 22.0001, 22.0), rel=1e-6
    )


def test_a_constant_coefficient_is_that_of_the_heating_table(tmp_path):
    """The steady temperature is then R i²/hA with the resistance of the hot wire."""
    from smarig.config import actuator_text

    path = tmp_path / "constant.toml"
    text = actuator_text("thermomechanical_one_wire").replace('"free_convection"', '"constant"')
    path.write_text(text, encoding="utf-8")
    actuator = Actuator.named(str(path))
    plant = ThermomechanicalPlant(actuator, DT, AMBIENT)
    for _ in range(1500):
        plant.step(0.9)
    steady_K = plant.resistance_ohm(0.9) * 0.81 / actuator.hA_W_per_K
    assert plant.wire_K[0] == pytest.approx(steady_K, rel=1e-6)


def test_a_force_that_varies_loads_and_unloads_the_wire():
    plant = ThermomechanicalPlant(Actuator.named("thermomechanical_one_wire"), DT, AMBIENT)
    for _ in range(600):
        plant.step(1.0)
    hot = plant.position
    for k in range(100):
        plant.step(1.0, force_N=19.61 - 0.1 * (k + 1))
    contracted_mm = 380.0 * 10.0 / (math.pi / 4 * 0.3**2) / 35917.0
    assert plant.position - hot == pytest.approx(contracted_mm, rel=5e-3)

"""Joule heating (5.1)–(5.3): exact for piecewise constant currents, with a closed energy balance."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import simpson, solve_ivp

from smarig.plant.actuator import Actuator
from smarig.plant.heating import JouleHeating, temperature_along

ONE, TWO = Actuator.named("gorbet_one_wire"), Actuator.named("gorbet_two_wire")
currents = st.lists(st.floats(-1, 1, width=32), min_size=1, max_size=20)


# --- constants (theory §3) ---------------------------------------------------------------------------


@pytest.mark.parametrize(("wire", "hA", "resistance"), [(ONE, 0.0273, 4.75), (TWO, 0.0108, 2.0)])
def test_derived_constants(wire: Actuator, hA: float, resistance: float):
    assert wire.resistance_ohm == pytest.approx(resistance, abs=1e-12)
    assert wire.hA_W_per_K == pytest.approx(hA, abs=5e-5)
    assert wire.h_W_per_m2_K == pytest.approx(76, abs=0.6)
    assert wire.tau_s == pytest.approx(5.3, abs=0.05)


@pytest.mark.parametrize("wire", [ONE, TWO])
def test_time_constant_is_that_of_a_cylinder(wire: Actuator):
    """τ = ρ c_p d/(4h): volume over surface of a long wire, whatever its length."""
    assert wire.tau_s == pytest.approx(6450 * 840 * 0.3e-3 / (4 * wire.h_W_per_m2_K), rel=1e-12)


def test_resistance_follows_the_phase():
    assert [ONE.resistance_at_ohm(xi) for xi in (0.0, 0.5, 1.0)] == pytest.approx([5.0, 4.75, 4.5])


def test_counts_are_finer_than_in_the_thesis():
    """One-wire: below 1/20 mm a count; two-wire: 0.18° a count, below 10 µm of wire (§5.1.2)."""
    assert ONE.position_per_count(2000) == pytest.approx(2 * math.pi * 15 / 2000)
    assert ONE.position_per_count(2000) < 1 / 20
    assert TWO.position_per_count(2000) == pytest.approx(0.18)
    assert math.radians(0.18) * 3.0 < 10e-3


@pytest.mark.parametrize("temperature_K", [0.0, 1.7, 43.5, 174.1, -43.5, -185.0])
def test_steady_current_and_temperature_are_inverse(temperature_K: float):
    """I = √(hA|T|/R) with the sign of T (§5.2.1), and back by (5.3)."""
    current = TWO.current_for(temperature_K)
    assert abs(current) == pytest.approx(math.sqrt(TWO.hA_W_per_K * abs(temperature_K) / TWO.resistance_ohm))
    assert TWO.input_for(current) == pytest.approx(temperature_K, rel=1e-12)


def test_a_single_wire_is_heated_by_either_sign():
    """Without the differential rig's diodes, R i² does not depend on the sign."""
    assert ONE.input_for(-0.5) == ONE.input_for(0.5) > 0


# --- the law -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wire", "current_A", "end_K"), [(ONE, 1.0, 174.1), (TWO, 1.0, 185.0), (TWO, -1.0, -185.0)]
)
@pytest.mark.parametrize("dt_s", [0.01, 0.1, 7.3])
def test_steady_state_at_full_current(wire: Actuator, current_A: float, end_K: float, dt_s: float):
    heating = JouleHeating(wire, dt_s)
    for _ in range(math.ceil(40 * wire.tau_s / dt_s)):
        u = heating.step(current_A)
    assert u == pytest.approx(end_K, rel=1e-12)
    assert heating.input_K == u


@pytest.mark.parametrize("dt_s", [0.003, 0.1, 1.0, 20.0])
def test_a_step_is_the_closed_form(dt_s: float):
    """T(t) = T_ss (1 − e^(−t/τ)): exact for any tick, half-way at τ ln 2."""
    heating = JouleHeating(ONE, dt_s)
    u = [heating.step(0.8) for _ in range(50)]
    t = dt_s * np.arange(1, 51)
    assert np.allclose(u, 174.1 * 0.64 * -np.expm1(-t / ONE.tau_s), rtol=1e-12)


@given(currents, st.sampled_from([0.02, 0.1, 2.0]))
def test_two_half_ticks_are_one_tick(record, dt_s: float):
    for wire in (ONE, TWO):
        whole, half = JouleHeating(wire, dt_s), JouleHeating(wire, dt_s / 2)
        for current in record:
            whole.step(current)
            half.step(current)
            half.step(current)
            assert half.wire_K == pytest.approx(whole.wire_K, rel=1e-12, abs=1e-12)


def test_the_differential_equation_is_solved():
    """(5.1) integrated numerically through three changes of current, both wires."""
    record = [0.9, -0.4, -1.0, 0.3]
    hA, R, C = TWO.hA_W_per_K, TWO.resistance_ohm, TWO.tau_s * TWO.hA_W_per_K
    wires, heating = np.zeros(2), JouleHeating(TWO, 4.0)
    for i in record:
        power = R * i * i * np.array([i > 0, i < 0])
        run = solve_ivp(lambda t, T, p=power: (p - hA * T) / C, (0, 4.0), wires, rtol=1e-11, atol=1e-11)
        wires = run.y[:, -1]
        heating.step(i)
        assert heating.wire_K == pytest.approx(wires.tolist(), abs=1e-7)


def test_diodes_steer_the_current():
    heating = JouleHeating(TWO, 0.1)
    heating.step(0.7)
    assert heating.wire_K[0] > 0
    assert heating.wire_K[1] == 0.0
    warm = heating.wire_K[0]
    heating.step(-0.7)
    assert 0 < heating.wire_K[0] < warm
    assert heating.wire_K[1] > 0
    single = JouleHeating(ONE, 0.1)
    assert single.step(-0.7) == JouleHeating(ONE, 0.1).step(0.7) > 0
    assert single.wire_K[1] == 0.0


@given(currents)
def test_energy_in_is_energy_stored_and_lost(record):
    """∫R i² dt = ρ c_p V T(end) + hA ∫T dt, wire by wire, T integrated by Simpson's rule."""
    n, dt_s = 200, 0.01
    for wire in (ONE, TWO):
        heating, trace = JouleHeating(wire, dt_s), [[0.0, 0.0]]
        capacity = wire.tau_s * wire.hA_W_per_K
        supplied = lost = 0.0
        for i in record:
            piece = [list(trace[-1])]
            for _ in range(n):
                heating.step(i)
                piece.append(list(heating.wire_K))
            trace = piece
            supplied += wire.resistance_ohm * i * i * n * dt_s
            lost += wire.hA_W_per_K * float(np.sum(simpson(np.array(piece), dx=dt_s, axis=0)))
        assert supplied == pytest.approx(capacity * sum(heating.wire_K) + lost, rel=1e-8, abs=1e-12)


def test_heat_capacity_is_that_of_the_wire():
    """ρ c_p V, from the dimensions of §5.1.1."""
    volume_m3 = math.pi / 4 * 0.0003**2 * 0.38
    assert ONE.tau_s * ONE.hA_W_per_K == pytest.approx(6450 * 840 * volume_m3, rel=1e-12)


def test_initialisation_at_a_tenth_of_a_hertz_lags():
    """Erratum 6: the true swing is smaller than the steady-state profile's ±185, and later."""
    dt_s, t = 0.1, np.arange(1, 1801) * 0.1
    profile = (180 - t) / 180 * 185 * np.sin(0.2 * np.pi * t)
    swing = temperature_along(TWO, [TWO.current_for(T) for T in profile], dt_s)
    first = slice(0, 100)
    assert swing[first].max() < 0.7 * profile[first].max()
    assert np.argmax(swing[first]) > np.argmax(profile[first]) + 3


def test_a_record_is_its_steps():
    record = np.linspace(-1, 1, 30)
    heating = JouleHeating(TWO, 0.5)
    assert temperature_along(TWO, record, 0.5).tolist() == [heating.step(i) for i in record]

"""Each of two wires has the phase of its own temperature: against relays that are switched one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarig.plant import Actuator, Plant, WirePhases, austenite_along
from smarig.preisach import RelayMeasure, thesis_surface

WIRE = Actuator.named("gorbet_two_wire")
R_M, R_A = 2.105, 1.895
temperatures = st.lists(
    st.tuples(st.integers(0, 190), st.integers(0, 190), st.integers(-4, 4)), min_size=1, max_size=12
)


def relays(seed):
    """Random relays over −185…185 in all three parts of the plane, none exactly at a whole kelvin."""
    rng = np.random.default_rng(seed)
    alpha, beta = np.sort(rng.uniform(-184.5, 184.5, (2, 400)), axis=0)[::-1]
    return alpha, beta, rng.uniform(0.5, 1.5, 400)


def relay_by_relay(alpha, beta, mass, path_K, wire):
    """ξ (n,) of one wire: its own relays, α, β ≥ 0 or ≤ 0, each with a memory of its own."""
    on_at, off_at = (alpha, beta) if wire == 0 else (-beta, -alpha)  # in kelvin of this wire
    own = off_at >= 0
    on, found = np.zeros(alpha.size, dtype=bool), []
    for T in path_K:
        on = np.where(on, off_at < T, on_at <= T)
        found.append(float(mass[own] @ on[own] / mass[own].sum()))
    return found


@given(temperatures, st.integers(0, 5))
def test_phases_are_those_of_each_wire_s_own_relays(path, seed):
    alpha, beta, mass = relays(seed)
    wires = WirePhases(RelayMeasure.from_arrays(alpha, beta, mass))
    found = []
    for first, second, ambient in path:
        wires.step((first, second), ambient)
        found.append(list(wires.austenite))
    for wire in (0, 1):
        own = [max(p[wire] + p[2], 0) for p in path]
        assert [x[wire] for x in found] == pytest.approx(
            relay_by_relay(alpha, beta, mass, own, wire), abs=1e-9
        )


@pytest.mark.parametrize("surface", ["two_c", "two_p", "two_e"])
def test_cold_is_martensite_and_hot_is_austenite_in_each_wire(surface):
    wires = WirePhases(thesis_surface(surface))
    for step, ends in (((185.0, 0.0), [1.0, 0.0]), ((0.0, 185.0), [0.0, 1.0]), ((185.0, 185.0), [1.0, 1.0])):
        wires.step(step)
        assert wires.austenite == pytest.approx(ends, abs=1e-12)
        wires.step((0.0, 0.0))
        assert wires.austenite == pytest.approx([0.0, 0.0], abs=1e-12)


@given(st.lists(st.sampled_from([-1.0, -0.7, -0.4, 0.3, 0.6, 1.0]), max_size=6))
def test_two_cold_wires_have_the_resistance_of_martensite_wherever_the_pulley_stands(currents):
    plant = Plant(WIRE, thesis_surface("two_e"), "anhysteretic", dt_s=1.0)
    assert plant.austenite == (0.0, 0.0)  # B*: both wires are martensite
    for current in currents:
        for _ in range(20):
            plant.step(current)
    for _ in range(200):
        plant.step(0.0)
    assert [plant.resistance_ohm(i) for i in (0.1, -0.1)] == pytest.approx([R_M, R_M], abs=1e-9)


def test_the_hot_wire_is_austenite_while_the_other_stays_martensite():
    plant = Plant(WIRE, thesis_surface("two_e"), "anhysteretic", dt_s=1.0)
    for _ in range(100):
        plant.step(-1.0)
    assert plant.resistance_ohm(-1.0) == pytest.approx(R_A, abs=1e-6)
    assert plant.resistance_ohm(1.0) == pytest.approx(R_M, abs=1e-6)


def test_a_surface_that_gives_nothing_back_follows_the_temperature():
    alpha, beta = np.array([30.0, 60.0]), np.array([-30.0, -60.0])  # set by one wire, reset by the other
    wires = WirePhases(RelayMeasure.from_arrays(alpha, beta, np.ones(2)))
    wires.step((15.0, 60.0))
    assert wires.austenite == pytest.approx([0.25, 1.0])


@pytest.mark.parametrize("name", ["two_e", "one_e", "measure"])
def test_along_a_path_they_are_those_of_its_steps_bit_for_bit(name):
    """Paths with turns, pauses, temperatures below 0 and beyond saturation; one_e gives nothing back below 0."""
    rng = np.random.default_rng(4)
    hysteresis = RelayMeasure.from_arrays(*relays(1)) if name == "measure" else thesis_surface(name)
    wires_K = np.repeat(rng.normal(0, 9, (2, 500)).cumsum(axis=1), 2, axis=1)
    wires, steps = WirePhases(hysteresis), np.empty((1000, 2))
    for k, pair in enumerate(wires_K.T.tolist()):
        wires.step(pair)
        steps[k] = wires.austenite
    assert np.ptp(steps[:, 0]) > 0.5
    for at in (np.arange(1000), np.array([0, 7, 7, 350, 351, 999]), np.array([500])):
        np.testing.assert_array_equal(austenite_along(hysteresis, list(wires_K), at), steps[at].T)


@pytest.mark.parametrize("surface", ["two_c", "two_e"])
def test_a_phase_that_is_asked_for_rarely_is_that_of_one_asked_for_always(surface):
    dice = np.random.default_rng(3)
    rarely, always = WirePhases(thesis_surface(surface)), WirePhases(thesis_surface(surface))
    path = np.cumsum(dice.normal(0, 20, (400, 2)), axis=0) % 190
    path[dice.random(400) < 0.3] = path[0]  # pauses and returns
    for k, wire_K in enumerate(path.tolist()):
        rarely.step(wire_K)
        always.step(wire_K)
        expected = always.austenite
        if k % 17 == 0:
            assert rarely.fraction(k % 2) == expected[k % 2]
    assert rarely.austenite == always.austenite

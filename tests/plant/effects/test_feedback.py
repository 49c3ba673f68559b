"""The equilibrium of an input that depends on its own output: closed forms, and stress in a plant."""

import numpy as np
import pytest
from scipy.optimize import brentq

from plant.effects.driven import WIRES, kind
from smarig.plant.plant import Plant, self_consistent_input

DRIVES = {
    "one_wire": [0.85, 0.5, 0.75, 0.3, 0.8, 0.62, 0.7, 0.55, 0.1],
    "two_wire": [0.9, -0.85, 0.7, -0.5, 0.8, 0.3, -0.9, 0.1],
}
SHIFTS_K = (8.0, -8.0)
SETTLED_S = 120.0


def rest_of(f, u):
    """Where the feedback u = f(u) comes to rest from u."""
    return self_consistent_input(lambda v: f(v) - v, u, f(u) - u)


def first_root(f, u, *, far=40.0):
    """The root of f(v) = v that is met first on the way from u, by scanning."""
    way = np.linspace(u, u + np.sign(f(u) - u) * far, 400_001)
    k = int(np.flatnonzero(np.diff(np.sign(f(way) - way)))[0])
    return brentq(lambda v: f(v) - v, way[k], way[k + 1], xtol=1e-12)


@pytest.mark.parametrize("slope", [0.1, 1.0, 3.0, 20.0])
@pytest.mark.parametrize(("load", "start"), [(10.0, 0.0), (-10.0, 0.0), (7.0, 30.0)])
def test_feedback_against_the_move_rests_at_the_root_of_the_equation(slope, load, start):
    """u = a − b u has its root at a/(1 + b)."""
    assert rest_of(lambda u: load - slope * u, start) == pytest.approx(load / (1 + slope), abs=2e-6)


@pytest.mark.parametrize("slope", [0.2, 0.5, 0.7])
def test_feedback_with_the_move_goes_on_to_where_it_finds_hold(slope):
    assert rest_of(lambda u: 4.0 + slope * u, 0.0) == pytest.approx(4.0 / (1 - slope), abs=1e-5)


@pytest.mark.parametrize("low", [0.5, 1.5, 2.5])  # of the first there are three roots
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_feedback_that_saturates_ends_at_its_first_root(low, sign):
    def f(u):
        return sign * (low + 9.0 / (1.0 + np.exp(-2.0 * (sign * u - 3.0))))

    root = first_root(f, 0.0)
    assert rest_of(f, 0.0) == pytest.approx(root, abs=1e-5)
    assert abs(root) < 1 if low == 0.5 else abs(root) > 9


@pytest.mark.parametrize("u", [-3.0, 0.0, 41.5])
def test_what_is_not_driven_stays(u):
    assert rest_of(lambda v: v, u) == u
    assert rest_of(lambda v: 2.0 * u - v, u) == u


def plant(wire, shift_K, dt_s):
    return Plant(*WIRES[wire], dt_s, [kind("stress_coupling")(shift_K)])


def rests(wire, shift_K, dt_s):
    """Where each current leaves the wire, in strokes."""
    p, hysteresis = plant(wire, shift_K, dt_s), WIRES[wire][1]
    for current in DRIVES[wire]:
        for _ in range(round(SETTLED_S / dt_s)):
            y = p.step(current)
        yield y / hysteresis.everett(hysteresis.upper, hysteresis.lower)


@pytest.mark.parametrize("shift_K", SHIFTS_K)
@pytest.mark.parametrize("wire", list(WIRES))
def test_stress_settles_where_it_does_whatever_the_length_of_a_tick(wire, shift_K):
    fine, coarse = (list(rests(wire, shift_K, dt_s)) for dt_s in (0.1, 2.0))
    np.testing.assert_allclose(coarse, fine, atol=1e-6)
    assert np.abs(np.array(fine) - list(rests(wire, 0.0, 2.0))).max() > 0.01


@pytest.mark.parametrize("shift_K", SHIFTS_K)
@pytest.mark.parametrize("dt_s", [0.1, 2.0])
@pytest.mark.parametrize(("wire", "middle"), [("one_wire", 0.0), ("two_wire", 0.5)])
def test_at_every_tick_stress_is_that_of_the_stroke_just_made(wire, middle, dt_s, shift_K):
    p, inside = plant(wire, shift_K, dt_s), 0
    hysteresis = WIRES[wire][1]
    for current in DRIVES[wire]:
        for _ in range(round(30.0 / dt_s)):
            p.step(current)
            if hysteresis.lower < p.hysteresis_input_K < hysteresis.upper:
                inside += 1
                felt = p.now.input_K - shift_K * (p.share - middle)
                assert p.hysteresis_input_K == pytest.approx(felt, abs=1e-5)
                assert p.now.share == p.share
    assert inside > 50

"""Figs 8.5 and 8.6: the cost of ±d at B_ℓ and on the outer branches, by relays, on the operator and on the
twin."""

import numpy as np
import pytest

from benchmarks import regulation
from benchmarks.disturbance_comparison import (
    FIGURES,
    STATE_KINDS,
    _recovery_inputs,
    disturbance_comparison,
    disturbance_cost,
    setpoints,
    state_of_output,
)
from preisach.relay_reference import Printed, cells, lower_half
from smarig.control.regulation import BoundaryPlane, Psi
from smarig.control.regulation.setpoint_pi import SetpointPI, steepest
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from smarig.protocols._setup import Setup

long = pytest.mark.long("takes eight seconds")

RIGS = {"one_wire_twin": "one_e", "two_wire_twin": "two_e"}


def test_a_small_fall_sweeps_d_squared_from_the_diagonal_and_half_of_it_from_a_rise():
    """Relays of one weight everywhere (2μ = 1 to the cell's area): theory, after Fig. 8.5."""
    n, d = 200, 30
    i, j = np.tril_indices(n, -1)
    even = RelayMeasure.from_arrays(i - n / 2, j - n / 2, np.full(i.size, 0.5))
    state = {kind: state_of_output(even, 0.0, kind) for kind in STATE_KINDS}
    falls = {kind: disturbance_cost(even, state[kind], kind, -d).push for kind in STATE_KINDS}
    rises = {kind: disturbance_cost(even, state[kind], kind, d).push for kind in STATE_KINDS}
    assert falls["diagonal"] == pytest.approx(d**2, rel=0.05)
    assert rises["diagonal"] == pytest.approx(d**2, rel=0.05)
    assert falls["ascending"] == pytest.approx(d**2 / 2, rel=0.05)
    assert rises["descending"] == pytest.approx(d**2 / 2, rel=0.05)
    assert min(rises["ascending"], falls["descending"]) > 3 * d**2, "forwards a whole strip is swept"


@pytest.mark.parametrize("name", ["one_e", "two_e"])
def test_pushes_from_the_diagonal_are_what_relays_do(name):
    printed, h = Printed(name), thesis_surface(name)
    psi, span = Psi(h), h.upper - h.lower
    ell = h.lower + 0.3 * span
    near = ell + np.linspace(h.lower - ell, ell - h.lower, 21)
    push = 2 * (near[1] - near[0])  # 6 % of the range
    levels = np.append(near, np.linspace(near[-1], h.upper, 6)[1:])
    here = disturbance_comparison(h, psi(ell), push, psi)
    assert here.rests["diagonal"] == pytest.approx(ell, abs=1e-9)
    for sign, of in ((-1, here.falling), (1, here.rising)):
        relays = cells(levels, printed.y, ell, lower_half(printed.y_alpha_beta))
        start = relays.nu[relays.on].sum()
        relays.go(levels[np.argmin(np.abs(levels - ell - sign * push))])
        assert of["diagonal"].push == pytest.approx(abs(relays.nu[relays.on].sum() - start), rel=1e-9)


@pytest.mark.parametrize("name", ["one_e", "two_e"])
def test_on_the_operator_the_diagonal_is_better_in_the_worse_of_both_signs(name):
    h = thesis_surface(name)
    psi, rows = Psi(h), []
    for y in setpoints(h, 20)[1::3]:
        rows.append(disturbance_comparison(h, y, 0.03 * (h.upper - h.lower), psi))
    for figure in FIGURES:
        assert all(row.ratio(figure, kind) < 1 for row in rows for kind in STATE_KINDS[1:]), figure
    halves = [row.falling["ascending"].push < row.falling["diagonal"].push for row in rows]
    assert any(halves), "against −d alone, what was reached by rising often does better"
    assert not any(row.falling["ascending"].pulse < row.falling["diagonal"].pulse for row in rows), (
        "when the pulse ends, it pushes the other way, and that is the end of it"
    )


@pytest.mark.parametrize("name", ["one_e", "two_e"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_after_the_recovery_the_state_is_what_it_was(name, sign):
    h = thesis_surface(name)
    plane, push = BoundaryPlane.of(h), sign * 0.03 * (h.upper - h.lower)
    for kind in STATE_KINDS:
        before = state_of_output(h, setpoints(h, 5)[2], kind)
        operator = Preisach(h, before)
        operator.step(before.u + push)
        apart = plane.distance(plane.state(operator.state), before.u) if kind == "diagonal" else 1.0
        operator.follow(_recovery_inputs(h, before, kind, push))
        if kind == "diagonal":
            left = plane.distance(plane.state(operator.state), before.u)
            assert left == pytest.approx(apart / 32, rel=0.2), "a decaying sine of eight cycles, d²/32 of d²"
        else:
            assert plane.state(operator.state).points == plane.state(before).points


def test_the_output_is_back_after_each_correction():
    h = thesis_surface("one_e")
    state = state_of_output(h, 6.0, "descending")
    operator = Preisach(h, state)
    fall = operator.step(state.u - 5.0) - 6.0
    found = disturbance_cost(h, state, "descending", -5.0)
    assert found.push == pytest.approx(-fall, rel=1e-12)
    assert found.swing > 5.0, "another branch leads back, and further"
    assert found.recovery == pytest.approx(12.54 - 6.0), "the state comes back by way of saturation only"
    assert found.recovery_swing == pytest.approx(174.1 - state.u)


def test_the_gentle_loops_zero_cancels_the_lag_so_the_temperature_keeps_one_direction():
    setup, h = Setup.of("one_wire_twin"), thesis_surface("one_e")
    loop = SetpointPI.for_model(setup, h)
    slope = max(float(np.max(h.strip_beta(h.upper, np.linspace(0, 174.1, 999)))), 0.0)
    assert steepest(h) >= 0.99 * slope
    operator, decay, wire = Preisach(h), np.exp(-0.1 / setup.tau_s), 30.0
    loop.start(wire)
    source, path = wire, []
    operator.step(wire)
    for _ in range(4000):
        wire = source + (wire - source) * decay
        path.append(wire)
        source = loop.step(5.0 - operator.step(wire))
    assert abs(operator.y - 5.0) < 1e-3
    assert np.all(np.diff(path) > -1e-9), "no branch is left that need not be"


@pytest.mark.long("takes three seconds", cases=("one_wire_twin-7.8375",))
@pytest.mark.parametrize(
    ("rig", "setpoint"), [("one_wire_twin", 7.8375), pytest.param("two_wire_twin", 8.5826, marks=long)]
)
def test_on_the_twin_through_lag_and_loop_too(rig, setpoint):
    """One set-point of twenty for each rig; all of them: ``smarig benchmark regulation``."""
    h = thesis_surface(RIGS[rig])
    push_K = 0.03 * (h.upper - h.lower)
    worst = {
        kind: max(
            regulation.regulate_on_twin(rig, h, setpoint, kind, sign * push_K, seed=5)["transient"]
            for sign in (-1, 1)
        )
        for kind in STATE_KINDS
    }
    assert worst["diagonal"] < 0.7 * min(worst["ascending"], worst["descending"])
    assert worst["diagonal"] > 0.05, "the disturbance was felt"

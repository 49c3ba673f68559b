"""The planned path to B_ℓ: on the twin with lag, the wire's distance from B_ℓ is as small as predicted."""

import numpy as np
import pytest

from smarig.control.regulation import BoundaryPlane, plan_approach, regulate
from smarig.control.regulation.approach import _rate_limited
from smarig.core.errors import UsageError
from smarig.plant.heating import temperature_along
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.protocols._setup import Setup
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

RIGS = {"one_wire_twin": "one_e", "two_wire_twin": "two_e"}


def driven(rig, currents_A, seed=0, before_A=()):
    """The wire's memory after currents, on the noisy twin, behind the guard of its limits; and its temperatures."""
    twin = Twin.named(rig, seed=seed)
    guard = Guard(twin, twin.file.limits, twin.actuator)
    hysteresis_input_K = []
    for current_A in (*before_A, *currents_A):
        guard.step(current_A)
        hysteresis_input_K.append(twin.specimen.plant.hysteresis_input_K)
    assert not guard.tripped
    return twin.specimen.plant.operator.state, np.array(hysteresis_input_K)


def area_by_relays(hysteresis_input_K, plane, ell, n=300):
    """The area between the wire's state and B_ℓ, relay by relay on a grid: no stack, no boundary."""
    u = plane.lower + (plane.upper - plane.lower) * (np.arange(n) + 0.5) / n
    alpha, beta = (x[np.triu_indices(n)] for x in np.meshgrid(u, u))
    on = np.zeros(alpha.size, dtype=bool)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(hysteresis_input_K)))) + 1
    before = plane.lower
    for here in [*hysteresis_input_K[turns].tolist(), hysteresis_input_K[-1].item()]:
        if here > before:
            on[alpha <= here] = True
        else:
            on[beta >= here] = False
        before = here
    wrong = on != (alpha + beta < 2 * ell)
    return float(wrong.sum()) * (u[1] - u[0]) ** 2


def anywhere(rig, seed):
    """Currents of no plan: four random levels, each for some seconds."""
    rng, limits = np.random.default_rng(seed), Setup.of(rig).limits
    return np.repeat(rng.uniform(limits.current_min_A, limits.current_max_A, 4), rng.integers(20, 120, 4))


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize(("share", "within"), [(0.12, 0.01), (0.4, 0.01), (0.75, 0.004)])
def test_the_twin_comes_as_near_as_predicted_from_wherever_it_was(rig, share, within):
    hysteresis, plane = thesis_surface(RIGS[rig]), BoundaryPlane.of(thesis_surface(RIGS[rig]))
    ell = plane.lower + share * (plane.upper - plane.lower)
    planned = plan_approach(Setup.of(rig), hysteresis, ell, within)
    assert 0.3 * within < planned.share <= within
    state, hysteresis_input_K = driven(
        rig, planned.currents_A, seed=3, before_A=anywhere(rig, seed=int(100 * share))
    )
    reached = plane.distance(plane.state(state), ell)
    assert abs(reached - planned.predicted_distance) < max(
        0.02 * planned.predicted_distance, planned.memory_left
    )
    assert abs(reached - planned.predicted_distance) < 0.1 * planned.predicted_distance
    by_relays = area_by_relays(hysteresis_input_K, plane, ell)
    assert reached == pytest.approx(by_relays, abs=0.05 * reached + 0.0005 * plane.area)
    assert state.u == pytest.approx(ell, abs=0.2)


def test_a_sinusoid_that_is_followed_exactly_misses_by_a_square_over_four_cycles():
    plane = BoundaryPlane(-100.0, 100.0)
    for ell, n in ((0.0, 6), (-30.0, 10), (55.0, 4)):
        amplitude = 100.0 - abs(ell)
        first = np.sign(ell) or 1.0
        extrema = [ell + first * (-1) ** k * amplitude * (1 - k / (2 * n)) for k in range(2 * n + 1)]
        reached = plane.distance(plane.boundary_after([-first * 100.0, *extrema]), ell)
        assert reached == pytest.approx(amplitude**2 / (4 * n), rel=1e-9)


@pytest.mark.parametrize("rig", RIGS)
def test_more_cycles_for_less_distance_and_in_the_end_little_is_the_lags(rig):
    setup, hysteresis = Setup.of(rig), thesis_surface(RIGS[rig])
    ell = setup.at(0.3)
    coarse, fine = (plan_approach(setup, hysteresis, ell, within) for within in (0.02, 0.005))
    assert fine.cycles > 2 * coarse.cycles
    assert fine.duration_s > coarse.duration_s
    for planned in (coarse, fine):
        assert 0.99 * planned.closed_form < planned.predicted_distance < 2 * planned.closed_form


def test_the_print_taken_literally_does_not_get_there():
    """(8.2) by the steady law, from t = 0, for as long as our plan takes: the lag eats the swings."""
    setup, hysteresis, ell = Setup.of("one_wire_twin"), thesis_surface("one_e"), 60.0
    plane, planned = BoundaryPlane.of(hysteresis), plan_approach(setup, hysteresis, ell, 0.01)
    t = planned.period_s * np.arange(1, len(planned.currents_A) + 1)
    u = (1 - t / t[-1]) * (174.1 - ell) * np.sin(0.2 * np.pi * t) + ell
    literal = [setup.current_for(v) for v in np.clip(u, setup.lower_K, setup.upper_K)]
    reached = plane.distance(plane.state(driven("one_wire_twin", literal)[0]), ell)
    assert reached > 3 * planned.predicted_distance


def test_an_output_tolerance_can_be_required_as_well():
    setup, hysteresis = Setup.of("one_wire_twin"), thesis_surface("one_e")
    loose, tight = (
        plan_approach(setup, hysteresis, 13.8, 0.01),
        plan_approach(setup, hysteresis, 13.8, 0.01, 0.005),
    )
    assert abs(loose.output_error) > 0.01
    assert abs(tight.output_error) <= 0.005
    state, _ = driven("one_wire_twin", tight.currents_A)
    assert (state.y - tight.output_error * 12.54) == pytest.approx(0.305, abs=0.02)


def test_an_unmodelled_lag_costs_little():
    setup, hysteresis, ell = Setup.of("one_wire_twin"), thesis_surface("one_e"), 80.0
    plane, planned = BoundaryPlane.of(hysteresis), plan_approach(setup, hysteresis, ell, 0.005)
    decay, wire, wire_K = np.exp(-0.1 / (1.1 * setup.tau_s)), 0.0, []
    for current_A in planned.currents_A:  # (5.1) with τ 10 % longer, written out
        source = 174.1 * current_A**2
        wire = source + (wire - source) * decay
        wire_K.append(wire)
    reached = plane.distance(plane.boundary_after(wire_K), ell)
    assert planned.predicted_distance < reached < 1.3 * planned.predicted_distance


def test_the_prediction_is_the_heating_law_along_the_currents_slow_amplifiers_included():
    setup = Setup.of("two_wire_twin")
    slow = Setup(setup.actuator, setup.limits.model_copy(update={"current_rate_A_per_s": 1.0}), 0.1)
    for one in (setup, slow):
        planned = plan_approach(one, thesis_surface("two_e"), -60.0, 0.02)
        along = temperature_along(one.actuator, planned.currents_A, 0.1)
        assert np.max(np.abs(along - planned.temperature_K)) < 1e-9
        assert np.max(np.abs(np.diff(planned.currents_A))) <= one.limits.current_rate_A_per_s * 0.1 + 1e-12
    assert _rate_limited(np.array([1.0, 1.0, 0.0]), 0.6).tolist() == [0.6, 1.0, 0.4]


def test_the_ends_of_the_range_need_no_sinusoid():
    setup, hysteresis = Setup.of("one_wire_twin"), thesis_surface("one_e")
    for ell in (hysteresis.lower, hysteresis.upper):
        assert plan_approach(setup, hysteresis, ell, 0.01).share < 0.005


def test_what_limits_do_not_allow_is_refused_in_a_sentence():
    setup, hysteresis = Setup.of("one_wire_twin"), thesis_surface("one_e")
    cool = Setup(setup.actuator, setup.limits.model_copy(update={"temperature_max_K": 120.0}), 0.1)
    with pytest.raises(UsageError, match=r"allow 0.0 to 119.5 K.*cannot be wiped out.*Widen the limits"):
        plan_approach(cool, hysteresis, 60.0, 0.01)
    with pytest.raises(UsageError, match="outside the common range of this rig and this hysteresis"):
        plan_approach(setup, hysteresis, 180.0, 0.01)
    with pytest.raises(UsageError, match="a share of the plane between 0 and 1, got 0"):
        plan_approach(setup, hysteresis, 60.0, 0.0)
    with pytest.raises(UsageError, match=r"The period of a tick must be a positive number, got 0\.0"):
        plan_approach(Setup(setup.actuator, setup.limits, 0.0), hysteresis, 60.0)


def test_what_no_sinusoid_reaches_is_refused_in_a_sentence(monkeypatch):
    monkeypatch.setattr("smarig.control.regulation.approach.MAX_CYCLES", 5)
    with pytest.raises(UsageError, match=r"No sinusoid brings the wire within 1 % of B_ℓ.*at most 5 cycles"):
        plan_approach(Setup.of("one_wire_twin"), thesis_surface("one_e"), 87.0, 0.01)


def regulated(rig, listener=None, **settings):
    twin = Twin.named(rig, seed=2)
    runner = Runner(Guard(twin, twin.file.limits, twin.actuator), twin.position_per_count, listener or [])
    runner.run(regulate(Setup.of(rig), hysteresis=thesis_surface(RIGS[rig]), **settings))
    return twin


@pytest.mark.parametrize(("rig", "setpoint"), [("one_wire_twin", 4.0), ("two_wire_twin", -6.0)])
def test_the_protocol_regulates_through_the_runner_and_ends_at_zero(rig, setpoint):
    twin, held = None, []

    def watch(sample, step, _input_K):
        if step is None:
            held.append((sample.position, sample.current_command_A))

    twin = regulated(rig, [CallbackListener(on_sample=watch)], setpoint=setpoint, hold_s=60.0)
    assert twin.output_A == 0.0
    currents = np.abs([current for _, current in held])
    assert len(held) > 600, "a minute in closed loop, then down to zero as slowly as the limit says"
    assert currents[:600].min() > 0.0 == currents[-1]
    assert np.all(np.diff(currents[599:]) < 0.0)
    held = held[:600]
    start = thesis_surface(RIGS[rig]).y_lower if rig == "one_wire_twin" else 1.59  # where the encoder woke up
    error = np.array([position for position, _ in held[300:]]) - (setpoint - start)
    assert abs(error.mean()) < 0.5 * twin.position_per_count
    assert np.abs(error).max() < 3 * twin.position_per_count


def test_bad_regulation_is_refused_before_any_current():
    setup, hysteresis = Setup.of("one_wire_twin"), thesis_surface("one_e")
    for settings, says in (
        ({"setpoint": 13.0}, "outside the outputs"),
        ({"setpoint": 6.0, "start": "sideways"}, "diagonal, ascending or descending"),
        ({"setpoint": 6.0, "hold_s": -1.0}, "must not be negative"),
        ({"setpoint": 6.0, "disturbance_K": 3.0, "hold_s": 50.0}, "longer hold_s"),
    ):
        with pytest.raises(UsageError, match=says):
            next(regulate(setup, hysteresis=hysteresis, **settings))

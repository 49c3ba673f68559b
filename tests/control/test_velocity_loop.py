"""Thm 8.2 on the operator alone: the loop closes exactly, its samples are passive, and k_e is never
exceeded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.measures import DT_S, controllers, signals, table, tables
from smarig.certificate.velocity import k_e, stability, velocity_loop
from smarig.certificate.velocity.passivity_indices import response
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.controllers.leaky_pi import leaky_pi
from smarig.core.errors import DataError, UsageError
from smarig.plant.actuator import Actuator
from smarig.plant.heating import JouleHeating
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach, State

PAST = st.lists(st.floats(-3.0, 3.0), max_size=4)
LAG = st.sampled_from([0.0, 0.5])


def at(hysteresis: Everett, past: list[float]) -> State:
    operator = Preisach(hysteresis, "anhysteretic")
    operator.follow(past)
    return operator.state


def norms(signal: np.ndarray) -> np.ndarray:
    return np.sqrt(DT_S * np.cumsum(signal**2))


@settings(max_examples=20)
@given(tables, controllers(), signals(rows=2), PAST)
def test_the_loop_is_the_figure(model, controller, rate_and_offset, past):
    """Fig. 8.2 put together again from u alone."""
    rate, offset = rate_and_offset
    start = at(model, [*past, 0.0])
    loop = velocity_loop(model, controller, rate, offset, dt_s=DT_S, initial=start)
    y = Preisach(model).simulate(loop.u, start)
    error = rate - np.diff(y, prepend=start.y) / DT_S
    control = response(controller, error, DT_S)
    scale = 1.0 + np.abs(control).max() + np.abs(offset).max()
    np.testing.assert_allclose(loop.error, error, atol=1e-9 * scale)
    np.testing.assert_allclose(loop.u, control + offset, atol=1e-7 * scale)


@pytest.mark.long("takes a second")
@given(tables, controllers(), signals(rows=2), PAST, LAG)
def test_k_e_is_never_exceeded_from_rest(model, controller, rate_and_offset, past, lag_s):
    rate, offset = rate_and_offset
    start = at(model, [*past, 0.0])
    loop = velocity_loop(model, controller, rate, offset, dt_s=DT_S, initial=start, lag_s=lag_s)
    error, driven, offsets = norms(loop.error), norms(rate), norms(offset)
    bound = k_e(controller) * (driven + offsets)
    assert np.all(error <= bound * (1 + 1e-9) + 1e-9)
    sharp = ((controller.gamma + controller.delta) * driven + offsets) / controller.delta
    assert np.all(error <= sharp * (1 + 1e-9) + 1e-9)
    supplied = np.cumsum(loop.u * np.diff(loop.y, prepend=start.y))
    assert supplied.min() >= -1e-9 * (1 + np.abs(loop.u).max())


@settings(max_examples=20)
@given(tables, controllers(), signals(rows=2), PAST, LAG)
def test_the_energy_stored_at_the_start_is_all_that_is_added(model, controller, rate_and_offset, past, lag_s):
    rate, offset = rate_and_offset
    loop = velocity_loop(model, controller, rate, offset, dt_s=DT_S, initial=at(model, past), lag_s=lag_s)
    assert np.all(norms(loop.error) <= loop.sharp_bound * (1 + 1e-9) + 1e-9)


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("lag_s", [0.0, 5.3])
@pytest.mark.parametrize("name", ["one_c", "one_e", "two_c", "two_e"])
@pytest.mark.parametrize("controller", [constant_gain(3000.0), leaky_pi(1000.0, 300.0, 0.1)])
def test_the_wires_obey_it_and_move(name: str, controller, lag_s: float):
    rate = 0.3 * np.sin(np.arange(200) * DT_S)
    start = "negative" if name.startswith("one") else "anhysteretic"
    loop = velocity_loop(thesis_surface(name), controller, rate, dt_s=DT_S, initial=start, lag_s=lag_s)
    assert np.ptp(loop.y) > 0.3, "the reference must be followed at all"
    assert loop.final_ratio < 0.95
    assert loop.largest_ratio <= loop.k_e
    assert loop.supplied.min() >= -1e-9


def test_a_tick_of_delay_breaks_the_bound():
    """The same controller, plant and reference, but u_k from ė_{k−1}: what every rig does."""
    controller, operator = constant_gain(4000.0), Preisach(thesis_surface("two_e"), "anhysteretic")
    rate, velocity, errors = 0.05 * np.ones(200), 0.0, []
    for r in rate.tolist():
        before = operator.y
        velocity = (operator.step(controller.gamma * (r - velocity)) - before) / DT_S
        errors.append(r - velocity)
    assert np.linalg.norm(errors) > 10 * k_e(controller) * np.linalg.norm(rate)
    without = velocity_loop(thesis_surface("two_e"), controller, rate, dt_s=DT_S, initial="anhysteretic")
    assert without.largest_ratio <= k_e(controller)


@pytest.mark.parametrize("name", ["one_e", "two_e"])
def test_heating_within_limits_keeps_the_current_passive(name: str):
    """Σ s_k Δy_k ≥ 0, s the temperature a current stands for, on the heating law of the twin."""
    model = thesis_surface(name)
    actuator = Actuator.named("gorbet_two_wire" if name.startswith("two") else "gorbet_one_wire")
    rng = np.random.default_rng(5)
    source = np.repeat(rng.uniform(model.lower, model.upper, 200), 5)
    heating = JouleHeating(actuator, 1.0)
    felt = np.array([heating.step(actuator.current_for(s)) for s in source.tolist()])
    y = Preisach(model).simulate(felt, "negative" if model.lower == 0 else "anhysteretic")
    supplied = np.cumsum(source[1:] * np.diff(y))
    assert np.abs(source - felt).mean() > 5.0, "the wire must lag"
    assert supplied.min() >= -1e-9
    assert supplied[-1] > 100.0


def test_a_jump_has_no_loop():
    relays = RelayMeasure.from_arrays([1.0, 2.0], [-1.0, -2.0], [1.0, 1.0])
    with pytest.raises(UsageError, match="need not have a solution"):
        velocity_loop(relays, constant_gain(1.0), [1.0])


def test_an_output_that_opposes_its_input_is_an_error():
    nodes = np.array([0.0, 1.0, 2.0])
    backwards = FodTable.from_arrays(
        nodes, nodes, [[0.0, np.nan, np.nan], [0.0, -1.0, np.nan], [0.0, 0.0, 1.0]]
    )
    with pytest.raises(DataError, match="falls as the input rises"):
        velocity_loop(backwards, constant_gain(1.0), [0.5], dt_s=1.0)


def test_signals_of_different_lengths_are_refused():
    with pytest.raises(DataError, match="offsets of the same shape"):
        velocity_loop(table(1), constant_gain(1.0), [1.0, 2.0], [0.0])


@pytest.mark.long("takes a second")
def test_the_statement_names_what_fails():
    fine = stability(thesis_surface("one_e"), constant_gain(4.0))
    assert fine.holds
    assert fine.text.startswith("Stable (Thm 8.2)")
    warm = stability(thesis_surface("two_c"), constant_gain(4.0), "positive")
    assert [h.name for h in warm.hypotheses if not h.holds] == ["u(0) = 0"]
    broken = stability(thesis_surface("two_p"), constant_gain(4.0), "anhysteretic")
    assert broken.holds is False
    assert "gives energy back" in broken.text
    assert "Assumption 2.1" not in broken.text
    assert stability(table(3), leaky_pi(1.0, 1.0, 1.0), "anhysteretic").holds

"""The noise floor is the standard deviation of repeated readings of one memory state."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run
from identification.made_runs import driven_run, fod_run, made_run, read
from smarig.identification.noise_floor import noise_floor
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

LOOPS = [0, *([100, 50, 80, 60] * 40)]


def test_repeats_give_the_noise_of_a_reading():
    floor = noise_floor(driven_run("two_e", [-185, *LOOPS], seed=2, initial="anhysteretic"))
    assert floor.source == "repeats"
    assert floor.n_pairs == 4 * 39
    assert floor.value == pytest.approx(np.sqrt(0.4**2 + 1 / 12) * 0.18, rel=0.1)
    assert floor.unit == "deg"


def test_the_same_input_in_another_state_is_no_repeat():
    exact = noise_floor(driven_run("one_e", [0, 100, 50, 174.1, 50, 0, 30, 100, 50]))
    assert exact.value == pytest.approx(0, abs=1e-12)  # 50 twice, but from another maximum


def test_saturation_serves_when_there_is_nothing_else():
    floor = noise_floor(fod_run("one_e", seed=1))
    assert floor.source == "saturation"
    assert floor.n_pairs >= 9


def test_holding_on_is_no_repeat_and_nothing_repeated_is_none():
    run = made_run([0, 40, 40, 40, 90], [0, 1.0, 2.0, 3.0, 4.0])
    floor = noise_floor(run)
    assert floor.value is None
    assert floor.n_pairs == 0
    assert floor.source == "none"


def test_repeats_are_pooled_within_runs_never_across_encoder_zeros():
    y = Preisach.from_surface(thesis_surface("one_e")).simulate(LOOPS)
    rng = np.random.default_rng(0)
    a, b = made_run(LOOPS, read(y, "one", rng)), made_run(LOOPS, read(y, "one", rng) + 5.0)
    assert noise_floor([a, b]).value == pytest.approx(noise_floor(a).value, rel=0.1)
    assert noise_floor([a, b]).n_pairs == 2 * noise_floor(a).n_pairs


def test_a_state_in_which_the_output_moved_by_itself_is_no_noise():
    """Twelve loops run twice with noise of 0.01, and one reading that is 0.5 off, as by slip in the grips."""
    rng = np.random.default_rng(3)
    inputs = [0.0, *(u for k in range(24) for u in (100.0, 20.0 + 2 * (k % 12)))]
    y = np.array(inputs) / 100 + rng.normal(0, 0.01, len(inputs))
    quiet = noise_floor(made_run(inputs, y))
    assert quiet.changed == 0
    y[-1] += 0.5
    found = noise_floor(made_run(inputs, y))
    assert found.changed == 1
    assert found.value == pytest.approx(quiet.value, rel=0.3)


def test_a_spread_that_differs_everywhere_is_kept():
    rng = np.random.default_rng(4)
    y = Preisach.from_surface(thesis_surface("one_e")).simulate(LOOPS) + rng.standard_t(2, len(LOOPS)) * 0.01
    found = noise_floor(made_run(LOOPS, y))
    assert found.changed == 0


@pytest.mark.parametrize("steps", [(1.0,) * 6, (1.0, 0.25) * 4])
def test_what_differs_between_rates_is_no_noise(steps):
    """An output that lags: the same state at another rate has another output, by far more than the noise."""
    ramps = [np.arange(25.0, 85.0, step) for step in steps]
    u = np.concatenate([part for up in ramps for part in (up, 110.0 - up)])
    y = RelayWire(3).strain(u)
    for k in range(1, y.size):
        y[k] = y[k - 1] + (y[k] - y[k - 1]) / 4
    floor = noise_floor(as_run("rates", u, y, dt=1.0, noise=(0.0, 0.004)))
    assert floor.n_pairs > 100
    assert floor.value == pytest.approx(0.004, rel=0.2)


@pytest.mark.parametrize("step", [0.05, 0.25, 0.5])
@pytest.mark.parametrize("noise", [0.0, 0.02, 0.3])
def test_readings_in_steps_have_at_least_the_noise_of_their_rounding(step, noise):
    y = Preisach.from_surface(thesis_surface("one_e")).simulate(LOOPS)
    y = np.round((y + noise * np.random.default_rng(5).standard_normal(y.size)) / step) * step
    output = {"quantity": "position", "unit": "mm", "per_count": step}
    floor, unrounded = noise_floor(made_run(LOOPS, y, output=output)), noise_floor(made_run(LOOPS, y))
    assert floor.value == pytest.approx(max(unrounded.value, step / np.sqrt(12)))
    assert floor.n_pairs == unrounded.n_pairs


def test_means_over_a_hold_lie_between_the_steps():
    output = {"quantity": "position", "unit": "mm", "per_count": 0.5}
    run = made_run(LOOPS, np.zeros(len(LOOPS)), output=output)
    means = replace(run, steps=tuple(replace(step, n=40) for step in run.steps))
    assert noise_floor(run).value == pytest.approx(0.5 / np.sqrt(12))
    assert noise_floor(means).value == 0

"""The choice of the next experiment: memory and cost of a plan, the posterior density, and the benefit of
choosing."""

import random
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.adaptive import ErrorTrace
from benchmarks.random_truths import random_truth
from smarig.cli import run as command_line
from smarig.core.command import Hold, Settled, StepResult, StepVerdict
from smarig.identification.adaptive import informed_choice
from smarig.identification.adaptive.memory_path import duration_s, path_after, paths_along, rows
from smarig.identification.adaptive.next_inputs import best_plan, observations
from smarig.identification.adaptive.surface_posterior import (
    density_amplitude,
    reading_noise_sd,
    surface_posterior,
)
from smarig.identification.positive import fit_positive
from smarig.identification.positive.triangle import Triangle
from smarig.preisach.operator import Preisach
from smarig.protocols._setup import Setup
from smarig.protocols.adaptive_fod import HoldResult, NextInputs, adaptive_fod, halving
from smarig.record import load_run
from smarig.replay.memory_history import memory_states
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

ONE = Setup.of("one_wire_twin")
ENDS = ONE.lower_K, ONE.upper_K
PER_COUNT = 2 * np.pi * 15 / 2000
LEVELS = [k * 174.1 / 12 for k in range(13)]


class Desk:
    """A wire without a clock: a truth, encoder noise of a settled mean, and holds that take their predicted time."""

    def __init__(self, truth, seed=0):
        self.operator, self.rng = Preisach(truth), np.random.default_rng(seed)
        self.t_s = self.u = 0.0
        self.inputs, self.counts = [], []

    def run(self, protocol):
        answer = None
        while True:
            try:
                command = protocol.send(answer)
            except StopIteration:
                return self
            answer = self._held(command) if isinstance(command, Hold) else None

    def _held(self, command):
        took_s = duration_s(ONE, command.until, self.u, command.target)
        self.u = command.target
        counts = self.operator.step(self.u) / PER_COUNT + 0.025 * self.rng.standard_normal()
        self.inputs.append(self.u)
        self.counts.append(counts)
        start_s, self.t_s = self.t_s, self.t_s + took_s
        index = len(self.inputs) - 1
        return StepResult(index, StepVerdict.SETTLED, counts, counts, 0.4, 250, start_s, self.t_s)

    def rms(self, truth):
        """Error of what ``positive`` makes of everything held, over a dense triangle, in the truth's unit."""
        paths = paths_along(ENDS[:1], tuple(self.inputs))
        fit = fit_positive(observations(paths, np.array(self.counts), ENDS), smoothing=1e-12)
        u = np.linspace(*ENDS, 61)
        high, low = np.tril_indices(61)
        error = PER_COUNT * fit.y(u[high], u[low]) - truth.y(u[high], u[low])
        return float(np.sqrt(np.mean(error**2)))


def seen_at(truth, inputs):
    """What a chooser is shown after noise-free holds."""
    y = Preisach(truth).simulate(inputs) / PER_COUNT
    return tuple(HoldResult(u, float(c), 0.4, 250, True) for u, c in zip(inputs, y))


def a_belief(inputs, intervals=12, density=None):
    triangle = Triangle(np.linspace(*ENDS, intervals + 1))
    paths = paths_along(ENDS[:1], tuple(inputs))
    change = Preisach(random_truth(1)).simulate(inputs) / PER_COUNT
    density = np.full(triangle.cells, 500.0) if density is None else density
    return surface_posterior(triangle, density, rows(triangle, paths), change, 0.025), paths


# --- memory, rows and cost ----------------------------------------------------------------------------------


@given(st.lists(st.sampled_from(LEVELS), min_size=1, max_size=40))
def test_a_planned_memory_is_the_operators_own(inputs):
    for path, state in zip(paths_along(ENDS[:1], tuple(inputs)), memory_states(inputs, *ENDS, "negative")):
        expected = (*state.extrema, state.u) if state.u != state.extrema[-1] else state.extrema
        assert path == tuple(expected)


@given(st.lists(st.sampled_from(LEVELS), min_size=1, max_size=20))
def test_rows_give_the_operators_output_along_any_history(inputs):
    truth = random_truth(3, cells=12)
    triangle = Triangle(truth.nodes)
    high, low = np.tril_indices(12)
    surface = np.append(truth.values[high + 1, low + 1], truth.y_lower)
    outputs = rows(triangle, paths_along(ENDS[:1], tuple(inputs))) @ surface
    assert outputs == pytest.approx(Preisach(truth).simulate(inputs), abs=1e-10)


def test_a_hold_takes_the_time_that_was_predicted():
    twin = Twin.named("one_wire_twin", seed=2)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 1.0, [CallbackListener(on_step=results.append)]
    )
    inputs = [174.1, 150.0, 60.0, 59.0, 100.0, 0.0]
    runner.run(Hold(ONE.current_for(u), Settled(), target=u) for u in inputs)
    took = [r.t_end_s - r.t_start_s for r in results]
    predicted = [duration_s(ONE, Settled(), a, b) for a, b in zip([0.0, *inputs], inputs)]
    assert took == pytest.approx(predicted, abs=4.0)
    assert max(took) > min(took) + 10, "or nothing was compared"


# --- what is believed ---------------------------------------------------------------------------------------


def test_the_posterior_is_narrow_only_where_something_was_measured():
    posterior, paths = a_belief([174.1, 116.0, 58.0, 0.0])
    x = rows(posterior.triangle, [*paths, *paths_along(paths[-1], (101.5,))])
    sd = np.sqrt(np.diag(x @ (x @ posterior.covariance).T))
    assert np.all(sd[:-1] < 2 * posterior.noise)
    assert sd[-1] > 20 * posterior.noise


def test_the_gain_of_a_plan_is_what_conditioning_on_all_its_holds_takes_off_the_mean_variance():
    posterior, paths = a_belief([174.1, 116.0, 58.0, 0.0])

    def dear_to_rise(a, b):  # so that a plan goes on once it is up
        return 60.0 if b > a else 5.0

    plan = best_plan(posterior, paths[-1], posterior.triangle.nodes, dear_to_rise)
    x = rows(posterior.triangle, paths_along(paths[-1], plan.inputs)).toarray()
    seen = x @ posterior.covariance @ x.T + posterior.noise**2 * np.eye(len(x))
    direct = np.trace(np.linalg.solve(seen, x @ posterior.shared_reduction @ x.T))
    assert len(plan.inputs) > 1
    assert plan.gain == pytest.approx(direct, rel=1e-6)


def test_no_plan_of_one_or_two_holds_beats_the_best_plan():
    posterior, paths = a_belief([174.1, 87.0, 0.0], intervals=8)
    levels = posterior.triangle.nodes
    cost = partial(duration_s, ONE, Settled())
    best = best_plan(posterior, paths[-1], levels, cost)
    rates = []
    for first in levels:
        for second in levels:
            if first == paths[-1][-1] or second == first:
                continue
            x = rows(posterior.triangle, paths_along(paths[-1], (float(first), float(second)))).toarray()
            seen = x @ posterior.covariance @ x.T + posterior.noise**2 * np.eye(2)
            gain = np.trace(np.linalg.solve(seen, x @ posterior.shared_reduction @ x.T))
            rates.append(gain / (cost(paths[-1][-1], first) + cost(first, second)))
    assert len(rates) == 64
    assert best.rate >= max(rates) * (1 - 1e-9)


def test_the_posterior_is_narrow_where_no_density_was_found():
    triangle = Triangle(np.linspace(*ENDS, 13))
    masses = np.where((triangle.i >= 8) & (triangle.j <= 3), 1.0, 0.0)
    found = density_amplitude(triangle, masses)
    inside, outside = (triangle.i == 10) & (triangle.j == 2), (triangle.i == 5) & (triangle.j == 4)
    assert found[inside] > 5 * found[outside]
    mean = masses.sum() / triangle.areas[triangle.i != triangle.j].sum()
    assert found[triangle.i != triangle.j].min() > 0.1 * mean, "exploration never ends"


def test_the_posterior_is_wide_where_the_density_is():
    triangle = Triangle(np.linspace(*ENDS, 13))
    high = triangle.j >= 6
    inputs = [174.1, 0.0]
    up, down = (a_belief(inputs, density=np.where(where, 900.0, 1.0))[0] for where in (high, ~high))
    x = rows(triangle, paths_along((0.0,), (145.0, 101.5, 0.0, 72.5, 29.0)))  # falls within β > 87, and below
    inside = np.array([x[1] - x[0], x[4] - x[3]], dtype=object)
    spread = [
        [float((d @ b.covariance @ d.T).item()) for d in (v.toarray() for v in inside)] for b in (up, down)
    ]
    assert spread[0][0] > 50 * spread[0][1]
    assert spread[1][1] > 50 * spread[1][0]


@pytest.mark.parametrize(("sd", "expected"), [(0.5, 0.5 / np.sqrt(250)), (0.0, 1 / np.sqrt(12))])
def test_the_noise_of_a_mean_is_its_scatter_or_a_whole_count_without_dither(sd, expected):
    assert reading_noise_sd([sd] * 3, [250] * 3) == pytest.approx(expected)


def test_the_predicted_error_shrinks_with_more_readings_and_is_of_the_true_size():
    truth = random_truth(2)
    few, many = (FOD_LIKE[:12], FOD_LIKE)
    predicted = [
        informed_choice(ONE, seen_at(truth, inputs), Settled()).predicted_share for inputs in (few, many)
    ]
    assert predicted[1] < predicted[0] / 2
    desk = Desk(truth)
    desk.run(Hold(0.0, Settled(), target=u) for u in many)
    assert 0.25 < predicted[1] * 12.54 / desk.rms(truth) < 4


FOD_LIKE = [0.0] + [u for k in (3, 6, 9, 12, 5, 8, 11) for u in [LEVELS[k], *LEVELS[k - 2 :: -3]]]


# --- the benchmark's parts ------------------------------------------------------------------------------------


@pytest.mark.parametrize("rig", ["one_wire_twin", "two_wire_twin"])
def test_random_truths_are_positive_measures_over_the_rigs_ranges_and_all_different(rig):
    truths = [random_truth(seed, rig) for seed in range(5)]
    setup = Setup.of(rig)
    for truth in truths:
        filled = np.where(np.isnan(truth.values), 0.0, truth.values - truth.y_lower)
        masses = np.tril(np.diff(np.diff(filled, axis=0), axis=1), -1)
        assert masses.min() > -1e-9
        assert np.all(np.diagonal(filled, 0)[1:] > np.diagonal(filled, -1)), "a reversible part everywhere"
        assert (truth.lower, truth.upper) == (setup.lower_K, setup.upper_K)
    span = [t.everett(t.upper, t.lower) for t in truths]
    assert span == pytest.approx([span[0]] * 5)
    assert len({round(float(np.nanmean(t.values)), 6) for t in truths}) == 5


def test_an_error_is_reached_once_or_for_good():
    trace = ErrorTrace((0.1, 0.2, 0.3, 0.4), (0.5, 0.1, 0.3, 0.2))
    assert [trace.stays_h(rms) for rms in (0.6, 0.35, 0.25, 0.15)] == [0.1, 0.2, 0.4, None]
    assert [trace.first_h(rms) for rms in (0.6, 0.35, 0.15, 0.05)] == [0.1, 0.2, 0.2, None]


# --- the chooser ----------------------------------------------------------------------------------------------


def test_the_same_results_lead_to_the_same_choice_inside_the_range():
    seen = seen_at(random_truth(4), FOD_LIKE[:15])
    first, again = (informed_choice(ONE, seen, Settled()) for _ in range(2))
    assert first == again
    assert first.inputs_K
    assert all(ENDS[0] <= u <= ENDS[1] for u in first.inputs_K)


def test_an_unsettled_reading_changes_the_memory_and_is_not_used():
    seen = list(seen_at(random_truth(4), FOD_LIKE[:15]))
    late = [
        HoldResult(s.input_K, s.counts + off, 0.4, 250, False) for s, off in ((seen[9], 0), (seen[9], 500))
    ]
    choices = [informed_choice(ONE, (*seen[:9], one, *seen[10:]), Settled()) for one in late]
    assert choices[0] == choices[1]
    wrong = HoldResult(seen[9].input_K, seen[9].counts + 500, 0.4, 250, True)
    assert informed_choice(ONE, (*seen[:9], wrong, *seen[10:]), Settled()) != choices[0]


@pytest.mark.parametrize("seed", range(6))
def test_it_always_returns_a_choice_whatever_the_readings(seed):
    """Wrong readings, repeated holds, a wire that jumps: an overnight run must not end in a traceback."""
    rng = np.random.default_rng(seed)
    inputs = [*ENDS, *rng.choice(LEVELS, int(rng.integers(1, 40))).tolist()]
    said = [rng.normal(0, 100, len(inputs)), np.array(inputs) > 60, np.round(np.array(inputs) / 40)][seed % 3]
    seen = tuple(
        HoldResult(u, float(y), float(sd), 250, bool(ok))
        for u, y, sd, ok in zip(
            inputs, said, rng.choice([0.0, 0.4, 9.0], len(said)), rng.random(len(said)) > 0.2
        )
    )
    choice = informed_choice(ONE, seen, Settled())
    assert all(ENDS[0] <= u <= ENDS[1] for u in choice.inputs_K)
    assert choice.predicted_share > 0 or not choice.inputs_K


def test_before_anything_has_settled_it_chooses_both_saturations_again():
    late = tuple(HoldResult(u, 5.0, 0.4, 250, False) for u in ENDS)
    assert informed_choice(ONE, late, Settled()).inputs_K == ENDS


def test_a_wire_that_does_not_move_ends_the_experiment():
    still = tuple(HoldResult(u, 5.0, 0.0, 250, True) for u in (*ENDS, 50.0))
    assert informed_choice(ONE, still, Settled()) == NextInputs(())


@pytest.mark.long
def test_choosing_pays_against_chance_and_against_a_fixed_order():
    truth = random_truth(2)
    dice = random.Random(1)

    def by_chance(setup, seen, settle):
        return NextInputs(tuple(dice.choice(LEVELS) for _ in range(4)))

    rms = {}
    for chooser in (informed_choice, by_chance, halving):
        desk = Desk(truth).run(adaptive_fod(ONE, chooser, target_share=1e-6, longest_h=0.4))
        rms[chooser] = desk.rms(truth)
    assert rms[informed_choice] < 0.6 * rms[by_chance]
    assert rms[informed_choice] < 0.6 * rms[halving]


def test_it_stops_earlier_at_a_larger_target_error():
    truth = random_truth(2)
    held = [
        len(Desk(truth).run(adaptive_fod(ONE, informed_choice, target_share=t)).inputs) for t in (0.1, 0.02)
    ]
    assert 2 < held[0] < held[1] < 60


@pytest.mark.long("takes three seconds")
def test_the_command_line_hands_the_informed_chooser_over_and_a_seed_fixes_all(tmp_path):
    runs = []
    for k in range(2):
        out = tmp_path / f"{k}.run.sqlite"
        told = ["run", "adaptive_fod", "--rig", "one_wire_twin", "-o", str(out), "--set", "longest_h=0.12"]
        assert command_line([*told, "--seed", "3", "--quiet"]) == 0
        runs.append(load_run(out))
    assert [s.target for s in runs[0].steps] == [s.target for s in runs[1].steps]
    assert [e.data["chooser"] for e in runs[0].events if "chooser" in e.data] == ["informed"]
    assert 0.12 <= runs[0].steps[-1].t_end_s / 3600 < 0.15


def test_two_wires_are_explored_from_their_own_negative_saturation():
    setup = Setup.of("two_wire_twin")
    twin = Twin.named("two_wire_twin", seed=1)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 1.0, [CallbackListener(on_step=results.append)]
    )
    runner.run(adaptive_fod(setup, informed_choice, longest_h=0.2))
    assert len(results) > 7
    assert all(r.verdict is StepVerdict.SETTLED for r in results)


def test_moves_along_a_rising_branch_leave_no_extremum():
    assert path_after(path_after((0.0,), 50.0), 80.0) == (0.0, 80.0)

"""The parts of the comparison of measured records: memory, density, Gaussian fit, records, what varies together."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.diagnosis.comparison import gaussian_fit
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.gaussian_fit import LEVEL, fit_gaussian
from smarig.diagnosis.comparison.measured import plain_variables
from smarig.diagnosis.comparison.measured.memory_features import MemoryGrid
from smarig.diagnosis.comparison.measured.plain_variables import Surface, variable_parts
from smarig.diagnosis.comparison.measured.positive_prior import positive_prior
from smarig.diagnosis.comparison.measured.reading_problem import reading_problem
from smarig.diagnosis.comparison.measured.varied_together import at_one_rate, between_runs, confounded
from smarig.diagnosis.comparison.measured.wire_records import (
    WireRecord,
    quiet_input,
    wire_records,
)
from smarig.measurement import input_records
from smarig.preisach import turning_points

PEAKS = (88.0, 62.0, 80.0, 58.0, 85.0, 66.0, 75.0, 60.0, 82.0, 70.0, 78.0)


def relays_up(u, up, down, hot):
    for x in u:
        hot = (x > up) | (hot & (x >= down))
    return hot


@pytest.mark.parametrize("up_at_start", [False, True])
def test_features_are_the_shares_of_each_cell_that_are_up(up_at_start):
    rng = np.random.default_rng(3)
    grid = MemoryGrid(cells=6)
    u = np.r_[float(up_at_start), rng.uniform(0, 1, 40)]
    features = grid.features(u, np.array([0, 7, 25, 40]), up=up_at_start)
    i, j = grid.pairs
    up = (i[:, None] + rng.uniform(0, 1, 4000)) / 6
    down = (j[:, None] + rng.uniform(0, 1, 4000)) / 6
    for row, n in enumerate((0, 7, 25, 40)):
        hot = relays_up(u[: n + 1], up, down, np.full(up.shape, up_at_start))
        assert features[row, : i.size] == pytest.approx(hot.mean(axis=1), abs=0.04)


def test_nearly_equal_reversals_change_the_features_by_as_little():
    grid = MemoryGrid()
    a, b = np.array([0.0, 0.8, 0.3, 0.80001, 0.5]), np.array([0.0, 0.8, 0.3, 0.79999, 0.5])
    change = grid.features(a, np.array([4]), up=False) - grid.features(b, np.array([4]), up=False)
    assert np.abs(change).max() < 1e-3


def test_the_gradient_of_the_evidence_is_that_of_finite_differences():
    rng = np.random.default_rng(0)
    parts = [a @ a.T for a in rng.standard_normal((2, 9, 9))]
    stack, y, x = np.array(parts).reshape(2, -1), rng.standard_normal(9), np.array([-1.0, 0.3, -2.0])
    _, gradient = gaussian_fit._misfit(x, y, stack)
    for k in range(3):
        step = 1e-5 * np.eye(3)[k]
        slope = (
            gaussian_fit._misfit(x + step, y, stack)[0] - gaussian_fit._misfit(x - step, y, stack)[0]
        ) / 2e-5
        assert gradient[k] == pytest.approx(slope, rel=1e-5)


def test_sizes_are_those_of_the_largest_evidence():
    from scipy.stats import multivariate_normal

    rng = np.random.default_rng(1)
    z = np.linspace(0, 1, 60)
    k = np.exp(-0.5 * ((z[:, None] - z) / 0.1) ** 2)
    y = rng.multivariate_normal(np.zeros(60), 0.5 * k + 0.01 * np.eye(60))
    fit = fit_gaussian(y, [k], [np.arange(30), np.arange(30, 60)], np.array([0.1, 0.1]), 60)

    def evidence(a, b):
        return multivariate_normal(cov=LEVEL + a * k + b * np.eye(60)).logpdf(y)

    best = evidence(*fit.sizes)
    assert all(best > evidence(*(fit.sizes * f)) for f in ((3, 1), (0.3, 1), (1, 1.7), (1, 0.6)))
    assert fit.noise == pytest.approx(0.1, rel=0.3)


def split_run(dt=1.0):
    u = triangles(PEAKS, rows=20)
    run = as_run("a", u, RelayWire(1).strain(u), dt=dt)
    [record] = input_records([run])
    return [WireRecord(record, np.arange(len(record)) >= 200, np.ones(len(record), dtype=bool))]


def test_a_run_that_continues_is_one_record_with_held_out_rows(monkeypatch):
    u = triangles(PEAKS, rows=20)
    runs = [as_run("a", u, u, dt=1.0), as_run("b", u, u, dt=1.0)]
    first, second = input_records(runs)
    where = "smarig.diagnosis.comparison.measured.wire_records.input_records"

    def records(asked):
        return [first, replace(second, continues=True)][: len(asked)]

    monkeypatch.setattr(where, records)
    [wire] = wire_records(runs[:1], runs[1:])
    assert wire.held_out.sum() == len(second)
    assert np.all(np.diff(wire.record.t) > 0)  # the clock that starts again goes on


@pytest.mark.parametrize(("pause_s", "records"), [(1.0, 1), (50.0, 2)])
def test_a_record_that_was_cut_into_two_files_is_one(monkeypatch, pause_s, records):
    u = triangles(PEAKS, rows=20)
    first, second = input_records([as_run("a", u, u, dt=1.0), as_run("b", u, u, dt=1.0)])
    second = replace(second, t=second.t + first.t[-1] + pause_s)
    where = "smarig.diagnosis.comparison.measured.wire_records.input_records"
    monkeypatch.setattr(where, lambda _: [first, second])
    assert len(wire_records([None, None], [])) == records


def test_time_in_one_run_tells_nothing_of_another():
    """A clock that starts again says where in the programme a reading is, and a repeat would predict its twin."""
    u = triangles(PEAKS, rows=20)
    problem = reading_problem(wire_records([as_run(n, u, RelayWire(1).strain(u), dt=1.0) for n in "ab"], []))
    level = np.zeros(problem.y.size)
    covariance = variable_parts(problem, "time", Surface(level, level))[0]
    same = problem.record[:, None] == problem.record
    assert covariance[~same].max() < 0.2 * covariance[same].max()


def test_blocks_hold_no_training_and_held_out_readings_at_once():
    problem = reading_problem(split_run())
    for b in np.unique(problem.block):
        assert np.unique(problem.train[problem.block == b]).size == 1
    assert problem.excursions + problem.held_excursions == pytest.approx(len(PEAKS), abs=1)
    assert all(not problem.train[rows].any() for rows in problem.with_unseen().unseen)


def test_a_positive_density_fits_a_wire_to_its_noise():
    problem = reading_problem(split_run())
    prior = positive_prior(problem, [r.u for r in problem.records], problem.y)
    assert (prior.relays.density >= 0).all()
    left = problem.y - prior.relays.features @ prior.relays.density
    assert np.std(left) < 0.02


def test_noise_of_the_input_is_smoothed_and_its_turns_stay():
    u = triangles(PEAKS, rows=200)
    noisy = u + np.random.default_rng(0).normal(0, 0.8, u.size)
    assert np.std(quiet_input(noisy) - u) < 0.5 * np.std(noisy - u)
    assert len(turning_points(quiet_input(noisy), 5.0)) == len(turning_points(u, 5.0))
    assert quiet_input(u) is u


def runs_at(rates, stresses=None):
    u = triangles(PEAKS[:4], rows=40)
    stresses = stresses or [None] * len(rates)
    return [
        as_run(f"run {k}", u, RelayWire(1).strain(u), dt=1 / r, stress=s)
        for k, (r, s) in enumerate(zip(rates, stresses))
    ]


def test_rate_and_stress_that_change_between_runs_only_cannot_be_parted():
    lag, stress = Part("effect", "input_lag"), Part("effect", "stress_shift")
    problem = reading_problem(wire_records(runs_at((0.1, 10.0), (50.0, 150.0)), ()))
    assert {"rate", "stress", "run"} <= between_runs(problem)
    offset = Part("effect", "input_offset")
    found = confounded(problem, [lag, stress])
    assert found[lag] == (stress, offset)
    assert found[stress] == (lag, offset)
    assert found[offset] == (lag, stress)


@pytest.mark.parametrize(
    ("stresses", "parted"),
    [
        ((100.0, 150.0), False),
        ((100.0, 100.0, 150.0), False),
        ((100.0, 150.0, 100.0), True),
        ((50.0, 100.0, 150.0), True),
    ],
)
def test_an_offset_between_two_loads_does_what_the_load_does(stresses, parted):
    stress, offset = Part("effect", "stress_shift"), Part("effect", "input_offset")
    problem = reading_problem(wire_records(runs_at((1.0,) * len(stresses), stresses), ()))
    assert (offset not in confounded(problem, [stress]).get(stress, ())) is parted


@pytest.mark.parametrize(("held_out", "parted"), [(150.0, False), (200.0, True), (100.0, True)])
def test_a_held_out_load_parts_them(held_out, parted):
    stress, offset = Part("effect", "stress_shift"), Part("effect", "input_offset")
    *train, other = runs_at((1.0,) * 3, (100.0, 150.0, held_out))
    problem = reading_problem(wire_records(train, [other]))
    assert (offset not in confounded(problem, [stress]).get(stress, ())) is parted


@pytest.mark.parametrize(
    ("rows", "parted"), [((20, 40, 60, 80, 100, 120), False), ((20, 120, 40, 100, 60, 80), True)]
)
def test_a_rate_that_falls_all_the_time_cannot_be_parted_from_time(rows, parted):
    drift, rate = Part("effect", "input_drift"), Part("variable", "rate")
    u = triangles((85.0,) * len(rows), rows=list(rows))
    problem = reading_problem(wire_records([as_run("a", u, RelayWire(1).strain(u), dt=1.0)], ()))
    found = confounded(problem, [drift, rate])
    assert (found == {}) is parted
    if not parted:
        assert (found[drift], found[rate]) == ((rate,), (drift,))


def test_at_one_rate_a_lag_is_a_part_of_every_loop():
    even = triangles((85.0,) * 5, rows=40)
    uneven = triangles((85.0,) * 5, rows=[20, 80, 30, 100, 40])
    for u, expected in ((even, True), (uneven, False)):
        runs = [as_run("a", u, RelayWire(1).strain(u), dt=1.0)]
        assert at_one_rate(reading_problem(wire_records(runs, ()))) is expected


HELD = np.repeat(
    np.arange(119), np.where(np.arange(119) % 40 == 30, 25, 1)
)  # rows of a path, some of them held


@pytest.mark.parametrize(
    ("rows", "held", "parted"),
    [([20, 20, 20], False, False), ([20, 60, 30], False, True), ([20, 20, 20], True, True)],
)
def test_at_one_rate_without_holds_the_time_since_a_reversal_is_the_distance_from_it(rows, held, parted):
    u = triangles((85.0,) * 3, rows=rows)
    u = u[HELD[u.size > HELD]] if held else u
    problem = reading_problem(wire_records([as_run("a", u, RelayWire(1).strain(u), dt=4.0)], ()))
    assert ("time_since_reversal" in plain_variables.testable_variables(problem)) is parted

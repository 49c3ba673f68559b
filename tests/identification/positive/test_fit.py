"""The positive identification: non-negative, convergent, unique where the data determine it, with correct
intervals."""

import numpy as np
import pytest

from benchmarks.random_truths import random_truth
from identification.made_runs import PARTITION, driven_run, fod_inputs, made_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.fod_data import fod_data
from smarig.identification.positive import Observations, fit_positive
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach


def points(truth, levels, noise=0.0, seed=0):
    """FOD points of a truth on a partition."""
    i, j = np.tril_indices(levels.size)
    alpha, beta = levels[i], levels[j]
    y = truth.y(alpha, beta) + noise * np.random.default_rng(seed).standard_normal(alpha.size)
    return Observations.of_points(alpha, beta, y, i.astype(np.int64), (levels[0], levels[-1]), "mm")


def dense(truth, n=46):
    u = np.linspace(truth.lower, truth.upper, n)
    i, j = np.tril_indices(n)
    return u[i], u[j], truth.y(u[i], u[j])


def rms(fit, truth):
    alpha, beta, y = dense(truth)
    return float(np.sqrt(np.mean((fit.y(alpha, beta) - y) ** 2)))


@pytest.fixture(scope="module")
def noisy():
    truth = thesis_surface("one_e")
    return truth, fit_positive(points(truth, np.array(PARTITION["one"]), noise=0.019), intervals=30)


def test_no_mass_is_negative_although_the_truths_are(noisy):
    truth, fit = noisy
    assert truth.density(*dense(truth)[:2]).min() < 0
    assert fit.masses.min() >= 0
    assert fit.at_zero > 0
    F = fit.table.values
    cells = F[1:, 1:] - F[1:, :-1] - F[:-1, 1:] + F[:-1, :-1]
    assert np.nanmin(cells) > -1e-12 * (F[-1, -1] - F[0, 0])


def test_finer_triangles_converge():
    truth = thesis_surface("two_c")
    observations = points(truth, np.array(PARTITION["two"]))
    fits = [fit_positive(observations, intervals=n, smoothing=1e-11) for n in (12, 24, 48)]
    alpha, beta, _ = dense(truth)
    outputs = [fit.y(alpha, beta) for fit in fits]
    first, second = (float(np.sqrt(np.mean((b - a) ** 2))) for a, b in zip(outputs, outputs[1:]))
    assert second < 0.5 * first
    assert rms(fits[2], truth) < rms(fits[0], truth)


def test_more_data_converges_to_the_truth():
    truth = random_truth(2)
    errors = [
        rms(fit_positive(points(truth, np.linspace(0, truth.upper, n)), intervals=40, smoothing=1e-13), truth)
        for n in (6, 11, 21)
    ]
    assert errors[2] < 0.6 * errors[1] < 0.6 * 0.6 * errors[0]


def test_the_solution_is_one_whatever_the_order_of_the_data(noisy):
    truth, fit = noisy
    observations = points(truth, np.array(PARTITION["one"]), noise=0.019)
    order = np.random.default_rng(0).permutation(len(observations))
    shuffled = Observations.of_points(
        observations.alpha[order],
        observations.beta[order],
        observations.y[order],
        observations.curve[order],
        (observations.lower, observations.upper),
        "mm",
    )
    again = fit_positive(shuffled, nodes=fit.triangle.nodes, smoothing=fit.smoothing)
    assert np.abs(again.masses - fit.masses).max() < 1e-4 * fit.masses.max()


def test_what_the_data_leaves_open_is_counted():
    truth = thesis_surface("one_c")
    levels = np.linspace(0, truth.upper, 11)
    nodes = levels
    whole = points(truth, levels)
    without = whole.where(whole.curve != 6)
    full = fit_positive(whole, nodes=nodes, smoothing=1e-12)
    less = fit_positive(without, nodes=nodes, smoothing=1e-12)
    # On the data's own partition all is fixed; a missing curve leaves as many directions as it had points.
    assert full.null_space == 0
    assert less.null_space == np.sum(whole.curve == 6) - 1, "its end at saturation is every curve's"
    assert fit_positive(whole, intervals=40, smoothing=1e-12).null_space > 500


def test_held_out_curves_choose_nearly_the_best_smoothing(noisy):
    truth, chosen = noisy
    observations = points(truth, np.array(PARTITION["one"]), noise=0.019)
    best = min(
        rms(fit_positive(observations, intervals=30, smoothing=10.0**e), truth)
        for e in (-16, -14, -13, -12, -11, -9)
    )
    assert rms(chosen, truth) < 1.35 * best
    errors = list(chosen.by_smoothing.values())
    assert len(errors) >= 3
    assert min(errors) < 0.9 * max(errors)


@pytest.mark.long("takes two seconds")
def test_intervals_cover_the_truth_and_grow_where_nothing_was_measured():
    inside, nominal = [], 0.9
    for seed in range(6):
        truth = random_truth(seed)
        fit = fit_positive(points(truth, np.array(PARTITION["one"]), noise=0.019, seed=seed), intervals=30)
        alpha, beta, y = dense(truth)
        noise = 0.019 * np.random.default_rng(100 + seed).standard_normal(y.size)
        low, high = fit.interval(alpha, beta, nominal)
        inside.append(float(np.mean((low <= y + noise) & (y + noise <= high))))
    assert 0.8 < np.mean(inside) < 0.99
    levels = np.array(PARTITION["one"])
    observations = points(thesis_surface("one_c"), levels, noise=0.019)
    gap = fit_positive(
        observations.where((observations.curve < 4) | (observations.curve > 7)), nodes=levels, smoothing=1e-11
    )
    full = fit_positive(observations, nodes=levels, smoothing=1e-11)
    at = (levels[6], levels[3])
    assert gap.sd(*at) / (gap.sigma * gap.held_out.spread_factor) > 1.5 * full.sd(*at) / (
        full.sigma * full.held_out.spread_factor
    )


def test_any_run_will_do_loops_and_ladders_without_one_first_order_curve():
    truth = thesis_surface("one_c")
    rng = np.random.default_rng(3)
    u = np.concatenate([[0.0], rng.uniform(0, truth.upper, 160), [truth.upper, 0.0]])
    u[1::2], u[2::2] = np.maximum(u[1::2], u[2::2]), np.minimum(u[1::2], u[2::2])
    y = Preisach(truth).simulate(u) + 0.005 * rng.standard_normal(u.size)
    run = made_run(u, y)
    fit = fit_positive(Observations.of_runs([run]))
    assert len(fod_data([run])) < 40
    assert rms(fit, truth) < 0.02 * 12.54
    test = np.concatenate([[0.0], rng.uniform(0, truth.upper, 60)])
    predicted, true = Preisach(fit.table).simulate(test), Preisach(truth).simulate(test)
    assert np.sqrt(np.mean((predicted - true) ** 2)) < 0.01 * 12.54


def test_symmetry_is_kept_when_requested():
    levels = np.array(PARTITION["two"])
    observations = points(thesis_surface("two_c"), levels)
    centred = Observations.of_points(
        observations.alpha,
        observations.beta,
        observations.y - 0.5 * (observations.y.max() + observations.y.min()),
        observations.curve,
        (-185.0, 185.0),
    )
    nodes = np.linspace(-185, 185, 25)
    lopsided = fit_positive(centred, nodes=nodes, smoothing=1e-11)
    fit = fit_positive(centred, nodes=nodes, smoothing=1e-11, symmetric=True)

    def skew(found):
        grid = np.zeros((24, 24))
        grid[found.triangle.i, found.triangle.j] = found.masses
        return np.abs(grid - grid[::-1, ::-1].T).max() / grid.max()

    assert skew(fit) < 1e-4
    assert skew(lopsided) > 0.05


def test_the_cost_of_non_negativity_is_reported():
    costly, free = (
        fit_positive(points(thesis_surface(name), np.linspace(0, 174.1, 41)), smoothing=1e-14).held_out
        for name in ("one_p", "one_c")
    )
    assert costly.rms > 1.5 * costly.signed_rms
    assert free.rms < 1.2 * free.signed_rms


def test_little_or_no_data_is_refused_in_a_sentence():
    observations = points(thesis_surface("one_c"), np.array(PARTITION["one"]))
    with pytest.raises(DataError, match="Give at least three"):
        fit_positive(observations.where(np.arange(len(observations)) < 2))
    still = Observations.of_points(
        observations.alpha, observations.beta, 0 * observations.y, observations.curve, (0.0, 174.1)
    )
    with pytest.raises(DataError, match="no motion to identify"):
        fit_positive(still)
    with pytest.raises(UsageError, match="positive number"):
        fit_positive(observations, smoothing=-1.0)
    few = fit_positive(observations.where(observations.curve < 3), intervals=20)
    assert few.by_smoothing == {}, "three curves are too few to hold any out"


def test_a_run_of_the_worst_bench_is_within_a_count_of_the_truth():
    truth = thesis_surface("one_e")
    fit = fit_positive(Observations.of_runs([driven_run("one_e", fod_inputs(PARTITION["one"]), seed=2)]))
    assert rms(fit, truth) < 0.075
    assert "65" in repr(fit) or "66" in repr(fit) or "points" in repr(fit)

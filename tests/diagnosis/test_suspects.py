"""Readings that look like outliers of noise are found and set aside; with correct data none are."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from smarig.diagnosis.refit.nuisance_terms import SETS_TRIED, _gains, likeliest_nuisance
from smarig.diagnosis.refit.variance_components import START, ReadingCovariance

N = 120
LOW, HIGH = np.array([-6.0, -6.0, -9.0, -5.0, -5.0, -3.0]), np.array([2.0, 2.0, 0.0, -1.0, -1.0, 0.0])


@pytest.fixture
def made():
    """Readings with white noise and an ambient fluctuation whose memory is a random walk; traces that may be
    wrong."""
    rng = np.random.default_rng(5)
    walk = np.minimum.outer(np.arange(N), np.arange(N)) / N
    smooth = [np.cos(np.pi * k * np.arange(N) / N)[:, None] for k in (1, 2, 3)]
    steps = [np.where(np.arange(N) < k, 0.0, 1.0)[:, None] for k in (30, 60, 90)]
    noise = 1e-3 * rng.standard_normal(N) + 0.05 * np.linalg.cholesky(
        walk + 1e-12 * np.eye(N)
    ) @ rng.standard_normal(N)

    return lambda more: positions(noise + more), walk, [*smooth, *steps]


def positions(y):
    """Readings with no density at all."""
    zeros, n = np.zeros((y.size, y.size)), y.size
    return ReadingCovariance(
        y, (zeros, zeros, zeros), zeros, np.full(n, 1e-4), np.zeros(n), np.ones(n), (LOW, HIGH)
    )


def test_what_is_wrong_is_set_aside(made):
    reading_covariance, walk, sets = made
    one = reading_covariance(0.6 * sets[4][:, 0])
    found = one.likeliest(walk, START)
    aside = likeliest_nuisance(one, walk, found, sets)
    assert aside is sets[4]
    assert 10 ** one.likeliest(walk, START, aside)[1][-1] < 0.8 * 10 ** found[1][-1]


def test_nothing_is_set_aside_where_nothing_is_wrong(made):
    reading_covariance, walk, sets = made
    one = reading_covariance(0.0)
    assert likeliest_nuisance(one, walk, one.likeliest(walk, START), sets) is None


def test_a_gain_is_how_much_likelier_readings_are_when_a_trace_may_be_in_them():
    rng = np.random.default_rng(8)
    root, y = rng.standard_normal((40, 40)), 2.0 * rng.standard_normal(40)
    C = root @ root.T / 40 + 0.3 * np.eye(40)
    sets = [rng.standard_normal((40, k)) for k in (1, 1, 2, 5)] + [0.7 * y[:, None]]

    def log_density(C):
        return multivariate_normal(np.zeros(40), C).logpdf(y)

    gains = [log_density(C + T @ T.T) - log_density(C) for T in sets]
    assert min(gains) < 0 < max(gains)
    np.testing.assert_allclose(_gains(positions(y), C, sets), gains, rtol=1e-9)


def worth(reading_covariance, sets):
    """Nats for each set in turn, at the spreads that are likeliest with nothing aside and with everything."""
    calm = np.zeros((reading_covariance.y.size, reading_covariance.y.size))
    found = reading_covariance.likeliest(calm, START)
    everything = reading_covariance.likeliest(calm, START, np.column_stack(sets))[1]
    gains = [
        _gains(reading_covariance, reading_covariance.covariance(calm, at), sets)
        for at in (found[1], everything)
    ]
    return calm, found, *gains


def test_what_passes_for_noise_is_found_though_similar_sets_look_likelier_in_that_noise():
    rng = np.random.default_rng(0)
    wrong = 0.002 * rng.standard_normal((60, 1))
    likes = [5 * wrong + 0.002 * rng.standard_normal((60, 1)) for _ in range(SETS_TRIED)]
    one = positions(6.0 * wrong[:, 0] + 2e-4 * rng.standard_normal(60))
    calm, found, plain, bare = worth(one, [*likes, wrong])
    assert np.argmin(plain) == SETS_TRIED
    assert np.argmax(bare) == SETS_TRIED
    assert likeliest_nuisance(one, calm, found, [*likes, wrong]) is wrong


def test_what_is_wrong_is_found_though_all_suspects_at_once_leave_no_noise_at_all():
    """Where no noise is left, who has many traces explains most."""
    rng = np.random.default_rng(0)
    wrong = 0.02 * np.where(np.arange(60) < 30, -1.0, 1.0)[:, None]
    many = [0.01 * rng.standard_normal((60, 45)) for _ in range(SETS_TRIED)]
    one = positions(0.5 * wrong[:, 0] + 0.01 * rng.standard_normal(60))
    calm, found, plain, bare = worth(one, [*many, wrong])
    assert np.argmax(plain) == SETS_TRIED
    assert np.argmin(bare) == SETS_TRIED
    assert likeliest_nuisance(one, calm, found, [*many, wrong]) is wrong

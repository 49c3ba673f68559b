"""Variance components of maximum likelihood: a normal likelihood with correct derivatives, and a search that
converges."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.diagnosis.refit.variance_components import START, ReadingCovariance

N = 30
LOG_COMPONENTS = np.array([-0.4, -0.9, -1.1, -0.8, -0.5, -0.6])
LOG_MIN_FLUCTUATION, LOG_MAX_FLUCTUATION = -3.0, np.log10(0.4)
BOUNDS = (
    np.array([-6.0, -6.0, -9.0, -5.0, -5.0, LOG_MIN_FLUCTUATION]),
    np.array([2.0, 2.0, 0.0, -1.0, -1.0, LOG_MAX_FLUCTUATION]),
)


def some_covariance(rng):
    root = rng.standard_normal((N, N))
    return root @ root.T / N


@pytest.fixture
def mixed():
    """Positions, some of them on their way, and resistances, and what is remembered of draughts."""
    rng = np.random.default_rng(3)
    white = np.where(np.arange(N) < 20, 0.05, 1.0)
    zeros = np.where((white < 1.0)[:, None] == (white < 1.0), 4.0, 0.0)
    reading_covariance = ReadingCovariance(
        rng.standard_normal(N),
        tuple(some_covariance(rng) for _ in range(3)),
        zeros,
        white,
        ((np.arange(N) >= 12) & (np.arange(N) < 20)).astype(float),
        rng.uniform(0.5, 2.0, N),
        BOUNDS,
    )
    return reading_covariance, some_covariance(rng)


def test_the_cost_is_minus_the_log_density_of_a_normal_with_all_that_readings_spread_by(mixed):
    from scipy.stats import multivariate_normal

    reading_covariance, memory = mixed
    *weights, s_m, s0, s_T = 10.0**LOG_COMPONENTS
    outputs = sum(w * shape for w, shape in zip(weights, reading_covariance.shapes)) + s_T**2 * memory
    own = [0.05**2 + s0**2] * 12 + [0.05**2 + s0**2 + s_m**2] * 8 + [1.0] * 10
    C = (
        np.diag(reading_covariance.slope) @ outputs @ np.diag(reading_covariance.slope)
        + reading_covariance.free
        + np.diag(own)
    )
    log_density = multivariate_normal(np.zeros(N), C).logpdf(reading_covariance.y)
    assert reading_covariance.cost(memory, LOG_COMPONENTS) == pytest.approx(
        -log_density - N / 2 * np.log(2 * np.pi), rel=1e-9
    )
    np.testing.assert_allclose(reading_covariance.covariance(memory, LOG_COMPONENTS), C, rtol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_its_slopes_are_those_of_finite_differences(mixed, shift):
    reading_covariance, memory = mixed
    x = LOG_COMPONENTS + shift
    slopes = reading_covariance._cost(x, reading_covariance._parts(memory), reading_covariance.free)[1]
    by_differences = [
        (reading_covariance.cost(memory, x + d) - reading_covariance.cost(memory, x - d)) / 2e-4
        for d in 1e-4 * np.eye(x.size)
    ]
    assert np.abs(slopes).min() > 1e-3
    np.testing.assert_allclose(slopes, by_differences, rtol=1e-4, atol=1e-5)


PLACE = np.linspace(0.0, 1.0, 80)
APART = np.abs(PLACE[:, None] - PLACE)


def smooth(length):
    return np.exp(-0.5 * (APART / length) ** 2)


def rough(length):
    return np.exp(-APART / length)


def drawn(shape, memory, log_components, seed):
    """Positions by such spreads, and the cost of these."""
    none, n = np.zeros_like(APART), PLACE.size
    blank = ReadingCovariance(
        np.zeros(n), (shape, none, none), none, np.full(n, 1e-4), np.zeros(n), np.ones(n), BOUNDS
    )
    C = blank.covariance(memory, np.array(log_components))
    y = np.linalg.cholesky(C) @ np.random.default_rng(seed).standard_normal(n)
    reading_covariance = replace(blank, y=y)
    return reading_covariance, reading_covariance.cost(memory, np.array(log_components))


@pytest.mark.parametrize("seed", range(4))
def test_ambient_fluctuation_is_found_from_still_air_though_a_rough_density_mimics_it(seed):
    memory = 5.0 * rough(0.015)
    reading_covariance, cost = drawn(7.0 * rough(0.2), memory, [-1.5, -6.0, -9.0, -4.0, -3.5, -0.5], seed)
    found, log_components = reading_covariance.likeliest(memory, np.append(START[:-1], LOG_MIN_FLUCTUATION))
    assert found < cost + 0.5
    assert abs(log_components[-1] + 0.5) < 0.2


@pytest.mark.parametrize("seed", range(4))
def test_still_air_is_found_from_a_fluctuating_start_though_fluctuation_mimics_noise(seed):
    memory = 0.7 * smooth(0.015)
    reading_covariance, cost = drawn(0.2 * smooth(0.1), memory, [1.2, -6.0, -9.0, -4.0, -2.1, -2.5], seed)
    found, log_components = reading_covariance.likeliest(
        memory, np.array([-6.0, -6.0, -9.0, -4.0, -3.7, LOG_MAX_FLUCTUATION])
    )
    assert found < cost + 0.5
    assert log_components[-1] < -1.8

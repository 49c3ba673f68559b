"""Null data: their noise equals the refitted noise, and the hysteresis stores its temperature part."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.critique.critique import null_data

from diagnosis.made_memories import prediction_for_inputs
from smarig.diagnosis.refit.memory_noise import memory_covariance, memory_slopes
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.replay import PlantModel

WIRE = thesis_surface("one_e")
ACTUATOR: Any = None
CORRELATION_S = 60.0
DRAWS = 600
RISING, T_S = np.linspace(60.0, 90.0, 8), np.array([10.0, 20.0, 25.0, 60.0, 70.0, 160.0, 170.0, 400.0])


def drawn(prediction, temperature_K=0.0, white=0.0, fitted=0.0, scale=None, factor=None, seed=1):
    """Nulls (N, DRAWS) of a wire; unless given, readings are neither scaled nor whitened."""
    n = prediction.output.size
    scale = np.ones(n) if scale is None else scale
    refitted: Any = SimpleNamespace(
        noise=NoiseEstimate(np.full(n, white), temperature_K, CORRELATION_S, white),
        scale=scale,
        fitted=np.full(n, fitted),
        factor=np.eye(scale.size) if factor is None else factor,
    )
    return null_data(prediction, PlantModel(ACTUATOR, WIRE, "negative"), refitted, DRAWS, seed)


def sd_of(covariance):
    """What each entry of the covariance of so many draws is off by."""
    variance = np.diag(covariance)
    return np.sqrt((np.outer(variance, variance) + covariance**2) / DRAWS)


def test_temperature_noise_is_an_ornstein_uhlenbecks_of_the_size_that_was_refitted():
    """A wire that only rises follows its temperature alone: divided by its slope, what is left is the noise."""
    size_K, small = 0.02, 1e-4
    slope = [
        (Preisach(WIRE).step(u + small) - Preisach(WIRE).step(u - small)) / (2 * small)
        for u in RISING.tolist()
    ]
    noise = drawn(prediction_for_inputs(WIRE, RISING, T_S), size_K) / np.array(slope)[:, None] / size_K
    expected = np.exp(-np.abs(np.subtract.outer(T_S, T_S)) / CORRELATION_S)
    assert np.all(np.abs(noise @ noise.T / DRAWS - expected) < 5 * sd_of(expected))
    assert np.all(np.abs(noise.mean(axis=1)) < 5 / np.sqrt(DRAWS))


def test_the_hysteresis_stores_the_noise_of_null_data_at_turning_points():
    rng, size_K = np.random.default_rng(4), 0.01
    prediction = prediction_for_inputs(
        WIRE, rng.uniform(65.0, 95.0, 16), np.cumsum(rng.uniform(5.0, 60.0, 16))
    )
    J, times = memory_slopes(WIRE, prediction)
    expected = size_K**2 * memory_covariance(J, times, CORRELATION_S)
    y = drawn(prediction, size_K)
    assert np.all(np.abs(y @ y.T / DRAWS - expected) < 5 * sd_of(expected) + 5e-3 * expected.max())
    brief = memory_covariance(J, times, 1e-3)
    assert np.abs(brief - np.diag(np.diag(brief))).max() > 0  # readings do share reversals


def test_without_temperature_noise_readings_are_what_was_fitted_and_white_noise():
    y = drawn(prediction_for_inputs(WIRE, RISING, T_S), white=0.3, fitted=2.0)
    assert np.all(np.abs(y.mean(axis=1) - 2.0) < 5 * 0.3 / np.sqrt(DRAWS))
    expected = 0.3**2 * np.eye(8)
    assert np.all(np.abs(np.cov(y) - expected) < 5 * sd_of(expected))


def test_readings_that_follow_no_position_are_noise_of_their_own_scale():
    """Two more of them: 5 and 50 units large, so 1 where they are divided by that."""
    prediction, scale = prediction_for_inputs(WIRE, RISING, T_S), np.append(np.full(8, 10.0), [5.0, 50.0])
    y = drawn(prediction, white=0.3, scale=scale)
    expected = np.diag(np.append(np.full(8, 0.03**2), [1.0, 1.0]))
    assert np.all(np.abs(np.cov(y) - expected) < 5 * sd_of(expected))


def test_nulls_are_whitened_by_the_factor_of_the_refit():
    prediction = prediction_for_inputs(WIRE, RISING, T_S)
    factor = np.tril(np.random.default_rng(3).uniform(0.5, 1.5, (8, 8)))
    np.testing.assert_allclose(
        factor @ drawn(prediction, 0.02, 0.1, factor=factor), drawn(prediction, 0.02, 0.1)
    )


@pytest.mark.parametrize(("seed", "same"), [(1, True), (2, False)])
def test_a_seed_makes_the_same_nulls_again(seed, same):
    prediction = prediction_for_inputs(WIRE, RISING, T_S)
    assert np.array_equal(drawn(prediction, 0.02, 0.1), drawn(prediction, 0.02, 0.1, seed=seed)) is same

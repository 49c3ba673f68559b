"""The error of whole counts, against readings that are rounded one by one."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.made_memories import prediction_for_inputs
from smarig.diagnosis.critique.critique import null_data
from smarig.diagnosis.refit.quantization import noise_before_rounding, quantization_traces
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.replay import PlantModel

READINGS = 40_000
ACTUATOR: Any = None


def rounded(position, noise_counts, seed=1):
    """Readings (positions, READINGS) in whole counts."""
    rng = np.random.default_rng(seed)
    return np.floor(position[:, None] + noise_counts * rng.standard_normal((position.size, READINGS)))


@pytest.mark.parametrize("noise_counts", [0.2, 0.25, 0.3, 0.5])
def test_the_traces_span_the_error_of_rounded_means_and_have_its_size(noise_counts):
    true = np.linspace(10.0, 14.0, 41)[:-1]
    mean = rounded(true, noise_counts).mean(axis=1)
    error = mean - true
    error -= error.mean()
    traces = quantization_traces(mean, noise_counts)
    left = error - traces @ np.linalg.lstsq(traces, error, rcond=None)[0]
    chance = noise_counts / np.sqrt(READINGS)
    assert np.std(left) < 4 * chance + 0.1 * np.std(error)
    expected = np.mean(np.sum(traces**2, axis=1))  # variance over random phases
    assert np.var(error) == pytest.approx(expected, rel=0.25, abs=(4 * chance) ** 2)


@pytest.mark.parametrize("noise_counts", [0.05, 0.2, 0.3, 0.45, 0.8])
def test_the_noise_before_rounding_is_found_from_the_scatter_over_all_positions(noise_counts):
    scatter = np.sqrt(np.mean(np.var(rounded(np.linspace(0, 1, 101)[:-1], noise_counts), axis=1)))
    assert noise_before_rounding(float(scatter)) == pytest.approx(noise_counts, rel=0.03, abs=0.005)


def test_holds_at_one_position_share_the_error_in_null_data():
    wire = thesis_surface("one_e")
    prediction = prediction_for_inputs(wire, np.array([70.0, 80.0, 90.0]), np.array([10.0, 20.0, 30.0]))
    traces = quantization_traces(np.array([3.2, 3.2, 3.7]), 0.2)
    refitted: Any = SimpleNamespace(
        noise=NoiseEstimate(np.zeros(3), 0.0, 60.0, 0.0, 0.0, traces),
        scale=np.ones(3),
        fitted=np.zeros(3),
        factor=np.eye(3),
    )
    y = null_data(prediction, PlantModel(ACTUATOR, wire, "negative"), refitted, 400, 1)
    np.testing.assert_allclose(y[0], y[1])
    assert np.corrcoef(y)[0, 2] < -0.5  # half a count away, the error has the other sign
    assert np.std(y[0]) == pytest.approx(0.11, rel=0.15)

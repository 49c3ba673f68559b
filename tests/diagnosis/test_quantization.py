"""The error of whole counts, against readings that are rounded one by one."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.coupled_readings import coupled_readings
from smarig.diagnosis.refit.quantization import noise_before_rounding, quantization_traces
from smarig.diagnosis.refit.reading_noise import FREE_ZERO_SD, _local_noise, encoder_error_traces
from smarig.replay import build_timeline, predict

READINGS = 40_000


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


def test_the_error_of_a_mean_has_a_second_harmonic_as_large_as_its_trace():
    """Little noise: the error is a steep function of the mean although it is a sine of the true position."""
    true = np.linspace(10.0, 14.0, 161)[:-1]
    mean = rounded(true, 0.2).mean(axis=1)
    error = mean - true
    traces = quantization_traces(mean, 0.2)
    both = np.column_stack([np.ones(mean.size), traces])
    strengths = np.linalg.lstsq(both, error, rcond=None)[0][1:]
    second = float(np.hypot(*strengths[[1, 4]]))  # of cosine and sine, each ~ N(0, 1)
    assert 0.7 < second / np.sqrt(2.0) < 1.4


def test_the_readings_of_a_refit_share_the_error_of_the_encoder(tmp_path):
    runs = session_runs(tmp_path, LONG)
    wire, per_count = twin_plant_model()
    model = replace(wire, per_count=per_count)
    timeline = replace(build_timeline(runs, wire.actuator.tau_s), other_readings=())
    readings = coupled_readings(timeline, predict(timeline, model), model)
    coupled = [r for r in timeline.all_readings if r.kind == "settled"]
    error = encoder_error_traces(timeline, model, coupled) / readings.scale[:, None]
    assert np.abs(error).max() > 0
    np.testing.assert_allclose(readings.free - error @ error.T, FREE_ZERO_SD**2)


@pytest.mark.parametrize("outliers", [0, 30])
def test_noise_is_found_from_differences_of_neighbours_without_jumps(outliers):
    rng = np.random.default_rng(3)
    y = 0.3 * rng.standard_normal(3000) + np.linspace(0.0, 50.0, 3000)
    y[rng.choice(3000, outliers, replace=False)] += 40.0
    assert _local_noise(y) == pytest.approx(0.3, rel=0.04)


@pytest.mark.parametrize("noise_counts", [0.05, 0.2, 0.3, 0.45, 0.8])
def test_the_noise_before_rounding_is_found_from_the_scatter_over_all_positions(noise_counts):
    scatter = np.sqrt(np.mean(np.var(rounded(np.linspace(0, 1, 101)[:-1], noise_counts), axis=1)))
    assert noise_before_rounding(float(scatter)) == pytest.approx(noise_counts, rel=0.03, abs=0.005)


def test_holds_at_one_position_share_the_error():
    first, same, half_away = quantization_traces(np.array([3.2, 3.2, 3.7]), 0.2)
    np.testing.assert_array_equal(first, same)
    assert first @ half_away < -0.5 * np.linalg.norm(first) * np.linalg.norm(half_away)
    assert np.linalg.norm(first) == pytest.approx(0.11, rel=0.15)

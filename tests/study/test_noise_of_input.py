"""The noise of a thermometer moves predictions on steep branches: an error as large as that is no fault of a model."""

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from smarig.study.noise_of_input import noise_by_input, reading_noise


def uneven_times(n, seed):
    return np.cumsum(np.random.default_rng(seed).uniform(0.2, 2.0, n))


@pytest.mark.parametrize("seed", range(4))
def test_the_noise_of_readings_is_found_on_any_clock(seed):
    t = uneven_times(2000, seed)
    u = 50 + 30 * np.sin(2 * np.pi * t / 400)
    rng = np.random.default_rng(100 + seed)
    for noise in (0.02, 0.3):
        assert reading_noise(t, u + noise * rng.standard_normal(t.size)) == pytest.approx(noise, rel=0.15)


def test_a_smooth_input_has_none():
    t = uneven_times(1000, 7)
    assert reading_noise(t, 50 + 30 * np.sin(2 * np.pi * t / 300)) < 1e-3
    assert reading_noise(t, np.abs(t % 200 - 100)) < 1e-6  # a triangle: turns do not count
    assert reading_noise(t[:5], t[:5]) == 0.0


def steep_loop(noise_K, noise_mm, *, seed=3):
    """Rows of a triangle between 20 and 90 °C and a loop whose branches rise within 6 K; relays of one width."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, 2000.0, 1.0)
    true = 20 + 70 * (1 - np.abs((t % 500) / 250 - 1))
    up, width = rng.normal(65, 1.2, 500), 12.0
    on, y = np.zeros(500, dtype=bool), []
    for u in true:
        on = np.where(u > up, True, np.where(u < up - width, False, on))
        y.append(3.0 * on.mean())
    noisy = np.array(y) + noise_mm * rng.standard_normal(t.size)
    return np.column_stack([t, true + noise_K * rng.standard_normal(t.size), noisy])


def studied(folder, rows):
    file = folder / "loop.csv"
    np.savetxt(
        file, rows, delimiter=",", header="time_s,temperature_C,displacement_mm", comments="", fmt="%.6f"
    )
    return study([file], folder / "out", StudyOptions(diagnose=False))


def test_an_error_by_a_noisy_thermometer_is_no_poor_model(tmp_path):
    result = studied(tmp_path, steep_loop(0.15, 0.003))
    by_input = noise_by_input(result.evaluation.best)
    assert by_input > 3 * 0.003  # it is the larger part
    assert result.noise == pytest.approx(np.hypot(0.003, by_input), rel=0.2)
    assert result.verdict != "poor"


def test_without_noise_of_the_input_only_that_of_the_output_counts(tmp_path):
    result = studied(tmp_path, steep_loop(0.0, 0.003))
    assert noise_by_input(result.evaluation.best) < 0.001

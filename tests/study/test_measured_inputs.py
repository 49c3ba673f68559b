"""What was measured at the specimen is the input before the current or voltage that causes it, and the signal of the
sensor of the output is none at all.
"""

import numpy as np
import pytest

from smarig.study import guess_table
from study.test_noise_columns import NOISE, H, K, M, T, X, roles, table

POWER = np.sin(K / 20 + 0.3)
SIGNALS = {
    "exact": 0.37 * X - 0.2,
    "falling": 2 - 0.37 * X,
    "noisy": 0.37 * X + 0.004 * NOISE[1],
    "rounded": np.round(0.37 * X, 2),
}


@pytest.mark.parametrize("signal", SIGNALS)
@pytest.mark.parametrize("turned", [1, -1])
def test_the_signal_of_the_sensor_is_not_the_input(tmp_path, signal, turned):
    columns = [("t (s)", K), *[("LVDT (V)", SIGNALS[signal]), ("x (mm)", X), ("heater (W)", POWER)][::turned]]
    assert roles(tmp_path, columns)[0] == ["heater (W)", "x (mm)"]


def test_a_signal_alone_is_no_input_either(tmp_path):
    guess = guess_table(table(tmp_path, [("t (s)", K), ("LVDT (V)", SIGNALS["noisy"]), ("x (mm)", X)]))
    assert guess.first("input") is None


def test_a_voltage_that_leaves_a_loop_is_the_input(tmp_path):
    columns = [("t (s)", K), ("U (V)", H), ("x (um)", M), ("P (W)", H**2)]
    assert roles(tmp_path, columns)[0] == ["U (V)", "x (um)"]


def test_a_current_in_random_order_is_the_input(tmp_path):
    order = np.random.default_rng(1).permutation(K.size)
    columns = [("I (A)", H[order]), ("x (mm)", M[order] ** 3)]
    assert roles(tmp_path, columns)[0] == ["I (A)", "x (mm)"]


@pytest.mark.parametrize("name", ["Hall probe (mT)", "H (kA/m)", "B gap (T)", "Field (kOe)"])
@pytest.mark.parametrize("turned", [1, -1])
def test_a_measured_field_goes_before_the_current_of_its_coil(tmp_path, name, turned):
    coil = 1.2 * np.sin(K / 20 + 0.02)
    columns = [("t (s)", K), *[("Coil current (A)", coil), (name, H), ("Strain (ppm)", 900 * M)][::turned]]
    assert roles(tmp_path, columns)[0] == [name, "Strain (ppm)"]


@pytest.mark.parametrize("name", ["heater (V)", "heater (A)"])
@pytest.mark.parametrize("output", ["Moment (emu)", "M (kA/m)", "x (mm)"])
def test_a_swept_temperature_goes_before_what_heats(tmp_path, name, output):
    held = 500 + 0.3 * NOISE[2]
    columns = [("t (s)", K), (name, 2 + POWER), ("Field (Oe)", held), (output, X), ("T (K)", T + 273)]
    assert roles(tmp_path, columns)[0] == ["T (K)", output]


def test_a_field_goes_before_a_temperature_that_drifts(tmp_path):
    columns = [("t (s)", K), ("T (K)", 300 + 0.02 * K), ("Field (Oe)", 900 * H), ("Moment (emu)", M)]
    assert roles(tmp_path, columns)[0] == ["Field (Oe)", "Moment (emu)"]

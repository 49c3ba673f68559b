"""A column whose motion is its scatter is no input, and no output that an input moves, whatever its name says."""

import numpy as np
import pytest

from smarig.exchange import FoundColumn, FoundTable
from smarig.study import guess_table

N = 600
K = np.arange(N)
NOISE = np.random.default_rng(3).normal(size=(4, N))
H = 5 * np.sin(K / 20)
M = np.tanh(np.roll(H, 4) / 2) + 0.01 * NOISE[0]
T = 60 + 30 * np.sin(K / 20)
X = 4 + np.tanh(np.roll(T - 60, 4) / 9) + 0.01 * NOISE[0]


def table(tmp_path, columns) -> FoundTable:
    found = tuple(FoundColumn(name, "", np.asarray(values, dtype=float)) for name, values in columns)
    return FoundTable(tmp_path / "data.csv", "csv", "", found, {"file": {"delimiter": "comma"}}, {})


def roles(tmp_path, columns):
    guess = guess_table(table(tmp_path, columns))
    return [guess.first(role).name for role in ("input", "output")], guess


@pytest.mark.parametrize(
    ("name", "held"),
    [
        ("I (A)", 0.5 + 1e-3 * NOISE[1]),
        ("Coil current (mA)", 40 * NOISE[1]),
        ("Magnet voltage (V)", NOISE[1]),
        ("T stage (degC)", 20 + 5 * NOISE[1]),
        ("Supply (V)", 12 + 1e-4 * K),  # nearly constant: a condition
    ],
)
@pytest.mark.parametrize("turned", [1, -1])
def test_an_input_is_swept(tmp_path, name, held, turned):
    columns = [("t (s)", K), *[(name, held), ("Field (kOe)", H), ("Strain (ppm)", 900 * M)][::turned]]
    found, guess = roles(tmp_path, columns)
    assert found == ["Field (kOe)", "Strain (ppm)"]
    assert not guess.doubts


@pytest.mark.parametrize(
    ("noisy", "out"),
    [
        ("Theta (deg)", "R (ohm)"),
        ("Position (mm)", "Resistance (mohm)"),
        ("Strain (%)", "Weg (mm)"),
        ("Voltage (V)", "Stroke (um)"),
    ],
)
@pytest.mark.parametrize("turned", [1, -1])
def test_an_output_follows_the_input(tmp_path, noisy, out, turned):
    columns = [("t (s)", K), ("T (degC)", T), *[(noisy, 1 + 0.2 * NOISE[2]), (out, X)][::turned]]
    found, guess = roles(tmp_path, columns)
    assert found == ["T (degC)", out]
    assert "noise" in guess.roles[noisy].reason


def test_rows_in_random_order_are_no_noise(tmp_path):
    order = np.random.default_rng(8).permutation(N)
    found, _ = roles(tmp_path, [("T (degC)", T[order]), ("Stroke (mm)", X[order])])
    assert found == ["T (degC)", "Stroke (mm)"]


def test_the_number_of_a_channel_is_no_voltage(tmp_path):
    columns = [("Time (s)", K), ("U1-1[°C]", T), ("U1-2[]", X), ("U2-1[V]", 1e-3 * NOISE[3])]
    found, guess = roles(tmp_path, columns)
    assert found == ["U1-1[°C]", "U1-2[]"]
    assert guess.doubts == ["unit U1-2[]"]


@pytest.mark.parametrize("value", [0.0, 7.0])
def test_a_constant_column_does_not_run_backwards(tmp_path, value):
    columns = [("t (s)", K), ("ms", np.full(N, value)), ("T (degC)", T), ("Stroke (mm)", X)]
    _, guess = roles(tmp_path, columns)
    assert guess.roles["ms"].reason == f"constant at {value:.4g}"


@pytest.mark.parametrize("start", [0.0, 1.7e9])
def test_an_epoch_is_a_clock(tmp_path, start):
    columns = [("T (degC)", T), ("Epoch", start + 1.5 * K + 7 * (K // 100)), ("Stroke (mm)", X)]
    assert roles(tmp_path, columns)[1].first("time").name == "Epoch"

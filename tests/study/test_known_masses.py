"""Masses that load a sensor are the input, a mass on a balance is the output, and neither is a temperature."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import StudyOptions, guess_table, study

WAY = np.r_[0:8, 8:0:-1, 0:8, 8:-1:-1]
RNG = np.random.default_rng(4)


def table(tmp_path, head, *columns):
    path = tmp_path / "log.csv"
    rows = [";".join(f"{v:.6g}" for v in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def guess_of(path):
    return guess_table(find_tables(path)[0])


def roles(guess):
    return tuple(c.name if (c := guess.first(role)) else None for role in ("input", "output"))


@pytest.mark.parametrize(("name", "unit"), [("weight_g", "g"), ("Masse [kg]", "kg"), ("mass_mg", "mg")])
def test_weights_on_a_load_cell_are_the_input(tmp_path, name, unit):
    masses = np.repeat(WAY, 9) * 20.0
    counts = np.round(300 + 1.9 * masses + RNG.normal(0, 1, masses.size))
    guess = guess_of(table(tmp_path, f"sec;cell;{name}", np.arange(masses.size) / 3, counts, masses))
    assert roles(guess) == (name, "cell")
    assert (guess.first("input").quantity, guess.first("input").unit) == ("mass", unit)
    assert not guess.doubts


def test_the_voltage_of_a_bridge_is_read_beside_masses(tmp_path):
    masses = np.repeat(WAY, 6) * 0.5
    volts = 0.002 * masses + RNG.normal(0, 1e-6, masses.size)
    guess = guess_of(table(tmp_path, "t [s];U [V];mass [kg]", np.arange(masses.size), volts, masses))
    assert roles(guess) == ("mass [kg]", "U [V]")


def test_a_mass_that_a_humidity_changes_is_the_output(tmp_path):
    humidity = np.repeat(WAY, 9) * 10.0 + 5
    mass = 30 + 0.1 * humidity
    head = "time_h;rel. humidity [%];mass_mg"
    guess = guess_of(table(tmp_path, head, np.arange(mass.size) / 20, humidity, mass))
    assert roles(guess) == ("rel. humidity [%]", "mass_mg")
    assert guess.first("time").unit == "h"


@pytest.mark.parametrize("name", ["pump speed", "conductivity", "CO2", "rpm", "flow [l/h]", "pH", "x [Hz]"])
def test_a_name_of_another_quantity_is_no_temperature(tmp_path, name):
    u = 40 + 30 * np.sin(np.arange(200) / 15)
    guess = guess_of(table(tmp_path, f"s;{name};stroke [mm]", np.arange(200), u, np.tanh(u / 40 - 1)))
    assert all(c.quantity != "temperature" for c in guess.columns)


def test_the_noise_beside_weights_is_that_of_a_reading_and_not_their_steps(tmp_path):
    masses = np.repeat(WAY, 9) * 25.0
    counts = np.round(7000 + 150 * masses + RNG.normal(0, 12, masses.size))
    path = table(tmp_path, "sec;raw;mass_g", np.arange(masses.size) / 5, counts, masses)
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.sentences()[0] == "The output is a function of the input; these data show no hysteresis."
    assert 6 < result.function.noise < 25

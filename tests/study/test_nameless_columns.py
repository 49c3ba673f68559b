"""Columns without names: their loop says which is the input, in both orders; where it does not, a question is asked."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import StudyOptions, guess_table, study
from study.known_data import displacements, temperatures

U = temperatures(2, 100)
X = displacements(U)
QUICK = StudyOptions(diagnose=False, accept=True)


def _guess(tmp_path, first, second):
    path = tmp_path / "loop.txt"
    np.savetxt(path, np.column_stack([first, second]), fmt="%.6g", delimiter="\t")
    return path, guess_table(max(find_tables(path), key=len))


LOOPS = {
    "current and a travel that looks like a temperature": (0.01 * U, 10 * X + 20),
    "voltage and polarisation": (1400 * (U - 70) / 50, 20 * (X - 2)),
    "temperature and travel": (U, X),
}


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.parametrize("exchanged", [False, True])
def test_the_column_that_the_other_lags_behind_is_the_input(tmp_path, name, exchanged):
    u, x = LOOPS[name]
    _, guess = _guess(tmp_path, *((x, u) if exchanged else (u, x)))
    assert guess.first("input").name == ("column 2" if exchanged else "column 1")
    assert "input" not in guess.doubts
    assert "lags behind" in guess.by_loop


def test_a_line_without_a_loop_is_a_doubt(tmp_path):
    _, guess = _guess(tmp_path, 1400 * np.sin(U / 10), 3 * 1400 * np.sin(U / 10) + 5)
    assert {"input", "output"} <= set(guess.doubts)


def test_a_temperature_that_lags_is_taken_and_the_choice_is_said(tmp_path):
    path, guess = _guess(tmp_path, np.roll(U, 6), X)
    assert guess.first("input").name == "column 1"
    assert "looks like a temperature" in guess.by_loop
    result = study([path], tmp_path / "out", QUICK)
    assert any("name them with --input and --output" in hint for hint in result.hints())


def test_force_and_travel_that_go_both_ways_are_no_temperatures(tmp_path):
    phase = np.linspace(0, 8 * np.pi, 400)
    force = (12 + phase / 2) * np.sin(phase) + 2
    travel = 0.7 * np.roll(force, 12)
    assert -0.9 < force.min() / force.max() < -0.6, "not so symmetric that the numbers alone say it"
    _, guess = _guess(tmp_path, travel, force)
    assert {c.quantity for c in guess.columns} == {""}
    assert {"unit column 1", "unit column 2"} <= set(guess.doubts)


STEPS = np.arange(10, -11, -1.0)
READ = 700 * np.tanh((STEPS + 0.8) / 4) + np.random.default_rng(3).normal(0, 4, STEPS.size)


@pytest.mark.parametrize("rising", [False, True])
@pytest.mark.parametrize("exchanged", [False, True])
def test_the_column_in_equal_steps_is_the_input_of_a_table_by_hand(tmp_path, rising, exchanged):
    u, y = (STEPS[::-1], READ[::-1]) if rising else (STEPS, READ)
    _, guess = _guess(tmp_path, *((y, u) if exchanged else (u, y)))
    assert guess.first("input").name == ("column 2" if exchanged else "column 1")
    assert guess.first("output") is not None
    assert "equal steps" in guess.by_loop
    assert "input" not in guess.doubts


def test_units_as_an_answer_do_not_exchange_the_columns(tmp_path):
    path = tmp_path / "coil.txt"
    np.savetxt(path, np.column_stack([READ, STEPS, 701.8 * STEPS]), fmt="%.1f", delimiter="   ")
    asked = guess_table(max(find_tables(path), key=len))
    assert asked.doubts == ["unit column 2", "unit column 1"]
    told = guess_table(asked.table, units={"column 2": "A", "column 1": "mT"})
    assert (told.first("input").name, told.first("output").name) == ("column 2", "column 1")
    assert not told.doubts


def test_names_are_believed(tmp_path):
    path = tmp_path / "named.csv"
    rows = "\n".join(f"{a:.4f},{b:.4f}" for a, b in zip(X, U))
    path.write_text(f"displacement,temperature\n{rows}\n", encoding="utf-8")
    guess = guess_table(max(find_tables(path), key=len))
    assert guess.first("input").name == "temperature"
    assert not guess.by_loop


def test_a_unit_from_the_user_says_more_than_numbers(tmp_path):
    path = tmp_path / "sweep.txt"
    np.savetxt(path, np.column_stack([np.arange(140.0, 700.0, 4), np.arange(140.0) ** 2]), fmt="%.6g")
    table = max(find_tables(path), key=len)
    guess = guess_table(table, input="column 1", output="column 2", units={"column 1": "degC"})
    assert guess.first("input").quantity == "temperature"

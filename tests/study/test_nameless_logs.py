"""A log without names: a column of equal steps is its clock, and what the numbers do not tell is asked."""

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.exchange import find_tables
from smarig.study import StudyOptions, guess_table, study
from smarig.study.understanding import understand

ROWS = 300
U = np.round(60 - 35 * np.cos(np.linspace(0, 6 * np.pi, ROWS)), 1)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 70, 55)) / 6), 3)
CURRENT = np.round(np.sqrt(np.maximum(U - 25, 0) / 100), 3)


def log(path, *columns, start="Ready\n", sign="\t"):
    rows = [sign.join(f"{x:g}" for x in row) for row in zip(*columns, strict=True)]
    path.write_text(start + "\n".join(rows) + "\n")
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("sign", ["\t", ",", ";", " "])
@pytest.mark.parametrize("step", [2, 100, 500, 1000])
def test_equal_steps_are_the_clock_and_the_rest_is_asked(tmp_path, step, sign):
    path = log(tmp_path / "a.txt", step * np.arange(ROWS), CURRENT, U, X, sign=sign)
    (table,) = find_tables(path)
    guess = guess_table(table)
    assert guess.roles["column 1"].role == "time"
    assert f"equal steps of {step}" in guess.roles["column 1"].reason
    assert guess.first("input").name == "column 3"
    assert guess.doubts == ["output", "unit column 1"]
    assert guess.roles["column 2"].role == "output" or "column 2" in guess.roles["column 4"].reason
    with pytest.raises(UsageError, match="Say --output NAME --unit 'column 1=UNIT'"):
        study([path], tmp_path / "out", StudyOptions())
    answered = guess_table(table, output="column 4", units={"column 1": "ms"})
    assert not answered.doubts
    assert answered.first("time").unit == "ms"


def test_the_answers_are_enough(tmp_path):
    path = log(tmp_path / "a.txt", 500 * np.arange(ROWS), CURRENT, U, X)
    options = StudyOptions(output="column 4", units={"column 1": "ms"}, diagnose=False)
    result = study([path], tmp_path / "out", options)
    np.testing.assert_allclose(result.tables[0].run["t_s"], 0.5 * np.arange(ROWS))


def test_numbers_of_rows_are_no_clock(tmp_path):
    (table,) = find_tables(log(tmp_path / "a.txt", 1 + np.arange(ROWS), U, X))
    guess = guess_table(table)
    assert guess.roles["column 1"].reason.startswith("row number")
    assert not guess.doubts


def test_one_candidate_is_no_question(tmp_path):
    (table,) = find_tables(log(tmp_path / "a.txt", 0.5 * np.arange(ROWS), U, X))
    guess = guess_table(table)
    assert guess.first("output").name == "column 3"
    assert not guess.doubts


def test_a_thermometer_that_failed_is_no_question(tmp_path):
    """It differs too much from the other to agree with it, and is no output either."""
    failed = np.where(np.arange(ROWS) % 7 < 2, 18.0, U)
    (table,) = find_tables(log(tmp_path / "a.txt", 0.5 * np.arange(ROWS), X, U, failed))
    assert guess_table(table).first("output").name == "column 2"
    assert not guess_table(table).doubts


def test_a_copy_of_the_input_is_no_question(tmp_path):
    (table,) = find_tables(log(tmp_path / "a.txt", 0.5 * np.arange(ROWS), X, U, 0.01 * U))
    assert guess_table(table).first("output").name == "column 2"
    assert not guess_table(table).doubts


def test_the_given_log_asks(shared_data, tmp_path):
    path = shared_data / "field_cases" / "other_containers" / "arduino2.txt"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    with pytest.raises(UsageError, match="Say --output NAME --unit 'column 1=UNIT'"):
        study([path], tmp_path / "out", StudyOptions())


def test_the_question_offers_the_input_too(tmp_path):
    path = log(tmp_path / "a.txt", 500 * np.arange(ROWS), CURRENT, U, X)
    with pytest.raises(UsageError, match="and --input NAME if it is not 'column 3' .columns"):
        study([path], tmp_path / "out", StudyOptions())


@pytest.mark.parametrize("sign", [1, -1])
def test_an_input_against_which_the_loop_speaks_is_a_question(tmp_path, sign):
    """The output is given as the column that drives: what moves then looks like the input by its numbers alone."""
    late = 60 + 9 * sign * (X - 3)  # numbers like temperatures
    path = log(tmp_path / "a.txt", 0.5 * np.arange(ROWS), late, U / 500, CURRENT / 100)
    with pytest.raises(UsageError, match="Say --input NAME"):
        study([path], tmp_path / "out", StudyOptions(output="column 3", diagnose=False))
    both = StudyOptions(input="column 3", output="column 2", diagnose=False)
    result = study([path], tmp_path / "out", both)
    reasons = [role.reason for role in result.understood.guesses[0].roles.values()]
    assert not any("speaks against" in reason for reason in reasons)


@pytest.mark.parametrize("seed", [1, 2])
def test_no_reason_of_another_pair_stays_beside_an_answer(tmp_path, seed):
    """The loop with the output of the guess says nothing of an input beside the output that is given."""
    noise = 0.01 * np.round(np.random.default_rng(seed).normal(1, 0.1, ROWS), 3)
    path = log(tmp_path / "a.txt", 0.5 * np.arange(ROWS), U, X / 100, noise)
    guess = guess_table(*find_tables(path))
    assert guess.roles["column 2"].reason.startswith("no name of a column says which is the input")
    assert guess.first("output").name == "column 3"
    options = StudyOptions(input=None, output="column 4")
    (answered,) = understand([path], options).guesses
    assert answered.first("input").name == "column 2"
    assert "no name of a column says which is the input" not in answered.roles["column 2"].reason

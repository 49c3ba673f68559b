"""Two thermometers that differ, and whose names say equally little of their places: a question, never a guess."""

import numpy as np
import pytest

from smarig.study.study_options import StudyOptions
from smarig.study.understanding import UnsureError, understand

U = 70 - 50 * np.cos(np.linspace(0, 12, 240))
FAR = 25 + 0.5 * (U - 20)


def file_of(tmp_path, names, second=FAR):
    y = np.tanh((U - 70) / 9)
    path = tmp_path / "wire.csv"
    rows = (f"{0.5 * k},{u:.3f},{v:.3f},{x:.4f}" for k, (u, v, x) in enumerate(zip(U, second, y)))
    path.write_text("\n".join([f"t (s),{names},Stroke (mm)", *rows]) + "\n")
    return path


@pytest.mark.parametrize(
    "names", ["T1 (degC),T2 (degC)", "TC2 (degC),TC1 (degC)", "Temp A (degC),Temp B (degC)"]
)
def test_equal_names_are_a_question_with_its_commands(tmp_path, names):
    path = file_of(tmp_path, names)
    with pytest.raises(UnsureError) as question:
        understand([path], StudyOptions())
    for name in names.split(","):
        assert f"smarig study {path} --input '{name}' --output 'Stroke (mm)' -o wire" in str(question.value)
        (guess,) = understand([path], StudyOptions(input=name, output="Stroke (mm)")).guesses
        assert guess.first("input").name == name


@pytest.mark.parametrize("names", ["T1 (degC),T oven (degC)", "T wire (degC),T2 (degC)"])
def test_a_name_that_says_more_answers_it(tmp_path, names):
    (guess,) = understand([file_of(tmp_path, names)], StudyOptions()).guesses
    assert guess.first("input").name == names.split(",")[0]


def test_thermometers_that_agree_are_no_question(tmp_path):
    (guess,) = understand([file_of(tmp_path, "T1 (degC),T2 (degC)", U + 0.4)], StudyOptions()).guesses
    assert guess.roles["T2 (degC)"].role == "compare"


@pytest.mark.parametrize("lag", [3.5, 4.5, -4.0])
@pytest.mark.parametrize("names", ["CH1 (degC),CH2 (degC)", "T2 (degC),T1 (degC)"])
def test_a_lag_of_a_few_kelvin_is_a_question_too(tmp_path, names, lag):
    second = U - lag * np.sign(np.gradient(U))
    with pytest.raises(UnsureError) as question:
        understand([file_of(tmp_path, names, second)], StudyOptions())
    for name in names.split(","):
        assert f"--input '{name}' --output 'Stroke (mm)'" in str(question.value)


@pytest.mark.parametrize("differs", [0.0, 0.8, -1.3])
def test_what_two_thermometers_at_one_place_may_differ_is_none(tmp_path, differs):
    second = U + 1.0 - differs * np.sign(np.gradient(U))
    (guess,) = understand([file_of(tmp_path, "CH1 (degC),CH2 (degC)", second)], StudyOptions()).guesses
    assert guess.roles["CH2 (degC)"].role == "compare"


@pytest.mark.parametrize(
    "names", ["Ts (degC),Tr (degC)", "T_wire (degC),T2 (degC)", "TC1 (degC),T_air (degC)"]
)
def test_a_lag_between_named_places_is_none(tmp_path, names):
    second = U - 4.0 * np.sign(np.gradient(U))
    (guess,) = understand([file_of(tmp_path, names, second)], StudyOptions()).guesses
    assert guess.first("input").name == names.split(",")[0]

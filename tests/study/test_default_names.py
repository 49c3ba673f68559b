"""Names that a program gives columns without names say nothing: no quantity and no unit is taken from them."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import UnsureError, understand
from study.known_data import displacements, temperatures

U = temperatures(3, 150)
X = displacements(U)
NAMES = {
    "R": '"","V1","V2","V3","V4"',
    "MATLAB": "Var1,Var2,Var3,Var4",
    "Minitab": "C1,C2,C3,C4",
    "pandas": "Unnamed: 0,Unnamed: 1,Unnamed: 2,Unnamed: 3",
    "R, made from a list": "X1,X2,X3,X4",
}


def written(tmp_path, head, *columns, rows=False):
    path = tmp_path / "frame.csv"
    lines = [",".join(f"{v:.6g}" for v in row) for row in zip(*columns, strict=True)]
    lines = [f'"{k}",{line}' for k, line in enumerate(lines, start=1)] if rows else lines
    path.write_text("\n".join([head, *lines, ""]), encoding="utf-8")
    return path


@pytest.mark.parametrize("program", NAMES)
def test_default_names_are_asked_for_units_and_roles(tmp_path, program):
    head = NAMES[program]
    times = 2.0 * np.arange(U.size)
    path = written(tmp_path, head, times, U, X, np.full(U.size, 7.5), rows=program == "R")
    names = [name.strip('"') for name in head.split(",")][-4:]
    guess = guess_table(find_tables(path)[0])
    assert [guess.first(role).name for role in ("time", "input", "output")] == names[:3]
    assert not {"voltage", "temperature"} & {c.quantity for c in guess.columns}
    with pytest.raises(UnsureError) as error:
        understand([path], StudyOptions())
    said = str(error.value)
    assert f"whether '{names[1]}' is the input and '{names[2]}' the output" in said
    assert "=degC" in said
    assert "=A" in said
    assert names[3] + "=" not in said


def test_an_answered_unit_goes_on(tmp_path):
    path = written(tmp_path, "V1,V2", U, X)
    found = understand([path], StudyOptions(units={"V1": "degC", "V2": "mm"}))
    assert [found.guesses[0].first(role).name for role in ("input", "output")] == ["V1", "V2"]


@pytest.mark.parametrize("head", ["V1 [V],V2 [V]", "time,V1,V2"])
def test_stated_voltages_are_voltages(tmp_path, head):
    more = [np.arange(U.size)] if head.startswith("time") else []
    path = written(tmp_path, head, *more, U / 20, X)
    guess = guess_table(find_tables(path)[0])
    assert [c.quantity for c in guess.columns][-2:] == ["voltage", "voltage"]

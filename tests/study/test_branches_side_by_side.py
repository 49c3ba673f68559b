"""A heating and a cooling branch as two columns of one table become one loop, whatever their names and the order of
the rows."""

import numpy as np
import pytest
from scipy.io import savemat

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import StudyOptions, guess_table, mapping_draft, study
from study.known_data import table_of

U = np.arange(20.0, 111.0)
HEATING = 5.2 - 0.3 * (1 + np.tanh((U - 78) / 5))
COOLING = 5.2 - 0.3 * (1 + np.tanh((U - 62) / 5))
PAIRS = (
    ("R_heating", "R_cooling"),
    ("R Heating (ohm)", "R Cooling (ohm)"),
    ("up R", "down R"),
    ("R_forth", "R_back"),
    ("forward sweep: R [ohm]", "backward sweep: R [ohm]"),
    ("R increasing", "R decreasing"),
)


def written(path, names, columns):
    rows = [",".join("" if np.isnan(x) else f"{x:.6g}" for x in row) for row in np.column_stack(columns)]
    path.write_text(",".join(names) + "\n" + "\n".join(rows) + "\n")
    return path


def loop(path, tmp_path):
    """Input and output of a file as its draft reads them."""
    (table,) = find_tables(path)
    guess = guess_table(table)
    assert not guess.doubts
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(
        path, format=table.format, out=tmp_path / "a.run.sqlite", mapping=str(draft), force=True
    )
    run = load_run(report.run)
    return guess, run["input"], run["position"]


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("names", PAIRS)
def test_two_columns_are_one_loop(tmp_path, names, swapped):
    columns = [HEATING, COOLING]
    path = written(
        tmp_path / "a.csv",
        ["T (degC)", *(names[::-1] if swapped else names)],
        [U, *(columns[::-1] if swapped else columns)],
    )
    guess, u, y = loop(path, tmp_path)
    np.testing.assert_allclose(u, [*U, *U[::-1]])
    np.testing.assert_allclose(y, [*HEATING, *COOLING[::-1]], atol=1e-4)
    shown = guess.shown_role(names[1])
    assert shown.role == "output, second branch"
    assert names[0] in shown.reason
    assert "from the last row to the first" in shown.reason


@pytest.mark.parametrize("order", ["as measured", "both rising", "sorted"])
def test_halves_that_are_empty_are_left_out(tmp_path, order):
    """As joined tables hold them: each row has a reading of one branch."""
    nothing = np.full(U.size, np.nan)
    back = slice(None, None, -1 if order == "as measured" else 1)
    rows = np.column_stack([[*U, *U[back]], [*HEATING, *nothing], [*nothing, *COOLING[back]]])
    rows = rows[np.argsort(rows[:, 0], kind="stable")] if order == "sorted" else rows
    path = written(tmp_path / "a.csv", ["T_degC", "R_up_ohm", "R_down_ohm"], rows.T)
    _, u, y = loop(path, tmp_path)
    np.testing.assert_allclose(u, [*U, *U[::-1]])
    np.testing.assert_allclose(y, [*HEATING, *COOLING[::-1]], atol=1e-4)


@pytest.mark.parametrize("names", [("R_heating", "R_cooling"), ("R_forth", "R_back")])
def test_rows_of_a_falling_input(tmp_path, names):
    """Heating and cooling are known by their words; forth goes as the rows go."""
    there, back = (HEATING, COOLING) if "heating" in names[0] else (COOLING, HEATING)
    path = written(tmp_path / "a.csv", ["T (K)", *names], [U[::-1] + 273.15, there[::-1], back[::-1]])
    _, u, y = loop(path, tmp_path)
    np.testing.assert_allclose(u, [*U, *U[::-1]], atol=1e-3)
    np.testing.assert_allclose(y, [*HEATING, *COOLING[::-1]], atol=1e-4)


def test_each_branch_with_its_own_input(tmp_path):
    path = written(
        tmp_path / "a.csv",
        ["T_heating [degC]", "x_heating [mm]", "T_cooling [degC]", "x_cooling [mm]"],
        [U, HEATING, U[::-1], COOLING[::-1]],
    )
    _, u, y = loop(path, tmp_path)
    np.testing.assert_allclose(u, [*U, *U[::-1]])
    np.testing.assert_allclose(y, [*HEATING, *COOLING[::-1]], atol=1e-4)


def test_a_T_in_even_steps_beside_branches_is_no_time(tmp_path):
    path = written(tmp_path / "a.csv", ["T", "R_heating", "R_cooling"], [U, HEATING, COOLING])
    guess, u, _ = loop(path, tmp_path)
    assert guess.first("input").unit == "degC"
    assert u.size == 2 * U.size


def test_an_input_that_goes_up_and_down_is_not_unfolded():
    """A gauge that goes one way beside it does not make it a sweep."""
    warm = np.array([*U[::2], *U[::-2]])[: U.size]
    columns = {"T (degC)": warm, "load (N)": U, "x_up (mm)": HEATING, "x_down (mm)": COOLING}
    assert not guess_table(table_of(**columns)).branches


def test_branches_of_matlab_variables(tmp_path):
    savemat(tmp_path / "a.mat", {"T": U, "R_heating": HEATING, "R_cooling": COOLING})
    _, u, y = loop(tmp_path / "a.mat", tmp_path)
    np.testing.assert_allclose(u, [*U, *U[::-1]])
    np.testing.assert_allclose(y, [*HEATING, *COOLING[::-1]])


def test_two_sensors_called_up_and_down_are_no_branches():
    t = np.arange(2 * U.size) * 0.5
    warm = np.array([*U, *U[::-1]])
    moved = np.array([*HEATING, *COOLING[::-1]])
    guess = guess_table(table_of(time_s=t, T_up_degC=warm, T_down_degC=warm - 1, x_mm=moved))
    assert not guess.branches
    assert guess.first("time").name == "time_s"
    assert guess.roles["T_down_degC"].role == "compare"


def test_branches_of_different_units_are_none():
    assert not guess_table(table_of(T_degC=U, x_up_mm=HEATING, x_down_N=COOLING)).branches


def test_an_output_that_the_user_names_counts():
    table = table_of(**{"T (degC)": U, "R_up (ohm)": HEATING, "R_down (ohm)": COOLING})
    guess = guess_table(table, output="R_down (ohm)")
    assert guess.first("output").name == "R_down (ohm)"
    assert not guess.branches


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("name", ["wide.csv", "wide_updown.csv", "nan.csv"])
def test_the_given_tables_give_their_temperatures(shared_data, tmp_path, name):
    path = shared_data / "field_cases" / "branches_side_by_side" / name
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    figures = " ".join(result.transformation.lines())
    assert result.evaluation.best.rms < 0.01
    for text in ("A_s 70.", "A_f 85 ", "M_s 69.", "M_f 54."):
        assert text in figures

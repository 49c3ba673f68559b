"""An export with rows of names, units and comments, and pairs of columns side by side: each pair is a run."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import StudyOptions, study
from smarig.study.understanding import understand
from study.known_data import displacements, temperatures

LOADS = (60.0, 120.0, 210.0)


def pairs(shift=8.0, loads=LOADS):
    """Temperature and strain of each load; later pairs are shorter."""
    found = []
    for k, _ in enumerate(loads):
        u = temperatures(2, 150 - 10 * k)
        found.append((u, displacements(u - shift * k, seed=k)))
    return found


def written(path, columns, comments, units=(r"\+(o)C", "%"), names=("Temperature", "Strain")):
    lines = ["\t".join(names * len(columns)), "\t".join(units * len(columns)), "\t".join(comments)]
    for k in range(max(u.size for u, _ in columns)):
        cells = [f"{x[k]:.4f}" if k < x.size else "" for pair in columns for x in pair]
        lines.append("\t".join(cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def load_comments(loads=LOADS):
    return [cell for load in loads for cell in ("", f"{load:g} MPa")]


@pytest.mark.long("takes ten seconds", cases=("loads1", "loads2"))
@pytest.mark.parametrize("loads", [LOADS[:1], LOADS[:2], LOADS])
def test_each_pair_is_a_run_at_the_load_of_its_comment(tmp_path, loads):
    path = written(tmp_path / "a.dat", pairs(loads=loads), load_comments(loads))
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert len(result.tables) == len(loads)
    for table, (u, y), load in zip(result.tables, pairs(loads=loads), loads):
        known = np.isfinite(table.run["input"])
        np.testing.assert_allclose(table.run["input"][known], u, atol=1e-3)
        np.testing.assert_allclose(table.run["position"][known], y, atol=1e-3)
        assert table.run.info.output.quantity == "strain"
        assert table.run.unit == "%"
        assert table.run.info.conditions["stress"]["mean"] == load
    assert not result.left_out


@pytest.mark.parametrize("comments", [["", "first", "", "second", "", "third"], [""] * 6])
def test_pairs_without_a_load_are_runs_too(tmp_path, comments):
    path = written(tmp_path / "a.dat", pairs(), comments)
    assert [len(g.table) for g in understand([path], StudyOptions()).guesses] == [300, 280, 260]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("labels", [("Name", "Unit", "Remark", "f(x) ="), (None,) * 4])
def test_pairs_of_a_sheet_beside_a_count_of_rows_and_a_curve_of_its_own(tmp_path, labels):
    openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    columns, loads = pairs(loads=LOADS[:2]), load_comments(LOADS[:2])
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append([None, "A(X)", "B(Y)", "C(X)", "D(Y)", "E(Y)"])
    rows = [
        ["Temp", "Strain"] * 2 + ["dS/dT"],
        [r"\+(o)C", "%"] * 2 + ["%/K"],
        [*loads, "smooth"],
        [None] * 4 + ["diff"],
    ]
    for label, row in zip(labels, rows, strict=True):
        sheet.append([label, *row])
    for k in range(max(u.size for u, _ in columns)):
        cells = [float(x[k]) if k < x.size else None for pair in columns for x in pair]
        sheet.append([k + 1, *cells, float(np.sin(k))])
    book.create_chartsheet("Plot", 0).add_chart(openpyxl.chart.ScatterChart())
    book.save(path := tmp_path / "book.xlsx")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert len(result.tables) == 2
    for table, (u, y), load in zip(result.tables, columns, LOADS):
        known = np.isfinite(table.run["input"])
        np.testing.assert_allclose(table.run["input"][known], u, atol=1e-9)
        np.testing.assert_allclose(table.run["position"][known], y, atol=1e-9)
        assert table.run.unit == "%"
        assert table.run.info.conditions["stress"]["mean"] == load


def test_single_branches_side_by_side_stay_together(tmp_path):
    u = np.linspace(20, 110, 80)
    columns = [(u, displacements(u)), (u[::-1], displacements(u[::-1]))]
    path = written(tmp_path / "a.dat", columns, ["", "up", "", "down"])
    assert len(understand([path], StudyOptions()).guesses) == 1


def test_single_branches_at_loads_of_their_own_are_runs(tmp_path):
    u = np.linspace(20, 110, 80)
    columns = [(u, displacements(u)), (u, displacements(u - 9))]
    path = written(tmp_path / "a.dat", columns, load_comments(LOADS[:2]))
    assert len(understand([path], StudyOptions()).guesses) == 2


def test_a_pair_that_the_user_names_counts(tmp_path):
    path = written(tmp_path / "a.dat", pairs(), load_comments())
    named = StudyOptions(input="Temperature (2)", output="Strain (2)")
    (guess,) = understand([path], named).guesses
    assert guess.first("output").name == "Strain (2)"


@pytest.mark.parametrize(
    ("written_as", "meant"),
    [(r"\+(o)C", "°C"), (r"\g(m)m", "µm"), (r"N/mm\+(2)", "N/mm²"), (r"(\+(o)C)", "°C")],
)
def test_markup_of_units_is_read(tmp_path, written_as, meant):
    path = written(tmp_path / "a.dat", pairs()[:1], ["", "x y"], (written_as, "%"), (r"\g(e)\-(1)", "B"))
    (table,) = find_tables(path)
    assert table.names == ("ε1", "B")
    assert table.columns[0].unit == meant
    assert table.columns[1].comment == "x y"


def two_ways(path, loads, swapped=False, slip=None):
    """A sheet with the way there and the way back side by side for each load, as a hand writes it; the loops."""
    openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    sheet = (book := openpyxl.Workbook()).active
    u = np.r_[np.linspace(24, 96, 45), np.linspace(95.5, 24.5, 45)]
    loops = [np.c_[u, 5 + displacements(u - 5 * k)] for k in range(len(loads))]
    sheet.append([cell for load in loads for cell in (load, None, None, None, None)])
    sheet.append(["T (°C)", "x (mm)", "T (°C)", "x (mm)", None] * len(loads))
    for k in range(45):
        ways = [[loop[45 + k], loop[k]] if swapped else [loop[k], loop[45 + k]] for loop in loops]
        sheet.append([cell for pair in ways for cell in (*map(float, pair[0]), *map(float, pair[1]), None)])
    if slip is not None:
        cell = sheet.cell(row=slip, column=2)
        cell.value = round(cell.value * 100)
    book.save(path)
    return loops


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("loads", [["m = 300 g"], ["m = 300 g", "m = 800 g"], ["5 N", "9 N", "12 N"]])
def test_two_ways_side_by_side_are_one_loop(tmp_path, loads, swapped):
    full = two_ways(tmp_path / "a.xlsx", loads, swapped=swapped)
    result = study([tmp_path / "a.xlsx"], tmp_path / "out", StudyOptions(diagnose=False))
    assert len(result.tables) == len(loads)
    for table, loop in zip(result.tables, full):
        np.testing.assert_allclose(table.run["input"], loop[:, 0], atol=1e-9)
        np.testing.assert_allclose(table.run["position"], loop[:, 1], atol=1e-9)
        assert len(loads) == 1 or "load" in table.run.info.conditions
    assert not any("thermometer" in hint or "one way" in hint for hint in result.hints())


def test_a_number_that_lost_its_decimal_sign_is_masked(tmp_path):
    two_ways(tmp_path / "a.xlsx", ["m = 300 g"], slip=20)
    result = study([tmp_path / "a.xlsx"], tmp_path / "out", StudyOptions(diagnose=False))
    (table,) = result.tables
    assert np.flatnonzero(np.isnan(table.run["position"])).tolist() == [17]
    assert any("decimal sign is missing" in finding.text for finding in table.findings)


@pytest.mark.parametrize("unit", ["nemu", "µemu", "mA m²", "µAm2"])
def test_moments_in_small_units_stand_below_their_names(tmp_path, unit):
    comments = ["Film A", "Film A", "Film B", "Film B"]
    path = written(tmp_path / "a.dat", pairs()[:2], comments, ("kOe", unit), ("Field", "Moment"))
    guesses = understand([path], StudyOptions()).guesses
    assert [g.table.name for g in guesses] == ["Film A", "Film B"]
    assert {g.first("output").quantity for g in guesses} == {"magnetic moment"}

"""Workbooks of numbers that are texts, bare counts, and files that a number tells apart."""

import numpy as np
import pytest

from extras import lacks
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import StudyOptions, guess_table, mapping_draft, study
from smarig.study.column_guess import guess_columns
from study.known_data import table_of

ROWS = 200
U = np.round(60 - 35 * np.cos(np.linspace(0, 6 * np.pi, ROWS)), 2)
X = np.round(2 * (1 + np.tanh((U - np.where(np.gradient(U) > 0, 70, 55)) / 6)), 3)


def workbook(path, cell, *, units=("s", "°C", "mm"), notes=True):
    """A workbook whose numbers are what ``cell`` makes of them, beside a sheet of notes."""
    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    if notes:
        sheet.title = "Notizen"
        sheet.append(["Probe A 7", "geglüht bei 450 °C"])
        sheet.append(["Kommentar", "0,5 mm Draht"])
        sheet = book.create_sheet("Messung")
    sheet.append(["Zeit", "Temperatur", "Weg"])
    if units:
        sheet.append(list(units))
    for k, (u, x) in enumerate(zip(U, X, strict=True)):
        sheet.append([cell(0.5 * k), cell(float(u)), cell(float(x))])
    book.save(path)
    return path


def comma(x):
    return str(x).replace(".", ",")


CELLS = {
    "texts with a comma": comma,
    "texts with a point": str,
    "numbers": lambda x: x,
    "some of them numbers": lambda x: x if x == round(x) else comma(x),
    "thousands": lambda x: f"{x + 1234:,.3f}".replace(",", " ").replace(".", ",").replace(" ", "."),
}


@pytest.mark.skipif(lacks("files"), reason="needs extra 'files'")
@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("units", [("s", "°C", "mm"), ("[s]", "[°C]", "[mm]"), ()])
@pytest.mark.parametrize("cell", CELLS)
def test_a_workbook_of_texts(tmp_path, cell, units):
    path = workbook(tmp_path / "a.xlsx", CELLS[cell], units=units)
    (table,) = find_tables(path)
    shift = 1234 if cell == "thousands" else 0
    assert table.names == ("Zeit", "Temperatur", "Weg")
    assert [c.unit for c in table.columns] == (["s", "°C", "mm"] if units else [""] * 3)
    np.testing.assert_allclose(table.columns[1].values, U + shift)
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format="xlsx", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    np.testing.assert_allclose(
        load_run(report.run)["input"], U + shift - (273.15 if not units and shift else 0)
    )


@pytest.mark.parametrize("name", ["position", "Weg", "angle"])
def test_bare_counts_keep_their_unit(name):
    counts = np.round(500 * X)
    guess = guess_table(table_of(**{"T (degC)": U, name: counts}))
    assert guess.first("output").unit == "count"
    assert 'unit = "count"' in mapping_draft(guess, "m").partition("[output]")[2]
    assert guess_table(table_of(**{"T (degC)": U, name: counts + 0.5})).first("output").unit in ("mm", "deg")


@pytest.mark.parametrize("name", ["encoder_counts", "position [counts]", "force (adc)"])
def test_stated_counts(name):
    (column,) = guess_columns(table_of(**{name: np.round(500 * X)}), {})
    assert column.unit == "count"


@pytest.mark.long("takes three seconds")
def test_the_number_of_a_file_stays_in_its_name(tmp_path):
    paths = [tmp_path / f"loop.{k:03d}" for k in range(3)]
    for path, shift in zip(paths, (0.0, 0.001, 0.002)):  # no copies of each other
        rows = [f"{0.5 * k:g},{u:g},{x + shift:g}" for k, (u, x) in enumerate(zip(U, X, strict=True))]
        path.write_text("time_s,T_degC,x_mm\n" + "\n".join(rows) + "\n")
    result = study(paths, tmp_path / "out", StudyOptions(diagnose=False))
    assert [table.title for table in result.tables] == ["loop.000", "loop.001", "loop.002"]
    assert [table.run.path.name for table in result.tables] == [
        f"0{k + 1}_loop.00{k}.run.sqlite" for k in range(3)
    ]
    assert study(paths[:1], tmp_path / "one", StudyOptions(diagnose=False)).name == "loop.000"


@pytest.mark.parametrize(("scale", "name", "unit"), [(1.0, "Strain (%)", "%"), (0.01, "Strain", "mm/mm")])
def test_a_strain_stays_in_the_unit_of_the_file(tmp_path, scale, name, unit):
    rows = [f"{0.5 * k:g},{u:g},{scale * x:g}" for k, (u, x) in enumerate(zip(U, X, strict=True))]
    path = tmp_path / "a.csv"
    path.write_text(f"time_s,T_degC,{name}\n" + "\n".join(rows) + "\n")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.unit == unit
    assert f"{unit} rms" in result.sentences()[0]
    np.testing.assert_allclose(result.tables[0].run["position"], scale * X, atol=1e-9)

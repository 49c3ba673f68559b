"""Names over a row of units: one row, or two that combine where the nearer one leaves columns out."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 40
T = np.round(60 - 35 * np.cos(np.linspace(0, 2 * np.pi, N)), 2)
DATA = np.column_stack(
    [10.0 * np.arange(N), T, np.round(T + 4 * np.sin(np.linspace(0, 6, N)), 2), np.round(T / 30, 3)]
)
UNITS = ["[s]", "[°C]", "[°C]", "[mm]"]
TITLE = ["Versuch Draht 7 - Gewicht 10 N"]
STACKED = [["Zeit", "Temperatur", "", "Weg"], ["", "Draht", "Ofen"]]
COMBINED = ("Zeit", "Temperatur Draht", "Temperatur Ofen", "Weg")


@pytest.fixture(params=["xlsx", ";", "\t"])
def saved(request, tmp_path):
    """Writes rows above the numbers, with a remark in a column far on the right, as a workbook or a text."""

    def save(above, data=DATA, remark=""):
        rows = [
            *above,
            *([*map(float, row), *[""] * 4, remark if k == 5 else ""] for k, row in enumerate(data)),
        ]
        if request.param != "xlsx":
            path = tmp_path / "a.csv"
            lines = [request.param.join(map(str, row)).rstrip(request.param) for row in rows]
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            return path
        openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
        book, path = openpyxl.Workbook(), tmp_path / "a.xlsx"
        for row in rows:
            book.active.append([cell if cell != "" else None for cell in row])
        book.save(path)
        return path

    return save


def table_of(path):
    (table,) = find_tables(path)
    return table.names[:4], [column.unit for column in table.columns[:4]]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("before", [[], [TITLE], [TITLE, ["Probe", "Draht 7"]]])
@pytest.mark.parametrize("remark", ["", "Taster hing kurz"])
def test_two_rows_combine(saved, before, remark):
    path = saved([*before, *STACKED, UNITS], remark=remark)
    assert table_of(path) == (COMBINED, ["s", "°C", "°C", "mm"])
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format=table.format, out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    run = load_run(report.run)
    np.testing.assert_allclose(run["temperature_degC"], DATA[:, 1])
    np.testing.assert_allclose(run["position"], DATA[:, 3])


@pytest.mark.parametrize(
    ("over", "near", "units", "names"),
    [
        (
            ["Time", "Wire", "", "Oven"],
            ["", "Temp", "Stroke", "Temp"],
            ["s", "degC", "mm", "degC"],
            ("Time", "Wire Temp", "Stroke", "Oven Temp"),
        ),
        (["Zeit", "Temperatur", "Temperatur", "Weg"], ["", "Draht", "Ofen", ""], UNITS, COMBINED),
        (
            ["t", "Sensor", "", ""],
            ["", "A", "B", "C"],
            ["s", "mm", "mm", "mm"],
            ("t", "Sensor A", "Sensor B", "Sensor C"),
        ),
    ],
)
def test_a_name_goes_on_to_columns_of_its_unit(saved, over, near, units, names):
    assert table_of(saved([over, near, units]))[0] == names


@pytest.mark.parametrize("remark", ["", "door opened"])
def test_one_row_of_names_over_units(saved, remark):
    names = ["Zeit", "Draht", "Ofen", "Weg"]
    assert table_of(saved([TITLE, names, UNITS], remark=remark)) == (tuple(names), ["s", "°C", "°C", "mm"])


def test_what_describes_named_columns_is_no_part_of_their_names(saved):
    names = ["Zeit", "Draht", "Ofen", "Weg"]
    assert table_of(saved([names, ["", "Typ K", "Typ J", ""], UNITS]))[0] == tuple(names)


def test_a_column_without_any_name_leaves_the_rows_as_they_are(saved):
    (table,) = find_tables(saved([["Zeit", "Temperatur", "", ""], ["", "Draht", "Ofen", ""], UNITS]))
    assert "Temperatur Draht" not in table.names

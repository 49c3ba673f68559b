"""Sheets of workbooks in long format, with pairs of clocks and values, or with units in their cells."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")

N = 60
T = np.round(62 - 38 * np.cos(np.linspace(0, 2 * np.pi, N)), 1)
S = np.round(2.4 + np.tanh((T - 60) / 9), 3)


def saved(tmp_path, **sheets):
    book, path = openpyxl.Workbook(), tmp_path / "a.xlsx"
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def check(path, names):
    table = find_tables(path)[0]
    assert table.names == names
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="xlsx", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    run = load_run(report.run)
    np.testing.assert_allclose(run["temperature_degC"], T)
    np.testing.assert_allclose(run["position"], S)
    np.testing.assert_allclose(run["t_s"], 2.0 * np.arange(N))
    return [finding.text for finding in report.findings]


LONG = [
    ["Tag", "Time [s]", "Value"],
    *([n, 2.0 * k, float(x[k])] for k in range(N) for n, x in (("T_C", T), ("s_mm", S))),
]
PAIRS = [
    ["Time [s]", "T [°C]", "Time [s]", "s [mm]"],
    *([2.0 * k, float(T[k]), 2.0 * k + 0.1, float(S[k])] for k in range(N)),
]
UNITS = [
    ["Time [s]", "Wire temperature", "Stroke"],
    *([2.0 * k, f"{T[k]} °C", f"{S[k]} mm"] for k in range(N)),
]


@pytest.mark.parametrize(
    ("rows", "names", "note"),
    [
        (LONG, ("Time [s]", "T_C", "s_mm"), "2 variables, which 'Tag' names"),
        (PAIRS, ("Time [s]", "T [°C]", "s [mm]"), "each with its own clock"),
        (UNITS, ("Time [s]", "Wire temperature [°C]", "Stroke [mm]"), "carry their units"),
    ],
)
@pytest.mark.parametrize("title", [[], [['Wire 7, 0.5 mm, 3" long'], []]])
def test_a_sheet_is_read_as_a_text_of_its_layout(tmp_path, rows, names, note, title):
    assert any(note in text for text in check(saved(tmp_path, Data=[*title, *rows]), names))


def test_a_sheet_that_is_refused_is_named_beside_another(tmp_path):
    mixed = [*UNITS[:30], [60.0, "50 °C", "3 N"]]
    with pytest.raises(DataError, match="'3 N' cannot be converted to mm"):
        find_tables(saved(tmp_path, Mixed=mixed))
    table = find_tables(saved(tmp_path, Mixed=mixed, Data=UNITS))[0]
    assert table.name == "Data"
    assert "cannot be converted" in table.left_out["Mixed"]

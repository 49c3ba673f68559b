"""Rows of statistics below a table, and texts, end it in a text file and in a workbook, and are reported."""

import numpy as np
import pytest

from extras import lacks
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 90
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 1)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 3)
HEAD = ["time [s]", "T [degC]", "x [mm]"]
FOOTERS = {
    "full rows": [["Mean", "60.1", "3.02"], ["Std. dev.", "24.8", "1.9"]],
    "another language": [["Mittelwert", "60.1", "3.02"], ["Größtwert", "95.0", "5.0"], ["n", "90", "90"]],
    "with gaps": [["max", "", "5.0"], ["min", "", "1.0"]],
    "a text below": [["Mean", "60.1", "3.02"], ["End of test"]],
}


def imported(path):
    (table, *_) = find_tables(path)
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format=table.format, out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return table, load_run(report.run), [finding.text for finding in report.findings]


def check(path, said):
    table, run, findings = imported(path)
    assert [column.kind for column in table.columns] == ["number"] * 3
    assert len(table) == ROWS
    np.testing.assert_allclose(run["input"], U)
    np.testing.assert_allclose(run["position"], X)
    assert any(said in text for text in findings), findings


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("footer", FOOTERS.values(), ids=FOOTERS)
@pytest.mark.parametrize("blank", [True, False])
@pytest.mark.parametrize("sign", [";", "\t"])
def test_statistics_end_a_text_table(write, footer, blank, sign):
    rows = [[str(k), str(u), str(x)] for k, (u, x) in enumerate(zip(U, X))]
    lines = [sign.join(row) for row in [HEAD, *rows, *([[]] if blank else []), *footer]]
    check(write("\n".join(lines) + "\n"), f"The lines from {ROWS + 2 + blank} on")


@pytest.mark.skipif(lacks("files"), reason="needs extra 'files'")
@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("footer", FOOTERS.values(), ids=FOOTERS)
@pytest.mark.parametrize("blank", [True, False])
def test_statistics_end_a_sheet(tmp_path, footer, blank):
    from openpyxl import Workbook

    book = Workbook()
    book.active.append(HEAD)
    for k, (u, x) in enumerate(zip(U, X)):
        book.active.append([k, float(u), float(x)])
    for row in [*([[]] if blank else []), *footer]:
        book.active.append([float(c) if c[:1].isdigit() else c or None for c in row])
    book.save(tmp_path / "a.xlsx")
    check(tmp_path / "a.xlsx", f"The rows from {ROWS + 2 + blank} on ('{footer[0][0]}")


def test_a_text_in_the_last_row_of_another_column_is_no_footer(write):
    rows = [f"{k},{u},{'Err' if k in (50, ROWS - 1) else x}" for k, (u, x) in enumerate(zip(U, X))]
    table, run, _ = imported(write("\n".join([",".join(HEAD), *rows]) + "\n"))
    assert len(table) == ROWS
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [50, ROWS - 1]

"""Marks of loggers for no reading are masked and counted; a row that holds them is a row, and no header."""

import numpy as np
import pytest

from extras import lacks
from smarig.cli import run as cli
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 120
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 1)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 3)
WORDS = (
    "BURNOUT",
    "+++++++",
    "-FFFFFFF",
    "OVER",
    "+OVER",
    "OL",
    "----",
    "-----------",
    "--OL--",
    "***OVER***",
)
NUMBERS = ("7.77777E+99", "+9.9E+37", "-9.91E+37", "INF", "+Inf", "-infinity")


def logger(mark, rows, columns=("CH2",), units="NO.,Time,degC,mm,A1234,A12"):
    """A file with names and units in two rows, and texts in its last two columns."""
    lines = ["Model,L8", "Number,Date&Time,CH1,CH2,Alarm,Out", *([units] if units else [])]
    for k, (u, x) in enumerate(zip(U, X)):
        cells = {"CH1": f" {u:+.1f}", "CH2": f" {x:+.3f}"}
        cells |= dict.fromkeys(columns, mark) if k in rows else {}
        stamp = f"2021/06/21 14:{k // 60:02d}:{k % 60:02d}"
        lines.append(f"{k + 1},{stamp},{cells['CH1']},{cells['CH2']},LLLL,LL")
    return "\n".join(lines) + "\n"


def imported(path):
    (table,) = find_tables(path)
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format=table.format, out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return load_run(report.run), [finding.text for finding in report.findings]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("mark", [*WORDS, *NUMBERS])
@pytest.mark.parametrize("rows", [(0,), (70,), (40, 41, 100)])
def test_a_mark_is_masked_and_counted(write, mark, rows):
    run, findings = imported(write(logger(mark, rows)))
    expected = X.copy()
    expected[list(rows)] = np.nan
    np.testing.assert_array_equal(run["position"], expected)
    sentence = (
        f"Column 'CH2': {len(rows)} of {ROWS} cells are masked, because '{mark}' stands for no reading."
    )
    assert sentence in findings
    assert not any("'CH2'" in text and "empty" in text for text in findings)


@pytest.mark.parametrize("mark", [*WORDS, "FAULT", "sensor off"])
def test_a_row_with_marks_is_no_header(write, mark):
    """Whose cells are texts by half, while most of its columns of numbers hold numbers."""
    (table,) = find_tables(write(logger(mark, (50, 51, 90))))
    assert table.names == ("Number", "Date&Time", "CH1", "CH2", "Alarm", "Out")
    assert len(table) == ROWS
    np.testing.assert_array_equal(table.columns[2].values, U)


def test_marks_in_rows_without_a_clock(write):
    """Read block by block, where a mark stops that."""
    rows = [f"{k},{u},{'OL' if k in (3, 60) else x}" for k, (u, x) in enumerate(zip(U, X))]
    run, findings = imported(write("\n".join(["time_s,T_degC,x_mm", *rows]) + "\n"))
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [3, 60]
    assert f"Column 'x_mm': 2 of {ROWS} cells are masked, because 'OL' stands for no reading." in findings


@pytest.mark.skipif(lacks("files"), reason="needs extra 'files'")
def test_marks_in_a_workbook(tmp_path):
    from openpyxl import Workbook

    book = Workbook()
    book.active.append(["time [s]", "T [degC]", "x [mm]"])
    for k, (u, x) in enumerate(zip(U, X)):
        book.active.append([k, float(u), {5: "OVER", 9: 9.9e37}.get(k, float(x))])
    book.save(tmp_path / "a.xlsx")
    run, findings = imported(tmp_path / "a.xlsx")
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [5, 9]
    assert any(text.startswith(f"Column 'x [mm]': 2 of {ROWS} cells are masked") for text in findings)


@pytest.mark.parametrize("text", ["NO.,Time,degC,mm,A1234,A12", "NO.,Time,[degC],[mm],-,-"])
def test_units_among_names(write, text):
    (table,) = find_tables(write(logger("OL", (), units=text)))
    assert table.names == ("Number", "Date&Time", "CH1", "CH2", "Alarm", "Out")
    assert [column.unit for column in table.columns][2:4] == ["degC", "mm"]


def test_a_name_in_the_row_of_units_is_the_name_of_its_column(write):
    rows = [f"{5 * k},{u},{x}" for k, (u, x) in enumerate(zip(U, X))]
    (table,) = find_tables(write("\n".join([",(1)T1,(1)X2", "Time(ms),degC,mm", *rows]) + "\n"))
    assert table.names == ("Time(ms)", "(1)T1", "(1)X2")
    assert [column.unit for column in table.columns] == ["", "degC", "mm"]
    run, _ = imported(table.path)
    np.testing.assert_allclose(run["t_s"], 0.005 * np.arange(ROWS))


def test_a_table_that_is_left_out_is_printed_with_its_rows(write, tmp_path, capsys):
    rows = [f"{k},{u},{x}" for k, (u, x) in enumerate(zip(U, X))]
    text = "\n".join(["step,a,b", *rows[:7], "", "time_s,T_degC,x_mm", *rows]) + "\n"
    assert cli(["study", str(write(text)), "--no-diagnosis", "-o", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr()
    assert "its columns (step, a, b) differ from those of the other tables; its 7 rows are not used" in (
        printed.err
    )


@pytest.mark.parametrize("word", ["Err", "-x-Fault-x-", "open loop", "E07", "§§"])
def test_a_rare_text_among_numbers_is_masked_and_counted(write, word):
    run, findings = imported(write(logger(word, (17, 88))))
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [17, 88]
    assert f"Column 'CH2': 2 of {ROWS} cells are masked, because '{word}' stands for no reading." in findings


@pytest.mark.parametrize("text", ["2.5 mm", "<3", "3.1.4"])
def test_a_text_that_may_be_a_number_is_not_masked(write, text):
    (table,) = find_tables(write(logger(text, (17, 88))))
    assert table.columns[3].kind == "text"


def test_many_texts_are_no_failed_readings(write):
    (table,) = find_tables(write(logger("off", range(0, ROWS, 3))))
    assert table.columns[3].kind == "text"


@pytest.mark.skipif(lacks("files"), reason="needs extra 'files'")
def test_a_rare_text_in_a_workbook(tmp_path):
    from openpyxl import Workbook

    book = Workbook()
    book.active.append(["time [s]", "T [degC]", "x [mm]"])
    for k, (u, x) in enumerate(zip(U, X)):
        book.active.append([k, float(u), "Err" if k in (5, 9) else float(x)])
    book.save(tmp_path / "a.xlsx")
    run, findings = imported(tmp_path / "a.xlsx")
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [5, 9]
    assert f"Column 'x [mm]': 2 of {ROWS} cells are masked, because 'Err' stands for no reading." in findings

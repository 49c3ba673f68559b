"""Files of data loggers: rows of units and of processing below the names, and signs apart from their digits."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

T = np.round(30 * np.sin(np.linspace(0, 12, 60)), 1)
X = np.round(np.tanh(T / 9), 4)
ENVIRONMENT = '"TOA5","CR1000X","CR1000X","12345","CR1000X.Std.05.01","CPU:sma.CR1X","4231","Table1"'


def found(tmp_path, lines, name="a.dat"):
    path = tmp_path / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    (table,) = find_tables(path)
    layout = {k: tuple(v) if k == "names" else v for k, v in table.layout["file"].items()}
    known = () if "names" in layout else table.names
    clock = next((c.name for c in table.columns if c.kind == "clock"), "")
    again = read_table(path, TableLayout(known=known, clock=clock, **layout))
    for column in table.columns:
        np.testing.assert_array_equal(again.columns[column.name], column.values)
    return table


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize(
    ("units", "known"),
    [
        ('"TS","RN","Deg C","mm","Volts"', ["Deg C", "mm", "Volts"]),
        ('"TS","RN","Deg_C","mm",""', ["Deg_C", "mm", ""]),
        ('"TS","RN","C","unitless","mV"', ["C", "", "mV"]),
        ('"TS","RN","","",""', ["", "", ""]),
    ],
)
@pytest.mark.parametrize(
    "processing", ['"","","Avg","Avg","Min"', '"","","Smp","Smp","Smp"', '"","","Avg","Smp","Min"']
)
def test_what_a_logger_computed_is_no_name(tmp_path, units, known, processing):
    names = ["TIMESTAMP", "RECORD", "Wire_Avg", "Stroke_Avg", "Batt_Min"]
    rows = [f'"2024-03-01 10:00:{k:02d}",{k},{T[k]},{X[k]},12.{k}' for k in range(60)]
    table = found(tmp_path, [ENVIRONMENT, ",".join(f'"{name}"' for name in names), units, processing, *rows])
    assert list(table.names) == names
    assert [c.unit for c in table.columns][2:] == known
    assert table.columns[2].comment == processing.split(",")[2].strip('"')


def padded(x, digits):
    return f"{'-' if x < 0 else '+'}{abs(x):>{digits + 6}.{digits}f}"


@pytest.mark.parametrize("delimiter", [",", "\t", ";", "  "])
def test_a_sign_apart_from_its_digits_belongs_to_the_number(tmp_path, delimiter):
    names = delimiter.join(["Time", "Temp", "Stroke"])
    rows = [delimiter.join([f"{0.5 * k:.1f}", padded(T[k], 1), padded(X[k], 4)]) for k in range(60)]
    table = found(tmp_path, [names, *rows], "a.csv")
    assert table.names == ("Time", "Temp", "Stroke")
    np.testing.assert_array_equal(table.columns[1].values, T)
    np.testing.assert_array_equal(table.columns[2].values, X)


def test_a_minus_apart_is_no_column_of_blanks(tmp_path):
    rows = [f"{k}\t{padded(T[k] - 50, 1)}\t{padded(X[k] - 2, 4)}" for k in range(60)]
    table = found(tmp_path, ["n\tTemp (degC)\tStroke (mm)", *rows], "a.txt")
    np.testing.assert_allclose(table.columns[1].values, T - 50)


def test_a_minus_alone_stays_a_missing_value(tmp_path):
    rows = [f"{k} {T[k]} {'-' if k == 7 else X[k]}" for k in range(60)]
    table = found(tmp_path, ["n T x", *rows], "a.txt")
    assert np.flatnonzero(np.isnan(table.columns[2].values)).tolist() == [7]

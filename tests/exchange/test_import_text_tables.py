"""Text tables of people: the same numbers for any delimiter, encoding and preamble."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from smarig.core.errors import DataError, SmarigError, UsageError
from smarig.exchange.runs.own_csv import read_own_csv
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

NUMBERS = np.array([[0.0, 1.5, -2e-3], [1.0, 2.5, 3e4], [2.0, -0.5, 7.0]])
KNOWN = TableLayout(known=("t", "a", "b"))


def _text(separator, *, decimal="."):
    rows = [separator.join(repr(float(x)).replace(".", decimal) for x in row) for row in NUMBERS]
    return separator.join("tab") + "\n" + "\n".join(rows) + "\n"


def _values(path, layout=KNOWN):
    table = read_table(path, layout)
    return np.column_stack([table.columns[name] for name in "tab"])


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "   ", " ,  "])
def test_any_delimiter_gives_the_same_numbers(write, separator):
    np.testing.assert_array_equal(_values(write(_text(separator))), NUMBERS)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_any_encoding_gives_the_same_numbers(write, encoding):
    path = write(("# 37 °C, messung für später\n" + _text(",")).encode(encoding))
    np.testing.assert_array_equal(_values(path), NUMBERS)


def test_latin_1_is_reported(write):
    table = read_table(write(("# °C\n" + _text(",")).encode("latin-1")), KNOWN)
    assert any("Latin-1" in note for note in table.notes)


def test_line_ends_and_a_trailing_delimiter_do_not_matter(write):
    path = write(_text(",").replace("\n", ",\r\n"))
    np.testing.assert_array_equal(_values(path), NUMBERS)


def test_decimal_comma_where_declared(write):
    path = write(_text(";", decimal=","))
    np.testing.assert_array_equal(_values(path, TableLayout(known=KNOWN.known, decimal=",")), NUMBERS)


def test_decimal_comma_is_suspected_where_not_declared(write):
    with pytest.raises(DataError, match=r"line 2, column 't': '0,0' is not a number; declare decimal = ','"):
        _values(write(_text(";", decimal=",")))


def test_a_preamble_is_skipped_and_reported(write):
    path = write("Logger 3000\nserial; 12345\n\n" + _text(";"))
    table = read_table(path, KNOWN)
    np.testing.assert_array_equal(table.columns["a"], NUMBERS[:, 1])
    assert table.line.tolist() == [5, 6, 7]
    assert any("2 line(s) before the table" in note for note in table.notes)


def test_without_header_the_names_are_given(write):
    path = write("garbage here\n" + _text("\t").split("\n", 1)[1])
    np.testing.assert_array_equal(_values(path, TableLayout(names=("t", "a", "b"))), NUMBERS)


def test_without_header_a_wrong_number_of_names_is_reported(write):
    path = write(_text("\t").split("\n", 1)[1])
    with pytest.raises(DataError, match="line 1 has 3 columns, but the mapping names 2"):
        read_table(path, TableLayout(names=("t", "a")))


@pytest.mark.parametrize("empty", ["", "nan", "NaN", "NA", "-"])
def test_empty_cells_become_nan_and_are_counted(write, empty):
    table = read_table(write(f"t,a,b\n0,1,2\n1,{empty},3\n2,5,6\n"), KNOWN)
    np.testing.assert_array_equal(table.columns["a"], [1, np.nan, 5])
    assert "Column 'a': 1 of 3 cells are empty or NaN." in table.notes


def test_a_truncated_last_line_is_dropped_and_reported(write):
    table = read_table(write("t,a,b\n0,1,2\n1,2,3\n2,5"), KNOWN)
    assert len(table) == 2
    assert any("line (4) is incomplete" in note for note in table.notes)


def test_the_fourth_of_many_tables_is_found_with_its_own_preamble(write):
    part = "Table {k}\nAmplitude: {k}00\nt [s]\ta\n0\t{k}\n1\t{k}\n\n"
    path = write("".join(part.format(k=k) for k in range(1, 7)))
    table = read_table(path, TableLayout(header_starts="t [s]", table=4))
    assert table.columns["a"].tolist() == [4.0, 4.0]
    assert table.header["Amplitude"] == "400"
    with pytest.raises(DataError, match=r"has 6 table\(s\).* there is no table 9"):
        read_table(path, TableLayout(header_starts="t [s]", table=9))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "is empty"),
        ("  \n \n", "is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00", "binary"),
        (
            b"MATLAB 5.0 MAT-file, written by Octave\x00\x01",
            r"MATLAB file\. Import it with --format mat .*--map",
        ),
        (
            b"MATLAB 7.3 MAT-file, Platform: PCWIN64\x00\x01",
            r"MATLAB file\. Import it with --format mat .*--map",
        ),
        ("t,a,b\n1,2,3\n", r"holds 1 sample\(s\)\. At least two"),
        ("t,a,b\n", r"holds 0 sample\(s\)"),
        ("t,a,a\n1,2,3\n2,3,4\n", "line 1: column 'a' appears more than once"),
        ("t,a,b\n1,2,3\n1,2,3,4\n", "line 3 has 4 cells, but the header names 3"),
        ("t,a,b\n1,2,3\n2,x7,4\n", "line 3, column 'a': 'x7' is not a number"),
        ("p,q\n1,2\n3,4\n", r"has other columns \(p, q\)"),
        ("1,2\n3,4\n", "no header row"),
    ],
)
def test_what_is_no_table_is_refused_in_one_sentence(write, content, said):
    with pytest.raises(DataError, match=said) as caught:
        _values(write(content))
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_the_users_mistake(tmp_path):
    with pytest.raises(UsageError, match="There is no file"):
        read_table(tmp_path / "nowhere.csv", KNOWN)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.one_of(st.binary(max_size=120), st.text('time_sA0123456789.,;\t\n -eNa"', max_size=200)))
def test_any_bytes_are_read_or_refused(tmp_path, content):
    path = tmp_path / "fuzz.csv"
    head = "time_s,current_A,position_mm\n"
    path.write_bytes(content if isinstance(content, bytes) else (head + content).encode())
    try:
        draft = read_own_csv(path)
    except SmarigError:
        return  # any other exception fails the test
    assert np.isfinite(draft.columns["t_s"]).all()

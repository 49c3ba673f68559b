"""Tables are found in text of any dialect: what was written is read back, and the drafted layout reads it again."""

import codecs
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarig.core import DataError
from smarig.exchange import find_tables, known_unit
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

NAMES = ("Zeit", "Temperatur", "Weg")
UNITS = ("s", "°C", "mm")
DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": " "}


def written(
    values, *, delimiter=";", decimal=".", thousands="", units="none", prose=0, sep=False, trailing=0, again=0
):
    """A table as text; an independent writer of the dialects."""

    def cell(x):
        text = f"{x:.3f}"
        whole, fraction = text.split(".")
        if thousands:
            sign, digits = ("-", whole[1:]) if whole.startswith("-") else ("", whole)
            groups = []
            while digits:
                groups.insert(0, digits[-3:])
                digits = digits[:-3]
            whole = sign + thousands.join(groups)
        return whole + decimal + fraction

    names = [f"{n} [{u}]" if units == "brackets" else n for n, u in zip(NAMES, UNITS)]
    header = delimiter.join(names) + delimiter * trailing
    lines = [f"sep={delimiter}"] if sep else []
    lines += ["Messung vom 3. Mai", "Operator: Meier", "", "Sample: A 7"][:prose]
    lines.append(header)
    if units == "row":
        lines.append(delimiter.join(UNITS) + delimiter * trailing)
    for k, row in enumerate(values):
        if again and k == again:
            lines.append(header)
        lines.append(delimiter.join(cell(x) for x in row) + delimiter * trailing)
    return "\n".join(lines) + "\n"


def loop(rows=40, size=1.0, seed=1):
    rng = np.random.default_rng(seed)
    t = np.arange(rows) * 0.5
    u = 60 - 40 * np.cos(2 * np.pi * t / t[-1])
    return np.column_stack([t, u + rng.normal(0, 0.1, rows), size * np.tanh((u - 60) / 20)])


@pytest.mark.long("takes a second")
@settings(max_examples=60, deadline=None)
@given(
    delimiter=st.sampled_from(sorted(DELIMITERS)),
    decimal=st.sampled_from(".,"),
    thousands=st.sampled_from(["", ".", ",", "'"]),
    units=st.sampled_from(["none", "row", "brackets"]),
    prose=st.integers(0, 4),
    sep=st.booleans(),
    trailing=st.integers(0, 2),
    again=st.sampled_from([0, 7]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1"]),
    size=st.sampled_from([1.0, 30.0, 54321.0]),
)
def test_what_was_written_in_a_dialect_is_read_back(
    tmp_path_factory, delimiter, decimal, thousands, units, prose, sep, trailing, again, encoding, size
):
    sign = DELIMITERS[delimiter]
    if sign in (decimal, thousands) or decimal == thousands:
        return  # nobody can read that
    if delimiter == "space":
        units, trailing, prose, sep = ("none" if units == "brackets" else units), 0, 0, False
    values = loop(size=size)
    text = written(
        values,
        delimiter=sign,
        decimal=decimal,
        thousands=thousands,
        units=units,
        prose=prose,
        sep=sep and delimiter != "space",
        trailing=trailing,
        again=again,
    )
    path = tmp_path_factory.mktemp("dialect") / "data.csv"
    path.write_bytes(text.encode(encoding))
    (table,) = find_tables(path)
    np.testing.assert_allclose(
        np.column_stack([c.values for c in table.columns]), np.round(values, 3), atol=1e-9
    )
    assert [c.name.split(" [")[0] for c in table.columns] == list(NAMES)
    if units == "row":
        assert [c.unit for c in table.columns] == list(UNITS)
    again_read = read_table(path, layout_of(table))
    for column in table.columns:
        np.testing.assert_array_equal(again_read.columns[column.name], column.values)


def layout_of(table) -> TableLayout:
    """The layout that a mapping with the drafted [file] table describes."""
    entries = table.layout["file"]
    return TableLayout(
        known=() if "names" in entries else table.names,
        **{key: tuple(value) if key == "names" else value for key, value in entries.items()},
    )


CASES = {
    "a decimal comma in a comma-separated file, quoted": (
        'a,b\n"1,5","2,5"\n"2,5","3,5"\n"3,5","4,5"\n',
        [[1.5, 2.5], [2.5, 3.5], [3.5, 4.5]],
    ),
    "words for missing values": (
        "a;b\n1;n/a\n2;#NV\n3;5\n;6\nNaN;7\n",
        [[1, np.nan], [2, np.nan], [3, 5], [np.nan, 6], [np.nan, 7]],
    ),
    "empty columns at the end": ("a;b;;;\n1;2;;;\n3;4;;;\n5;6;;;\n", [[1, 2], [3, 4], [5, 6]]),
    "blanks after commas": ("a, b\n1, 2\n3, 4\n5, 6\n", [[1, 2], [3, 4], [5, 6]]),
    "a comment sign before the names": ("# t  x\n1 2\n3 4\n5 6\n", [[1, 2], [3, 4], [5, 6]]),
    "comments between the rows": ("a b\n1 2\n# pause\n3 4\n5 6\n", [[1, 2], [3, 4], [5, 6]]),
    "no names": ("1\t2\n3\t4\n5\t6\n", [[1, 2], [3, 4], [5, 6]]),
    "names twice": ("a;a\n1;2\n3;4\n5;6\n", [[1, 2], [3, 4], [5, 6]]),
    "fewer names than columns": ("a b\n1 2 9\n3 4 9\n5 6 9\n", [[1, 2, 9], [3, 4, 9], [5, 6, 9]]),
    "exponents with capital letters": (
        "a;b\n1,0E+00;2,5E-3\n2,0E+00;3,5E-3\n3E0;1\n",
        [[1, 0.0025], [2, 0.0035], [3, 1]],
    ),
    "apostrophes": ("a;b\n1'000.5;1\n2'000.5;2\n3'000.5;3\n", [[1000.5, 1], [2000.5, 2], [3000.5, 3]]),
}


@pytest.mark.parametrize("name", CASES)
def test_further_dialects(write, name):
    text, expected = CASES[name]
    (table,) = find_tables(write(text))
    np.testing.assert_array_equal(np.column_stack([c.values for c in table.columns]), expected)
    assert len(set(table.names)) == len(table.names)
    again = read_table(table.path, layout_of(table))
    np.testing.assert_array_equal(np.column_stack(list(again.columns.values())), expected)


def test_clock_times_become_seconds(write):
    text = "Datum;T\n01.03.2024 23:59:58,5;1,5\n01.03.2024 23:59:59,5;2,5\n02.03.2024 00:00:01,0;3,5\n"
    (table,) = find_tables(write(text))
    assert table.columns[0].kind == "clock"
    np.testing.assert_allclose(table.columns[0].values, [0.0, 1.0, 2.5])


def test_several_tables_in_one_file(write):
    a, b = loop(30, seed=2), loop(25, seed=3)
    text = f"Run 1\n{written(a)}\nRun 2\nRate: 5\n{written(b)}"
    first, second = find_tables(write(text))
    np.testing.assert_allclose(first.columns[2].values, a[:, 2], atol=6e-4)
    np.testing.assert_allclose(second.columns[2].values, b[:, 2], atol=6e-4)
    assert second.header["Rate"] == "5"
    for table in (first, second):
        np.testing.assert_array_equal(
            read_table(table.path, layout_of(table)).columns["Weg"], table.columns[2].values
        )


@pytest.mark.parametrize("rows", [3, 6])
def test_groups_of_equal_names_below_a_small_table(write, rows):
    """A list of specimens, and below it the readings of each, side by side."""
    a = loop(40, seed=4)
    small = "\n".join(f"S{k};0,3;{20 + k},5" for k in range(rows))
    body = "\n".join(";".join(f"{x:.3f}".replace(".", ",") for x in (*row, *row)) for row in a)
    names = ";".join(["Zeit", "Kraft", "Weg"] * 2)
    path = write(f"Probe;Durchmesser;L0\n;mm;mm\n{small}\n\n{names}\ns;N;mm;s;N;mm\n{body}\n")
    first, second = find_tables(path)
    assert (len(first), len(second)) == (rows, 40)
    assert (first.name, second.name) == (f"lines 3 to {rows + 2}", "table 1")
    assert second.names == ("Zeit", "Kraft", "Weg", "Zeit (2)", "Kraft (2)", "Weg (2)")
    again = read_table(path, layout_of(second))
    np.testing.assert_allclose(again.columns["Weg (2)"], a[:, 2], atol=6e-4)


@pytest.mark.parametrize(
    "content",
    [b"", b"some words\nand more\n", b"\x00\x01\x02" * 400, codecs.BOM_UTF16_LE, b"1\n2\n3\n", b"a,b\n1,2\n"],
    ids=["empty", "words", "bytes", "mark only", "one column", "one row"],
)
def test_what_holds_no_table_is_refused_in_one_sentence(write, content):
    with pytest.raises(DataError) as caught:
        find_tables(write(content))
    assert "\n" not in str(caught.value)


def test_random_bytes_are_a_table_or_refused_in_one_sentence(write):
    signs = [*b"0123456789,.;\t -+eE\n\n\"'#:()[]", 0, 200, 255]
    rng = random.Random(7)
    refusals = []
    for k in range(120):
        path = write(bytes(rng.choice(signs) for _ in range(rng.randrange(300))), f"{k}.txt")
        try:
            find_tables(path)
        except DataError as error:
            refusals.append(str(error))
    assert refusals
    assert not any("\n" in sentence for sentence in refusals)


@pytest.mark.parametrize("unit", ["Cel", "cel", "[CEL]"])
def test_celsius_of_unit_codes(write, unit):
    rows = [f"{0.5 * k}\t{20 + k}\t{3 - 0.1 * k:.2f}" for k in range(30)]
    (table,) = find_tables(write("\n".join(["t\tprobe\tx", f"s\t{unit}\tmm", *rows])))
    assert [known_unit(column.unit) for column in table.columns] == ["s", "degC", "mm"]

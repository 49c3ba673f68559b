"""Several lines over a table, lines under it, and words among its numbers: which are names, units, events, a footer."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, preamble_lines
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

VALUES = np.round(np.random.default_rng(4).normal(20, 5, (12, 4)), 3)


def rows(sign, decimal=".", values=VALUES):
    return [sign.join(f"{x:.3f}".replace(".", decimal) for x in row) for row in values]


def found(path, lines, sep="\n"):
    """The table of a text, and the same as it is read again by its layout."""
    path.write_text(sep.join(lines) + sep, encoding="utf-8", newline="")
    (table,) = find_tables(path)
    words = tuple(c.name for c in table.columns if c.kind == "text")
    return table, read_table(
        path, TableLayout(**({"known": table.names, "text": words} | table.layout["file"]))
    )


@pytest.mark.parametrize("sign", ["\t", ";"])
@pytest.mark.parametrize(
    "below", [["Dev_1 K 1 id:7", "Dev_1 K 1", "Dev_1 K 2", "computed"], ["a", "b", "c", "d"]]
)
def test_names_stand_where_units_are_in_brackets(tmp_path, sign, below):
    names = ("Zeit  2 - langsam [s]", "Last (Kanal 1) [kN]", "Hub [mm]", "T_Probe [°C]")
    table, again = found(
        tmp_path / "a.asc", ["Rate:\t2 Hz", "", sign.join(names), sign.join(below), *rows(sign, ",")]
    )
    assert table.names == names
    assert [c.comment for c in table.columns] == below
    np.testing.assert_allclose(np.column_stack(list(again.columns.values())), VALUES)


@pytest.mark.parametrize(
    ("names", "units", "expected"),
    [
        (
            "   Row         time           Ts        Value",
            "              [min]         [°C]         [mW]",
            "-min °C mW",
        ),
        ("No.     t          Force      dL", "                   [N]        [µm]", "- - N µm"),
        ("t       Ts         Tr         Value", "[s]     [°C]       [°C]", "s °C °C -"),
    ],
)
def test_units_belong_to_the_names_that_they_stand_below(tmp_path, names, units, expected):
    width = [f"{k:6d} {a:12.4f} {b:12.4f} {c:12.4f}" for k, (a, b, c, _) in enumerate(VALUES)]
    table, again = found(tmp_path / "a.txt", ["Values:", names, units, *width])
    assert table.names == tuple(names.split())
    assert [c.unit or "-" for c in table.columns] == expected.replace("-min", "- min").split()
    np.testing.assert_allclose(again.columns[table.names[1]], VALUES[:, 0], atol=1e-4)


FOOTER = [
    "",
    "Results:",
    "Sample:",
    "  wire 7, 15.3 mg",
    "  step [1] 20.0..80.0 °C, 5.00 K/min",
    "  v exo down",
]


@pytest.mark.parametrize("sign", [" ", "\t", ";"])
@pytest.mark.parametrize("footer", [FOOTER, FOOTER[1:3], ["End of data at 12:01 after 12 rows"]])
def test_a_footer_ends_the_table(tmp_path, sign, footer):
    head = sign.join(["t", "T", "F", "x"])
    path = tmp_path / "a.txt"
    table, again = found(path, [head, *rows(sign), *footer])
    assert len(table) == len(again) == len(VALUES)
    start = next(line for line in footer if line)
    assert preamble_lines(path)[-1] == footer[-1]
    line = len(VALUES) + 2 + footer.index(start)
    assert f"The lines from {line} on ('{start}') stand after the table." in again.notes


@pytest.mark.parametrize("bad", ["20.1;oops;1;2", "note"])
def test_a_word_among_the_rows_is_no_footer(tmp_path, bad):
    lines, path = rows(";"), tmp_path / "a.txt"
    path.write_text("\n".join(["t;T;F;x", *lines[:4], bad, *lines[4:]]) + "\n")
    with pytest.raises(DataError, match=r"line 6, column '[tT]': '(oops|note)' is not a number"):
        read_table(path, TableLayout(known=("t", "T", "F", "x")))


def test_numbered_names_before_a_mark_of_the_end(tmp_path):
    head = ["# REM controller 4", "#", "# RATE = 1", "# NAME1 = Time", "# NAME2 = Voltage of Channel 1"]
    head += ["# NAME3 = Position of axis 1", "#", "# END_HEADER"]
    table, again = found(tmp_path / "a.dat", [*head, *rows(" ", values=VALUES[:, :3])])
    assert table.names == ("Time", "Voltage of Channel 1", "Position of axis 1")
    np.testing.assert_allclose(again.columns["Position of axis 1"], VALUES[:, 2])


def test_numbers_in_the_row_of_units_are_constants(tmp_path):
    lines = [f"{k},{a:.3f},{b:.3f},," for k, (a, b, *_) in enumerate(VALUES)]
    table, again = found(
        tmp_path / "a.csv", ["X,CH1,CH2,Start,Increment,", "Sequence,Volt,Volt,-2.0e+00,4.0e-03,", *lines]
    )
    assert table.header == {"Start": "-2.0e+00", "Increment": "4.0e-03"}
    assert [c.unit for c in table.columns[1:3]] == ["Volt", "Volt"]
    np.testing.assert_allclose(again.columns["CH2"], VALUES[:, 1])


@pytest.mark.parametrize("events", [["13,,,on,,", "14,,,,stop,end"], ["13,21.0,4.0,on,", "14,,,on,on,end"]])
def test_words_in_columns_of_events_are_no_readings(tmp_path, events):
    lines = [f"{k + 1},{a:.3f},{b:.3f},,," for k, (a, b, *_) in enumerate(VALUES)]
    names = "No,Temp (°C),Force (N),Button,Host,End"
    table, again = found(tmp_path / "a.csv", ["Title: a", names, *lines, *events])
    kinds = {c.name: c.kind for c in table.columns}
    assert len(again) == len(VALUES) + 2
    assert kinds["Button"] == "text"
    assert kinds["Temp (°C)"] == kinds["Force (N)"] == "number"
    np.testing.assert_allclose(again.columns["Force (N)"][:12], VALUES[:, 1])


def test_unknown_words_among_units_are_units(tmp_path):
    names, units = ("Time", "Load", "Load limit", "Turns"), ("s", "kip", "kip", "laps")
    wide = [*names, "Oven", "Stage"], [*units, "deg_F", "parsecs"]
    lines = ["Test\t7\t\t\tmill", *("\t".join(row) for row in wide)]
    lines += ["\t".join([row, row.split("\t")[0], "7.5"]) for row in rows("\t")]
    table, _ = found(tmp_path / "a.dat", lines)
    assert [c.unit for c in table.columns] == wide[1]


def test_words_below_names_are_no_units_beside_few_units(tmp_path):
    lines = ["Zeit;Kraft;Hub;Temp", "s;Kanal 1;links;Draht", *rows(";")]
    table, _ = found(tmp_path / "a.csv", lines)
    assert [c.unit for c in table.columns][1:] == ["", "", ""]

"""Text tables with hostile contents: read, or refused in one sentence and in time linear in their size."""

import csv
from pathlib import Path

import pytest

from smarig.control.tracking.reference import reference_from_csv
from smarig.core.errors import DataError, UsageError
from smarig.exchange import export_run
from smarig.exchange.tables.found_table import FoundTable
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout
from smarig.exchange.text.clock_cells import clock_seconds
from smarig.protocols import Setup, build_protocol
from smarig.record import Recorder
from smarig.study.typed_names import own_name

HEAD = "time_s,current_command_A,position_mm\n"
LAYOUT = TableLayout(known=("time_s", "current_command_A", "position_mm"))
REFUSED = {
    "quoted": (
        HEAD + '0,0,"' + "x" * 200_000 + '"\n1,0,0\n',
        "a cell in quotes has more than 131072 characters",
    ),
    "underscore": (HEAD + "0,0,1_000\n1,0,0\n", "line 2, column 'position_mm': '1_000' is not a number"),
    "full width": (HEAD + "0,0,１２\n1,0,0\n", "line 2, column 'position_mm': '１２' is not a number"),
    "many columns": (
        "time_s," + ",".join(f"c{k}" for k in range(20_000)) + "\n" + "1,1\n" * 9,
        "has 20001 columns",
    ),
    "long line": (HEAD + "1" * 1_000_001 + "\n", "line 2 has 1000001 characters"),
    "escape": (HEAD + "0,0,\x1b[2J\n1,0,0\n", r"'\x1b[2J' is not a number"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_a_hostile_table_is_refused_in_one_sentence(write, kind):
    content, says = REFUSED[kind]
    with pytest.raises(DataError) as refusal:
        read_table(write(content), LAYOUT)
    assert says in str(refusal.value)
    assert str(refusal.value).isprintable()


@pytest.mark.parametrize(
    "line", ["1" * 9000 + "x", "1 " * 4000 + "x", "1" + " " * 9000 + "x", "1,2" + ",1e5" * 2000 + "x"]
)
def test_no_line_of_a_forc_file_takes_more_than_linear_time(line):
    """Twenty thousand such lines: with a pattern that tries a line in two ways, one would take minutes."""
    from smarig.exchange.tables.forc_file import _DATA

    assert not any(_DATA.fullmatch(line) for _ in range(300))


def test_a_forc_file_of_long_lines_is_refused(write, imported):
    with pytest.raises(DataError, match="line 2 has 20000 characters"):
        imported(write("MicroMag 2900\n" + "1" * 20_000 + "\n"), "forc")


@pytest.mark.parametrize("cell", ["1_0", "２０", "x" * 1000])
def test_a_profile_and_a_reference_hold_numbers_only(write, cell):
    profile = write(f"temperature_K\n{cell}\n")
    with pytest.raises(DataError, match="line 2: '.{2,40}' is not a number"):
        next(build_protocol("step_currents", Setup.of("one_wire_twin"), {"file": str(profile)}))
    with pytest.raises(UsageError, match="is not a finite number"):
        reference_from_csv(write(f"time_s,position_mm\n0,{cell}\n1,1\n"), "mm")


@pytest.mark.parametrize(
    "unit", ["\n=cmd|calc!A0", "x\r=1+1", 'mm",\n=1+1,"', "\u2028@x", "a,=1", "=cmd|calc!A0", "\x1b[2J"]
)
def test_no_unit_starts_a_cell_of_an_exported_table(tmp_path, unit):
    """A spreadsheet executes a cell that starts with = + - @."""
    from record.runs import META, sample

    own = Recorder(tmp_path / "a.run.sqlite", {**META, "output": {"unit": unit}, "input": {"unit": unit}})
    for tick in range(3):
        own.sample(sample(tick), 0, 1.0)
    own.close()
    path = export_run(own.path, to="csv", out=tmp_path / "a.csv")
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) == 4
    assert all(c.isprintable() or c == "\n" for c in text)
    header, *rows = csv.reader(text.splitlines())
    assert all(name[0].isalpha() for name in header)
    assert all(len(row) == len(header) for row in rows)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"SQLite format 3\x00", "was cut off after 16 byte"),
        (b"<!DOCTYPE html><html></html>", "is a page, not a table of numbers"),
        (b"\x89PNG\r\n\x1a\n", "is a picture, not a table of numbers"),
    ],
)
def test_a_reference_of_another_kind_is_named(write, content, said):
    with pytest.raises(UsageError, match=said):
        reference_from_csv(write(content), "mm")


def test_numbers_of_any_length_are_texts_where_small_ones_are_meant():
    digits = "9" * 5000
    assert clock_seconds(f"{digits} 00:00:01") is None
    assert (
        own_name(FoundTable(Path("a.csv"), "csv", "", (), {}, {}), f"column {digits}") == f"column {digits}"
    )

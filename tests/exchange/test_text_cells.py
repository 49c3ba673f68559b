"""Cells that hold text are not called empty: remarks, states of alarms, dates beside a clock."""

import pytest

from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

FIRST = {"remark": ["", "", "door open", "", ""], "state": ["LLLL", "LLLL", "LLHL", "LLLL", "LLLL"]}


def notes_of(tmp_path, name, cells, sign=","):
    path = tmp_path / "a.csv"
    rows = [f"{k}{sign}{cell}{sign}{k / 7:.3f}" for k, cell in enumerate(cells)]
    path.write_text("\n".join([sign.join(["t", name, "x"]), *rows]) + "\n", encoding="utf-8")
    table = read_table(path, TableLayout(known=("t", name, "x"), text=(name,)))
    return [note for note in table.notes if "Column" in note]


@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize("name", ["Bemerkung", "Alarm1-10"])
@pytest.mark.parametrize(
    ("cells", "words"),
    [
        (FIRST["remark"], "1 of 5 cells holds text: 'door open'."),
        (FIRST["state"], "all cells hold text, as 'LLLL'."),
        (["a", "", "b", "", ""], "2 of 5 cells hold text, as 'a'."),
        (["a", "1", "2", "3", "4"], "1 of 5 cells holds text: 'a'."),
    ],
)
def test_text_is_not_empty(tmp_path, sign, name, cells, words):
    assert notes_of(tmp_path, name, cells, sign) == [f"Column '{name}': {words}"]


def test_what_is_missing_beside_numbers_is_said_too(tmp_path):
    notes = notes_of(tmp_path, "y", ["1", "", "late", "nan", "5"])
    assert notes == [
        "Column 'y': 1 of 5 cells holds text: 'late'.",
        "Column 'y': 2 of 5 cells are empty or NaN.",
    ]


def test_a_long_remark_is_cut(tmp_path):
    (note,) = notes_of(tmp_path, "y", ["w" * 500, "", "", "", ""])
    assert len(note) < 120

"""A table that is read block by block is the table that is read at once, with the same notes and the same errors."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarig.core.errors import DataError
from smarig.exchange import import_file
from smarig.exchange.tables import table_file
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout, read_whole_table
from smarig.exchange.text.number_blocks import numbers_of
from smarig.record import load_run

CELLS = (
    "0",
    "-1.5",
    "2.25e-3",
    "1e400",
    "nan",
    "NA",
    "n",
    "",
    " ",
    " 7 ",
    "1_000",
    "1,5",
    "inf",
    "-",
    "x",
    '"3"',
)
BREAKS = ("\n", "\r\n", "\r", "\n\n", "\n# note\n", "\x0b", " \n")


def outcome(read, path, layout):
    """All that reading gives: the table or the sentence of its error."""
    try:
        table = read(path, layout)
    except DataError as error:
        return str(error)
    columns = {name: column.tolist() for name, column in table.columns.items()}
    return repr((columns, table.line.tolist(), table.header, table.notes))


@st.composite
def texts(draw):
    """A header and rows: mostly numbers, with whatever a file may hold in between."""
    delimiter, width = draw(st.sampled_from([",", ";", "\t", " "])), draw(st.integers(1, 3))
    cell = st.one_of(st.floats(-1e3, 1e3).map(repr), st.sampled_from(CELLS))
    plain = st.lists(st.floats(-1e3, 1e3).map(repr), min_size=width, max_size=width)
    row = st.one_of(plain, plain, plain, st.lists(cell, min_size=max(width - 1, 1), max_size=width + 1))
    rows = draw(st.lists(row, min_size=1, max_size=12))
    ends = [draw(st.sampled_from(["\n"] * 6 + list(BREAKS))) for _ in rows]
    body = "".join(delimiter.join(cells) + end for cells, end in zip(rows, ends))
    head = delimiter.join("tab"[:width])
    return (
        draw(st.sampled_from(["", "rig: α\n", "# made\n"]))
        + head
        + "\n"
        + body[: draw(st.integers(1, len(body)))]
    )


@given(texts(), st.sampled_from([1, 7, 30, 1000]), st.sampled_from(".,"))
@example("t,a\n0,1\n1,2\n2,1_0\n3,4\n", 7, ".")
@example("t,a\n0,1\n1,2\n2,3,4\n3,x\n", 1, ".")
@example("t,a\n0,1\n1,x\n2,3,4\n", 1, ".")  # a wrong number of cells is reported before what is no number
@example("t,a\n0,1\n1,1e400\n2,x\n", 1, ".")
@example("t,a\n0,1\n1,2\n2,3\n3", 1, ".")
@example("t,a\n0,\n,2\n,\n3,4\n", 1000, ".")
@example("t,a\n0,1\n1,1e400\n", 1000, ".")
@example("t,a\n" + 250 * "0,1\n" + "0,1\x0b1,2\n2,3\n3,4\n", 7, ".")
@example("t,a\n" + 250 * "0,1\n" + "0,1\r\r\n2,3\n3,4\n", 7, ".")
@example("t,a\n0,1\n1,2\n\n2,3\n3,4\n", 1000, ".")
@example("t,a\n0,1,2\n1,2,3\n", 1000, ".")
@example("t;a\n0;1,5\n1;2.5\n", 7, ",")
@example("t\n0\n\n1\n2\n", 1000, ".")
@example("t a\n0  1\n 1 2\n2 3 \n", 1000, ".")
def test_the_size_of_a_block_changes_nothing(tmp_path_factory, text: str, size: int, decimal: str):
    path = tmp_path_factory.mktemp("blocks") / "a.csv"
    path.write_bytes(text.encode())
    for layout in (
        TableLayout(known=("t", "a", "b"), decimal=decimal),
        TableLayout(names=("u", "v"), decimal=decimal),
    ):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(table_file, "BLOCK_BYTES", size)
            found = outcome(read_table, path, layout)
        assert found == outcome(read_whole_table, path, layout)


@pytest.mark.parametrize("delimiter", [",", ";", "\t", None])
def test_numbers_are_those_of_float(delimiter):
    rng = np.random.default_rng(3)
    values = rng.normal(size=(50, 4)) * 10.0 ** rng.integers(-300, 300, (50, 4))
    texts = [[repr(v) for v in row] for row in values.tolist()]
    texts[7] = ["1.7976931348623157e308", "5e-324", "0.1", "-0"]
    block = "".join((delimiter or "  ").join(row) + "\r\n" for row in texts).encode()
    found = numbers_of(block, 4, delimiter)
    assert found is not None
    np.testing.assert_array_equal(found, [[float(cell) for cell in row] for row in texts])
    assert np.signbit(found[7, 3])


def test_plain_blocks_take_the_short_way(tmp_path, monkeypatch):
    """The careful reader sees the one block that is not plain, and no other."""
    path = tmp_path / "a.csv"
    path.write_text("t,a\n" + "".join(f"{k},{'n/a' if k == 500 else k}\n" for k in range(1000)))
    seen = []
    careful = table_file.text_table.cells
    monkeypatch.setattr(table_file, "BLOCK_BYTES", 512)
    monkeypatch.setattr(
        table_file.text_table,
        "cells",
        lambda path, lines, *rest: seen.append(lines) or careful(path, lines, *rest),
    )
    table = read_table(path, TableLayout(known=("t", "a")))
    assert [any("n/a" in line for line in lines) for lines in seen] == [True]
    assert np.flatnonzero(np.isnan(table.columns["a"])).tolist() == [500]
    assert table.line.tolist() == list(range(2, 1002))


def test_an_error_far_down_names_its_line(tmp_path, monkeypatch):
    monkeypatch.setattr(table_file, "BLOCK_BYTES", 512)
    path = tmp_path / "a.csv"
    lines = [f"{0.1 * k:.1f},0.5,{k % 7}" for k in range(3000)]
    lines[2400] = "240.0,0.5,1.2.3"
    path.write_text("time_s,current_A,position_mm\n" + "\n".join(lines) + "\n")
    with pytest.raises(DataError, match=r"a\.csv, line 2402, column 'position_mm': '1.2.3' is not a number"):
        import_file(path, format="csv", out=tmp_path / "a.run.sqlite")
    lines[2400] = "240.0,0.5,5"
    path.write_text("time_s,current_A,position_mm\n" + "\n".join(lines) + "\n")
    import_file(path, format="csv", out=tmp_path / "a.run.sqlite")
    assert load_run(tmp_path / "a.run.sqlite")["position"][2399:2402].tolist() == [5.0, 5.0, 0.0]

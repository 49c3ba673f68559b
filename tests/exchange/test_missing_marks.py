"""What C libraries write for "not a number" is a missing reading, in every table that smarig reads."""

import numpy as np
import pytest

from extras import lacks
from smarig.exchange import find_tables
from smarig.exchange.text.no_reading import is_missing

MARKS = (
    "-nan(ind)",
    "nan(ind)",
    "-nan",
    "NaN",
    "nan(snan)",
    "-nan(snan)",
    "1.#QNAN",
    "-1.#IND",
    "1.#IND00",
    "-1.#J",
    "1.#INF",
    "-∞",
)
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, 40)), 3)


def text(mark, delimiter=",", header="time_s,T_degC,x_mm"):
    rows = [[0.5 * k, u, (u - 60) / 20] for k, u in enumerate(U)]
    cells = [[f"{x:.4f}" for x in row] for row in rows]
    cells[7][1] = cells[30][2] = mark
    return "\n".join([header.replace(",", delimiter), *map(delimiter.join, cells)]) + "\n"


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("mark", MARKS)
@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
def test_a_mark_is_a_missing_reading(write, mark, delimiter):
    (table,) = find_tables(write(text(mark, delimiter)))
    assert table.names == ("time_s", "T_degC", "x_mm")
    assert [column.kind for column in table.columns] == ["number"] * 3
    missing = [np.flatnonzero(np.isnan(column.values)).tolist() for column in table.columns]
    assert missing == [[], [7], [30]]


@pytest.mark.parametrize("mark", MARKS)
def test_a_mark_in_the_own_format(write, imported, mark):
    rows = [f"{0.5 * k},0.2,{mark if k == 30 else u}" for k, u in enumerate(U)]
    run = imported(write("time_s,current_A,position_mm\n" + "\n".join(rows) + "\n"))
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [30]


@pytest.mark.skipif(lacks("files"), reason="needs extra 'files'")
def test_a_mark_in_a_workbook(tmp_path):
    from openpyxl import Workbook

    book = Workbook()
    for row in text("-nan(ind)").splitlines():
        cells = row.split(",")
        book.active.append([float(c) if c[-1].isdigit() else c for c in cells])
    book.save(tmp_path / "a.xlsx")
    (table,) = find_tables(tmp_path / "a.xlsx")
    assert np.flatnonzero(np.isnan(table.columns[1].values)).tolist() == [7]


@pytest.mark.parametrize("mark", ["1,#QNAN", "-1,#IND", "1,#INF00", "-1,#J"])
def test_a_mark_with_a_decimal_comma(write, mark):
    lines = text("MARK", ";").replace(".", ",").replace("MARK", mark)
    (table,) = find_tables(write(lines))
    assert [column.kind for column in table.columns] == ["number"] * 3
    missing = [np.flatnonzero(np.isnan(column.values)).tolist() for column in table.columns]
    assert missing == [[], [7], [30]]


@pytest.mark.parametrize("cell", ["nano", "1.#", "nan nan", "1,#", "banana", "1.5"])
def test_other_texts_are_no_missing_readings(cell):
    assert not is_missing(cell)

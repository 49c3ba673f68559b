"""A JSON document is a table by its shape, on one line or many; what is no table is refused in one clear sentence."""

import csv
import json

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

NAMES = ["time", "temperature", "strain"]
U = np.round(70 - 50 * np.cos(np.linspace(0, 12, 300)), 3)
ROWS = [[0.5 * k, u, round(float(np.tanh((u - 70) / 9)), 5)] for k, u in enumerate(U.tolist())]
SERIES = {"name": "wire", "columns": NAMES, "values": ROWS}
SHAPES = {
    "series with columns": {"results": [{"statement_id": 0, "series": [SERIES]}]},
    "names and rows": [NAMES, *ROWS],
    "object of arrays": dict(zip(NAMES, map(list, zip(*ROWS)))),
    "array of objects": [dict(zip(NAMES, row)) for row in ROWS],
    "objects in an object": {"rig": "A", "samples": [dict(zip(NAMES, row)) for row in ROWS]},
    "columns with units": {
        name: {"unit": unit, "values": list(column)}
        for name, unit, column in zip(NAMES, ("s", "degC", "%"), zip(*ROWS))
    },
}


def written(tmp_path, document, indent=None):
    path = tmp_path / "a.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document, indent=indent))
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("indent", [None, 1])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_table_is_found_by_its_shape(tmp_path, shape, indent):
    path = written(tmp_path, SHAPES[shape], indent)
    (table,) = find_tables(path)
    assert list(table.names) == NAMES
    np.testing.assert_array_equal(np.column_stack([c.values for c in table.columns]), ROWS)
    layout = TableLayout(known=table.names, **table.layout["file"])
    np.testing.assert_array_equal(read_table(path, layout).columns["temperature"], U)


def test_units_and_keys_around_a_table_are_kept(tmp_path):
    (table,) = find_tables(written(tmp_path, SHAPES["columns with units"] | {"rig": {"wire": "w7"}}))
    assert [c.unit for c in table.columns] == ["s", "degC", "%"]
    assert table.header == {"rig.wire": "w7"}


def test_rows_without_names_and_long_columns_without_names(tmp_path):
    for document in (ROWS, [list(column) for column in zip(*ROWS)]):
        (table,) = find_tables(written(tmp_path, document))
        np.testing.assert_array_equal(table.columns[1].values, U)


def test_each_series_is_a_table(tmp_path):
    other = SERIES | {"values": [[t, u, 2 * y] for t, u, y in ROWS]}
    tables = find_tables(written(tmp_path, {"results": [{"series": [SERIES, other, SERIES]}]}))
    assert [len(table) for table in tables] == [300, 300, 300]


def test_a_document_may_be_one_long_line(tmp_path):
    records = 10 * SHAPES["array of objects"]
    path = written(tmp_path, records)
    assert path.stat().st_size > csv.field_size_limit()
    assert len(find_tables(path)[0]) == 3000


def test_an_array_of_another_length_is_reported(tmp_path):
    path = written(tmp_path, SHAPES["object of arrays"] | {"events": [1.0, 2.0, 3.0]})
    notes = read_table(path, TableLayout(known=tuple(NAMES), delimiter="tab")).notes
    assert "Array 'events' has 3 values, not 300 as the others: it is not read." in notes


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (json.dumps(SHAPES["array of objects"])[:-30], "It is no valid JSON: .+ in line 1, character"),
        ('{"a": 1, "b": [1, 2]}', "a JSON document without an array of 3 rows or more"),
        ('[{"a": "' + "x" * 200_000 + '"}]', "a JSON document without an array"),
        ("[" * 100_000, "It is no valid JSON"),
        ('"a","b"\n' + "1,2\n" * 9 + '"' + "x" * 200_000, "a cell in quotes has more than 131072 characters"),
    ],
)
def test_what_is_no_table_is_refused_in_one_sentence(tmp_path, text, reason):
    with pytest.raises(DataError, match=reason):
        find_tables(written(tmp_path, text))

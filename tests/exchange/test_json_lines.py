"""Lines of JSON are rows: keys are names, null is missing, and objects of other keys are events."""

import json

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import TableLayout

U = np.round(25 + 40 * (1 - np.cos(np.linspace(0, 6, 30))), 2)


def objects():
    return [
        {
            "time_s": k * 0.5,
            "wire_degC": u,
            "door": k > 9,
            "stroke_um": {"raw": 3 * k, "mean": round(2.5 * u, 1)},
        }
        for k, u in enumerate(U.tolist())
    ]


def written(path, items):
    path.write_text("\n".join(item if isinstance(item, str) else json.dumps(item) for item in items) + "\n")
    return path


@pytest.mark.parametrize(
    "before", [[], [{"kind": "begin"}], [{"kind": "begin"}, {"time_s": -1.0, "note": "warm"}]]
)
def test_objects_are_rows(tmp_path, before):
    rows = objects()
    rows[4]["wire_degC"] = None
    del rows[7]["stroke_um"]
    path = written(
        tmp_path / "a.jsonl", [*before, *rows[:20], {"kind": "pause"}, *rows[20:], '{"time_s": 15.0, "wi']
    )
    (table,) = find_tables(path)
    assert table.names == ("time_s", "wire_degC", "door", "stroke_um.raw", "stroke_um.mean")
    columns = {c.name: c.values for c in table.columns}
    np.testing.assert_allclose(columns["wire_degC"], [*U[:4], np.nan, *U[5:]])
    np.testing.assert_allclose(columns["door"], np.arange(30) > 9)
    assert np.flatnonzero(np.isnan(columns["stroke_um.mean"])).tolist() == [7]
    again = read_table(path, TableLayout(**({"known": table.names} | table.layout["file"])))
    np.testing.assert_array_equal(again.line, [k + 1 + len(before) + (k >= 20) for k in range(30)])
    many = f"{len(before) + 1} lines are events and no rows," if before else "1 line is an event and no row,"
    assert any(note.startswith(many) for note in again.notes)
    assert any(
        note.startswith("Keys that few lines have are not read: ") and "'kind'" in note
        for note in again.notes
    )


def test_stamps_may_be_texts(tmp_path):
    rows = [{"at": f"2020-05-01T10:00:{k:02d}", "T": u, "x": 2 * u} for k, u in enumerate(U.tolist())]
    (table,) = find_tables(written(tmp_path / "a.json", rows))
    assert [c.kind for c in table.columns] == ["clock", "number", "number"]
    np.testing.assert_allclose(table.columns[0].values, np.arange(30))


@pytest.mark.parametrize("text", ['{"a": [1, 2, 3]}', '{"a": 1}\n{"a": 2}', "{}\n{}\n{}"])
def test_other_json_is_no_table(tmp_path, text):
    with pytest.raises(DataError, match="holds no table"):
        find_tables(written(tmp_path / "a.json", [text]))

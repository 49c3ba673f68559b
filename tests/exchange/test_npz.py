"""NumPy archives: vectors of one length are a table; texts, objects, and numbers of overflow are no readings."""

import json

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 90
U = 60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS))
X = 3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6)


def archive(path, **more):
    lost = np.where(np.arange(ROWS) % 30 == 7, -9.9e37, X)
    fields = {"t_s": 0.5 * np.arange(ROWS), "temp_degC": U.astype("f4"), "pos_mm": lost}
    np.savez_compressed(path, **fields, info=json.dumps({"rate": 3}), gains=np.ones(4), **more)
    return path


def test_the_vectors_of_one_length_are_a_run(tmp_path):
    path = archive(tmp_path / "a.npz")
    (table,) = find_tables(path)
    assert table.names == ("t_s", "temp_degC", "pos_mm")
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format="npz", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    run = load_run(report.run)
    np.testing.assert_allclose(run["input"], U, rtol=1e-6)
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [7, 37, 67]
    assert (
        "Column 'pos_mm': 3 of 90 cells are masked, because '-9.9e+37' stands for no reading."
        in report.warnings
    )


def test_a_matrix_gives_a_column_for_each_signal(tmp_path):
    path = archive(tmp_path / "a.npz", raw=np.c_[U, X])
    (table,) = find_tables(path)
    assert table.names[-2:] == ("raw/column 1", "raw/column 2")


@pytest.mark.parametrize("fields", [{"a": np.array([{}, {}], dtype=object)}, {"a": np.ones(9)}])
def test_an_archive_without_two_vectors_is_refused(tmp_path, fields):
    np.savez(tmp_path / "a.npz", **fields)
    with pytest.raises(DataError, match="At least two of one length"):
        find_tables(tmp_path / "a.npz")


def test_a_damaged_archive_is_refused(tmp_path):
    path = archive(tmp_path / "a.npz")
    data = bytearray(path.read_bytes())
    data[60:90] = b"\xff" * 30
    path.write_bytes(data)
    with pytest.raises(DataError, match="damaged"):
        find_tables(path)

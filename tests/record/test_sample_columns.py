"""Samples are read in blocks of rows into columns, whole or in part, in memory or in the file."""

import math
import sqlite3

import numpy as np
import pytest

from record.runs import META, edited, unhash
from smarig.core.errors import DataError, UsageError
from smarig.record import load_run, sample_columns, stored_run
from smarig.record.new_run_file import write_run
from smarig.record.sample_columns import column_blocks, read_columns
from smarig.record.schema import SAMPLE_COLUMNS

N = 23
LARGE = 2**53 + 1  # no float64: the nearest is 2**53
TABLE = {
    "tick": [3 * k for k in range(N)],
    "t_s": [None if k in (0, N - 1) else 0.1 * k for k in range(N)],
    "counts": [LARGE if k == 5 else -k for k in range(N)],
    "position": [None if k % 4 == 0 else math.sqrt(k) for k in range(N)],
    "quality": [k % 3 for k in range(N)],
}


@pytest.fixture
def path(tmp_path):
    """A run with gaps, a column that was never measured, and an integer that no float holds."""
    file = tmp_path / "a.run.sqlite"
    write_run(file, META, TABLE, [], force=False)
    return file


def expected(name: str) -> np.ndarray:
    """The column, cell by cell."""
    return np.array([math.nan if v is None else float(v) for v in TABLE.get(name, [None] * N)])


@pytest.mark.parametrize("rows", [1, 2, 7, N - 1, N, N + 1, 1000])
def test_columns_are_equal_whatever_the_size_of_a_block(path, rows: int, monkeypatch):
    monkeypatch.setattr(sample_columns, "READ_ROWS", 4)  # larger blocks are joined of several
    with sqlite3.connect(path) as db:
        found = read_columns(db, rows=rows)
        parts = list(column_blocks(db, SAMPLE_COLUMNS, rows))
    db.close()
    assert [part["tick"].size for part in parts[:-1]] == [rows] * (len(parts) - 1)
    for name in SAMPLE_COLUMNS:
        np.testing.assert_array_equal(found[name], expected(name))
        assert (found[name].dtype, found[name].shape) == (np.float64, (N,))
        np.testing.assert_array_equal(np.concatenate([part[name] for part in parts]), expected(name))
    assert found["counts"][5] == 2.0**53


def test_every_row_is_seen_as_stored(path):
    seen = []
    with sqlite3.connect(path) as db:
        read_columns(db, ["tick", "counts", "position"], seen.extend, rows=5)
    db.close()
    assert seen == list(zip(TABLE["tick"], TABLE["counts"], TABLE["position"]))


def test_more_rows_than_were_counted(path):
    """Rows that a recorder adds after they were counted are read too."""

    class Behind:
        """Counts too few rows, as if the others came later."""

        def __init__(self, db: sqlite3.Connection) -> None:
            self._db = db

        def execute(self, query: str):
            return self._db.execute("SELECT 4" if "count(*)" in query else query)

    with sqlite3.connect(path) as db:
        found = read_columns(Behind(db), rows=3)
    db.close()
    np.testing.assert_array_equal(found["position"], expected("position"))
    assert found["tick"].tolist() == TABLE["tick"]


def test_a_run_in_its_file_is_the_run_in_memory(path):
    run = load_run(path)
    with stored_run(path) as stored:
        for name in SAMPLE_COLUMNS:
            np.testing.assert_array_equal(stored[name], run[name])
            assert stored.has(name) == run.has(name), name
        assert (len(stored), stored.span_s, repr(stored)) == (len(run), run.span_s, repr(run))
        assert run.span_s == pytest.approx(0.1 * (N - 3))
        assert (stored.steps, stored.events, stored.meta) == (run.steps, run.events, run.meta)
        for k, (a, b) in enumerate(
            zip(stored.blocks(["tick", "input"], 5), run.blocks(["tick", "input"], 5))
        ):
            np.testing.assert_array_equal(a["tick"], b["tick"])
            np.testing.assert_array_equal(a["tick"], TABLE["tick"][5 * k : 5 * k + 5])
        for name in SAMPLE_COLUMNS:
            assert stored.extremes(name) == run.extremes(name), name
        assert run.extremes("quality") == (0.0, 2.0)
        assert stored.marked(1, 2, 4) == run.marked(1, 2, 4) == (8, 7, 0)


def test_a_run_in_its_file_is_of_one_moment(path):
    """What a recorder adds afterwards is not half seen."""
    unhash(path)
    with sqlite3.connect(path) as db:
        db.execute("PRAGMA journal_mode=WAL")
    with stored_run(path) as stored:
        db.execute("INSERT INTO sample (tick) VALUES (1000)")
        db.commit()
        assert (len(stored), stored["tick"].size) == (N, N)
    db.close()
    assert len(load_run(path)) == N + 1


def test_damage_and_wrong_names_are_one_sentence(path):
    with edited(path) as db:
        db.execute("UPDATE sample SET position = 'soft' WHERE tick = 6")
    db.close()
    with pytest.raises(
        DataError, match=r"a\.run\.sqlite is not a run file, or is damaged: could not convert"
    ):
        load_run(path)
    with stored_run(path) as stored:
        assert stored["counts"].size == N
        with pytest.raises(DataError, match=r"a\.run\.sqlite is not a run file, or is damaged: could not"):
            stored["position"]
        with pytest.raises(DataError, match="is damaged: could not convert"):
            list(stored.blocks(["position"]))
        with pytest.raises(UsageError, match="A run has no column 'posn'"):
            stored["posn"]
    with pytest.raises(UsageError, match="There is no run file"), stored_run(path.parent / "none.run.sqlite"):
        pass
    (path.parent / "b.run.sqlite").write_text("no run")
    with pytest.raises(DataError, match="is not a run file"), stored_run(path.parent / "b.run.sqlite"):
        pass


def test_an_error_of_the_caller_stays_its_own(path):
    with pytest.raises(ValueError, match="mine"), stored_run(path):
        raise ValueError("mine")

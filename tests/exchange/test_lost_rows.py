"""Rows in which every channel reads 0, as marks of segments and of devices that do not answer, hold no reading."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.exchange.tables.lost_rows import lost_rows
from smarig.study import StudyOptions, study
from study.known_data import displacements, temperatures

U = temperatures(2, 100)
NAMES = ("Time (min)", "Temperature (°C)", "Displacement (mm)", "Force (N)")


def channels(forces=(5.0, 10.0)):
    """Two cycles at each of some forces."""
    rng = np.random.default_rng(3)
    u = np.tile(U + 12, len(forces))
    x = np.concatenate([2 + displacements(U, seed=k) for k, _ in enumerate(forces)])
    force = np.repeat(forces, U.size) + rng.normal(0, 0.005, u.size)
    return np.array([np.arange(u.size) * 0.05, u, x, force])


def marked(data, rows, mark):
    """The data with rows of zeros before some rows; the first column holds the mark, or goes on."""
    clock = np.full(len(rows), mark) if mark is not None else data[0, rows]
    return np.insert(data, rows, [clock, *np.zeros((3, len(rows)))], axis=1)


def written(tmp_path, data, suffix=".txt"):
    path = tmp_path / f"ramps{suffix}"
    if suffix == ".xlsx":
        book = pytest.importorskip("openpyxl").Workbook()
        for row in (NAMES, *data.T.tolist()):
            book.active.append(row)
        book.save(path)
        return path
    lines = ["\t".join(NAMES), *("\t".join(f"{v:.6E}" for v in row) for row in data.T)]
    path.write_text("\r\n".join(lines) + "\r\n", encoding="utf-16")
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("suffix", [".txt", ".xlsx"])
@pytest.mark.parametrize(("rows", "mark"), [([0, 50, 200, 310], -2.0), ([40, 41, 250], None)])
def test_rows_without_a_reading_are_left_out_counted_and_split_no_load(tmp_path, rows, mark, suffix):
    data = channels()
    path = written(tmp_path, marked(data, rows, mark), suffix)
    (table,) = find_tables(path)
    assert len(table) == data.shape[1]
    np.testing.assert_allclose(table.columns[1].values, data[1], atol=1e-4)
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert [len(t.run) for t in result.tables] == [U.size] * 2
    texts = " ".join(result.tables[0].warnings)
    line = rows[0] + 2
    assert f"{len(rows)} rows hold no reading: every channel reads exactly 0 there" in texts
    assert f"(first: line {line})" in texts
    assert "starts again" not in " ".join(result.reasons) + texts


def test_a_mark_counts_where_a_channel_is_near_zero(tmp_path):
    """The first load hardly moves the wire."""
    data = channels((1.0, 12.0))
    data[2, : U.size] = 0.02 + 0.005 * (data[2, : U.size] - 2)
    rows = [0, 60, 110, 250, 330]
    found = lost_rows(dict(zip(NAMES, marked(data, rows, -2.0))))
    assert np.flatnonzero(found).tolist() == [row + k for k, row in enumerate(rows)]


def test_zeros_that_are_readings_are_kept():
    t, u, x, force = channels()
    path = 100 * np.sin(np.linspace(0, 6 * np.pi, 61))  # through 0 at the ends and between
    pulses = np.where(t % 2 < 1, 0.0, 0.8)
    at_rest = np.where(t % 2 < 1.1, 0.0, np.round(x))
    for columns in (
        {"H": np.arange(61.0), "a": path, "b": path**3, "c": np.round(path, 6)},
        {"t": t, "I": pulses, "U": 3 * pulses, "counts": np.round(40 * np.abs(np.sin(np.pi * t / 2)))},
        {"t": t, "T": u, "x": np.where(t == 3.0, 0.0, x), "F": np.where(t == 3.0, 0.0, force)},
        {"t": t, "T": np.where(t == 3.0, 0.0, u), "x": at_rest},
        {"t": t, "u": np.r_[0.0, u[1:]], "x": np.r_[0.0, x[1:]], "F": np.r_[0.0, force[1:]]},
    ):
        assert not lost_rows(columns).any(), columns.keys()

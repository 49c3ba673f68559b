"""Groups of an HDF5 file with a signal and its own times each are channels of one record, joined on time."""

import numpy as np
import pytest

from extras import skip_without
from smarig.exchange import find_tables
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand
from study.known_data import displacements, temperatures

skip_without("h5py", extra="files")

import h5py  # noqa: E402

U = temperatures(2, 240)
FAST = 0.5 * np.arange(U.size)
SLOW = FAST[3:-3:2] + 0.1
GAP = np.interp(SLOW, FAST, displacements(U, seed=4))


def written(path, unit="s", starts=("2022-03-01T10:00:00+00:00",) * 2, shift=0.0):
    factor = {"s": 1.0, "ms": 1000.0}[unit]
    logs = (("run/oven/wire_temperature", FAST, U, "degC"), ("run/stage/gap", SLOW + shift, GAP, "mm"))
    with h5py.File(path, "w") as file:
        for (name, t, values, written_unit), start in zip(logs, starts, strict=True):
            group = file.create_group(name)
            group["time"], group["reading"] = factor * t, values
            group["time"].attrs["units"] = unit
            group["reading"].attrs["units"] = written_unit
            if start:
                group["time"].attrs["start"] = start
        picture = file.create_group("run/camera")
        picture["time"], picture["counts"] = np.arange(40.0), np.arange(40.0) % 7
    return path


def record(path):
    return next(table for table in find_tables(path) if "gap" in table.names)


@pytest.mark.parametrize("unit", ["s", "ms"])
def test_logs_are_columns_named_by_their_groups(tmp_path, unit):
    table = record(written(tmp_path / "a.h5", unit))
    assert table.names == ("time", "wire_temperature", "gap")
    clock, u, y = (c.values for c in table.columns)
    np.testing.assert_allclose(clock, FAST)
    np.testing.assert_array_equal(u, U)
    np.testing.assert_array_equal(y[np.isfinite(y)], GAP)
    np.testing.assert_array_equal(np.flatnonzero(np.isfinite(y)), np.arange(3, U.size - 3, 2))
    assert [c.unit for c in table.columns] == ["s", "degC", "mm"]


def test_the_zeros_of_their_clocks_count(tmp_path):
    starts = ("2022-03-01T10:00:00+00:00", "2022-03-01T10:01:00+00:00")
    table = record(written(tmp_path / "a.h5", starts=starts, shift=-60.0))
    assert np.flatnonzero(np.isfinite(table.columns[2].values)).tolist() == list(range(3, U.size - 3, 2))


@pytest.mark.parametrize(("starts", "shift"), [(("2022-03-01T10:00:00", "noon"), 0.0), (("", ""), 1e6)])
def test_clocks_with_nothing_in_common_are_not_joined(tmp_path, starts, shift):
    assert not any(
        "gap" in t.names for t in find_tables(written(tmp_path / "a.h5", starts=starts, shift=shift))
    )


def test_the_record_is_studied_and_read_again(tmp_path):
    found = understand([written(tmp_path / "a.h5")], StudyOptions())
    tables, left_out = import_tables(found.guesses, tmp_path / "out", None, "logs")
    assert not left_out
    assert [found.guesses[0].first(role).name for role in ("input", "output")] == ["wire_temperature", "gap"]
    assert len(tables) == 1
    assert any("camera" in name for name in found.left_out)

"""MATLAB files as laboratories save them: one matrix of signals side by side, and vectors of version 7.3 by name."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from extras import skip_without
from smarig.core import ConfigError, DataError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run

ROWS = 40
U = 60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS))
Y = np.tanh((U - 60) / 20)
MAPPING = """
name = "made"
summary = "A test."
source = "this test"
[mat]
matrix = "data"
[columns]
temperature_degC = { column = "column 1", unit = "degC" }
position = { column = "column 2", unit = "mm" }
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "displacement"
unit = "mm"
"""


def saved(path, **variables) -> Path:
    out = io.BytesIO()
    savemat(out, variables)
    path.write_bytes(out.getvalue())
    return path


@given(
    signals=st.integers(2, 6),
    rows=st.integers(7, 30),
    in_rows=st.booleans(),
    name=st.sampled_from(["data", "ans", "M_1"]),
)
def test_the_longer_side_of_one_matrix_is_the_time(tmp_path_factory, signals, rows, in_rows, name):
    values = np.random.default_rng(signals * rows).normal(size=(rows, signals))
    matrix = values.T if in_rows else values
    path = saved(tmp_path_factory.mktemp("m") / "a.mat", **{name: matrix}, fs=100.0)
    (table,) = find_tables(path)
    assert table.names == tuple(f"column {k + 1}" for k in range(signals))
    assert table.layout == {"mat": {"matrix": name}}
    for k, column in enumerate(table.columns):
        np.testing.assert_array_equal(column.values, values[:, k])


@pytest.mark.parametrize("in_rows", [False, True])
def test_a_draft_reads_the_matrix_again(tmp_path, in_rows):
    values = np.column_stack([U, Y])
    path = saved(tmp_path / "a.mat", data=values.T if in_rows else values)
    (tmp_path / "m.toml").write_text(MAPPING)
    report = import_file(path, format="mat", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml"))
    run = load_run(report.run)
    np.testing.assert_array_equal(run["input"], U)
    np.testing.assert_array_equal(run["position"], Y)


def test_a_vector_of_the_same_length_keeps_its_name(tmp_path):
    path = saved(tmp_path / "a.mat", data=np.column_stack([U, Y]), t=np.arange(ROWS) * 0.5, fs=2.0)
    (table,) = find_tables(path)
    assert table.names == ("column 1", "column 2", "t")


def test_two_matrices_of_other_sizes_and_a_lone_vector_are_refused(tmp_path):
    for variables in ({"a": np.ones((9, 2)), "b": np.ones((8, 3))}, {"a": np.ones((9, 1))}):
        path = saved(tmp_path / "a.mat", **variables)
        with pytest.raises(DataError, match="no two variables of one size"):
            find_tables(path)


def test_matrices_of_one_size_are_loops_as_before(tmp_path):
    path = saved(tmp_path / "a.mat", H=np.column_stack([U, U]), B=np.column_stack([Y, Y]))
    (table,) = find_tables(path)
    assert table.names == ("H", "B")
    assert table.layout == {"mat": {"loops": "columns"}}


def test_a_missing_matrix_is_named(tmp_path):
    path = saved(tmp_path / "a.mat", other=np.column_stack([U, Y]))
    (tmp_path / "m.toml").write_text(MAPPING)
    with pytest.raises(
        ConfigError, match=r"no variable 'data', the matrix of mapping made\. The file has: other"
    ):
        import_file(path, format="mat", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml"))


def test_loops_and_a_matrix_contradict_each_other(tmp_path):
    (tmp_path / "m.toml").write_text(MAPPING.replace('"data"', '"data"\nloops = "rows"'))
    path = saved(tmp_path / "a.mat", data=np.column_stack([U, Y]))
    with pytest.raises(ConfigError, match="leave out files and loops"):
        import_file(path, format="mat", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml"))


def matlab_73(path, **vectors) -> Path:
    """A file as MATLAB's save -v7.3 writes it: a header of 512 bytes, and matrices of one row with their class."""
    skip_without("h5py", extra="files")
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in vectors.items():
            data = file.create_dataset(name, data=np.asarray(values))
            data.attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


@pytest.mark.parametrize("shape", [(1, ROWS), (ROWS, 1), (ROWS,)])
def test_vectors_of_matlab_73_keep_their_names(tmp_path, shape):
    path = matlab_73(
        tmp_path / "a.mat",
        time=np.arange(ROWS).reshape(shape),
        temperature=U.reshape(shape),
        x=Y.reshape(shape),
    )
    (table,) = find_tables(path)
    assert set(table.names) == {"time", "temperature", "x"}
    np.testing.assert_array_equal(table.columns[table.names.index("temperature")].values, U)


def test_a_matrix_of_matlab_73_is_numbered(tmp_path):
    path = matlab_73(tmp_path / "a.mat", data=np.vstack([U, Y]))
    (table,) = find_tables(path)
    assert table.names == ("data/column 1", "data/column 2")


@pytest.mark.parametrize("name", ["rows.mat", "columns.mat"])
def test_the_given_matrices(shared_data, name):
    path = shared_data / "field_cases" / "matlab_one_matrix" / name
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    (table,) = find_tables(path)
    assert (table.names, len(table)) == (("column 1", "column 2"), 713)


def test_the_given_file_of_matlab_73(shared_data):
    skip_without("h5py", extra="files")
    path = shared_data / "field_cases" / "other_containers" / "v73.mat"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    (table,) = find_tables(path)
    assert set(table.names) == {"time", "current", "temperature", "displacement"}

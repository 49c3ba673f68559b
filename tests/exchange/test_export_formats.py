"""Exported runs, read back by other programs' readers: equal numbers, units, steps and events."""

import csv
import json
import sys
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest

from smarig.core.catalogue import catalogue_names
from smarig.core.errors import UsageError
from smarig.core.sample import Sample
from smarig.exchange import export_run, import_file
from smarig.record import Recorder, load_run
from smarig.runner.session import Session

needs_xarray = pytest.mark.skipif(
    not all(map(find_spec, ("xarray", "h5netcdf", "h5py"))), reason="the extra netcdf is not installed"
)
needs_pyarrow = pytest.mark.skipif(find_spec("pyarrow") is None, reason="the extra parquet is not installed")

TIMELESS = """name = "timeless"
summary = "A loop of somebody's."
source = "nobody"
initial = "anhysteretic"
[columns]
input = {{ column = "{input}", unit = "A/m" }}
position = {{ column = "{position}", unit = "T" }}
[input]
channel = "input"
quantity = "magnetic field"
unit = "A/m"
[output]
quantity = "flux density"
unit = "T"
"""


def _twin(rig, path):
    """The second run of a session: its clock does not start at zero."""
    with Session(rig, seed=3) as session:
        session.run("validation", {"points": "2"}, path.with_name("before.run.sqlite"), force=True)
        return load_run(session.run("validation", {"points": "2"}, path))


def _incomplete(path):
    """A run that was never closed: a lost sample, a flag, an event with data, a step without a position."""
    meta = {
        "protocol": "föhn",
        "rig": "bench",
        "wire": "A7",
        "source": "bench",
        "start_epoch": 1.7e9,
        "notes": "É",
    }
    meta |= {"output": {"quantity": "displacement", "unit": "mm"}, "input": {"quantity": "T", "unit": "K"}}
    recorder = Recorder(path, meta)
    nan = float("nan")
    for k in (1, 2, 4, 5):
        step = 0 if k > 2 else None
        recorder.sample(
            Sample(k, k / 10, 0.5, 0.4 + k, 2.0, nan, 10 * k, 0.47 * k, 22.5, 4 * (k == 4)), step, 7.0 * k
        )
    recorder.event(0.2, "pause", "Paused – «why»?", level="warning", because=[1, 2])
    row = (0, 1, 1, "up", None, 0.2, None, "interrupted", None, 2)
    recorder._execute("INSERT INTO step VALUES (?,?,?,?,?,?,?,?,?,?)", row)
    recorder._commit()
    found = load_run(path)  # as it stands, before anybody closes it
    recorder.close("done")
    return found


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    loop = folder / "loop.csv"
    loop.write_text(
        "H,M\n" + "\n".join(f"{h},{0.5 * h + (k % 5)}" for k, h in enumerate([0, 5, 9, 4, -3, -8, -2, 6]))
    )
    mapping = folder / "timeless.toml"
    mapping.write_text(TIMELESS.format(input="H", position="M"))
    report = import_file(loop, format="csv", mapping=str(mapping), out=folder / "loop.run.sqlite")
    return {
        "one_wire": _twin("one_wire_twin", folder / "one.run.sqlite"),
        "two_wire": _twin("two_wire_twin", folder / "two.run.sqlite"),
        "incomplete": _incomplete(folder / "incomplete.run.sqlite"),
        "timeless": load_run(report.run),
    }


@pytest.fixture(params=["one_wire", "two_wire", "incomplete", "timeless"])
def run(request, runs):
    return runs[request.param]


def measured(run):
    """What must come back."""
    return {
        name: values for name, values in run.columns.items() if name in ("tick", "quality") or run.has(name)
    }


def same_rows(got, kept):
    """A table read back against the run's steps or events, field by field."""
    assert len(got) == len(kept)
    for row, was in zip(got, kept, strict=True):
        for name in was.__dataclass_fields__:
            value = getattr(was, name)
            if name == "data":
                assert json.loads(row[name]) == value
            elif value is None:
                assert np.isnan(row[name])
            else:
                assert row[name] == value, name
        if hasattr(was, "severity"):
            assert row["severity"] == was.severity


@pytest.mark.long("takes two seconds")
def test_these_runs_are_worth_exporting(runs):
    assert runs["one_wire"].unit == "mm"
    assert runs["two_wire"].unit == "deg"
    assert min(runs["two_wire"]["position"]) < -10 < 10 < max(runs["two_wire"]["position"])
    assert not runs["incomplete"].complete
    assert runs["incomplete"]["quality"].tolist() == [0, 0, 4, 0]
    assert not runs["timeless"].has("t_s")
    assert not runs["timeless"].has("current_A")
    assert (runs["timeless"].input_unit, len(runs["timeless"])) == ("A/m", 8)


# --- NetCDF -----------------------------------------------------------------------------------------------------

UDUNITS = {"deg": "degree"}


@needs_xarray
def test_netcdf_in_xarray(run, tmp_path):
    import xarray as xr

    path = export_run(run, to="netcdf", out=tmp_path / "r.nc")
    with xr.open_dataset(path) as data:
        for name, values in measured(run).items():
            np.testing.assert_array_equal(np.asarray(data[name], dtype=float), values, err_msg=name)
        assert set(data.variables) == {*measured(run), "smarig_run"} | ({"time"} if run.has("t_s") else set())
        assert data["position"].attrs["units"] == UDUNITS.get(run.unit, run.unit)
        assert data["input"].attrs["units"] == run.input_unit
        assert data["position"].attrs["long_name"] == run.meta["output"]["quantity"]
        assert data.attrs["Conventions"].startswith("CF-1.")
        assert data.attrs["source"].split(":")[0] == run.meta["source"].upper()
        assert run.meta["source"].upper() in data.attrs["title"]
        assert data.attrs["ended"] == run.cause
        assert json.loads(data["smarig_run"].item()) == run.meta
        assert data["quality"].dtype.kind == "i"
        words = dict(zip(data["quality"].attrs["flag_meanings"].split(), data["quality"].attrs["flag_masks"]))
        assert words["saturated"] == 4
    for group, kept in (("steps", run.steps), ("events", run.events)):
        with xr.open_dataset(path, group=group) as table:
            rows = [{n: table[n].values[k] for n in table.variables} for k in range(table.sizes[group[:-1]])]
            same_rows(rows, kept)


@needs_xarray
def test_netcdf_has_the_time_of_day_where_there_is_one(runs, tmp_path):
    import xarray as xr

    run = runs["one_wire"]
    with xr.open_dataset(export_run(run, to="netcdf", out=tmp_path / "r.nc")) as data:
        began = next(e for e in run.events if e.kind == "start")
        assert began.t_s > 60
        of_day = (data["time"].values - np.datetime64(0, "s")) / np.timedelta64(1, "s")
        np.testing.assert_allclose(of_day, run["t_s"] - began.t_s + began.data["epoch"], atol=2e-6, rtol=0)
        assert data["time"].attrs["standard_name"] == "time"
        assert data["current_A"].dims == ("time",)
        assert data["ambient_degC"].attrs["standard_name"] == "air_temperature"
    with xr.open_dataset(export_run(runs["timeless"], to="netcdf", out=tmp_path / "t.nc")) as data:
        assert data["position"].dims == ("tick",)
        assert data["tick"].values.tolist() == list(range(8))
    twice = replace(run, columns=run.columns | {"t_s": np.maximum(run["t_s"], run["t_s"][5])})
    with xr.open_dataset(export_run(twice, to="netcdf", out=tmp_path / "d.nc")) as data:
        assert data["position"].dims == ("tick",)  # a clock that stood still is no coordinate
        np.testing.assert_array_equal(data["t_s"], twice["t_s"])


@needs_xarray
def test_netcdf_holds_only_types_that_every_reader_supports(run, tmp_path):
    """In the file itself: numbers and single characters, attributes of fixed length; nothing ragged."""
    import h5py

    kinds = set()

    def looked(name, thing):
        for key, value in thing.attrs.items():
            if key in ("DIMENSION_LIST", "REFERENCE_LIST"):  # HDF5's own, of dimensions
                continue
            kind = thing.attrs.get_id(key).dtype
            assert h5py.check_string_dtype(kind) is None or h5py.check_string_dtype(kind).length, (name, key)
            assert not isinstance(value, str), (name, key)
        if isinstance(thing, h5py.Dataset):
            assert h5py.check_vlen_dtype(thing.dtype) is None
            kinds.add((thing.dtype.kind, thing.dtype.itemsize))

    with h5py.File(export_run(run, to="netcdf", out=tmp_path / "r.nc")) as file:
        looked("/", file)
        file.visititems(looked)
    assert kinds <= {("f", 8), ("f", 4), ("i", 4), ("i", 8), ("S", 1)}
    assert ("S", 1) in kinds


@needs_xarray
def test_netcdf_keeps_ticks_beyond_32_bits(runs, tmp_path):
    import xarray as xr

    run = runs["incomplete"]
    late = replace(run, columns=run.columns | {"tick": run["tick"] + 2.0**40})
    with xr.open_dataset(export_run(late, to="netcdf", out=tmp_path / "r.nc")) as data:
        assert data["tick"].values.tolist() == late["tick"].astype(int).tolist()


def test_netcdf_without_h5netcdf_names_the_extra(runs, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5netcdf", None)
    with pytest.raises(UsageError, match=r"pip install 'smarig\[netcdf\]'"):
        export_run(runs["timeless"], to="netcdf", out=tmp_path / "x.nc")
    assert not list(tmp_path.iterdir())


# --- MATLAB -----------------------------------------------------------------------------------------------------


def test_mat_in_scipy(run, tmp_path):
    from scipy.io import loadmat

    path = export_run(run, to="mat", out=tmp_path / "r.mat")
    file = loadmat(path, simplify_cells=True)
    assert set(file["samples"]) == set(measured(run))
    for name, values in measured(run).items():
        np.testing.assert_array_equal(file["samples"][name], values, err_msg=name)
    assert file["units"]["samples"]["position"] == run.unit
    assert file["units"]["samples"]["input"] == run.input_unit
    assert file["units"]["steps"]["target"] == run.input_unit
    assert file["what"]["samples"]["position"] == run.meta["output"]["quantity"]
    rows = {name: np.atleast_1d(file[name]).tolist() for name in ("steps", "events")}
    texts = ("branch", "verdict", "level", "kind", "text")
    for row in (r for table in rows.values() for r in table):
        row.update({k: "" for k in texts if k in row and np.size(row[k]) == 0})  # '' is 0 × 0 in MATLAB
    same_rows(rows["steps"], run.steps)
    same_rows(rows["events"], run.events)
    about = file["about"]
    assert (about["source"], about["complete"], about["twin"]) == (
        run.meta["source"].upper(),
        run.complete,
        run.twin,
    )
    assert about["ended"] == run.cause
    assert json.loads(about["run_json"]) == run.meta
    assert about["quality_bits"]["saturated"] == 4


def test_mat_is_what_matlab_expects(runs, tmp_path):
    """Columns stand upright, structures are arrays, marks are whole, void is logical, names are short enough."""
    from scipy.io import loadmat, whosmat

    path = export_run(runs["incomplete"], to="mat", out=tmp_path / "anything")
    assert path.name == "anything"
    assert path.read_bytes().startswith(b"MATLAB 5.0")
    assert {n: shape for n, shape, _ in whosmat(path)}["steps"] == (1, 1)
    file = loadmat(path, mat_dtype=True)
    samples, steps = file["samples"][0, 0], file["steps"]
    assert samples["current_A"].shape == (4, 1)
    assert samples["quality"].dtype == np.int32
    assert steps["void"][0, 0].dtype == bool
    assert np.isnan(steps["target"][0, 0]).all()
    assert max(map(len, (*samples.dtype.names, *steps.dtype.names))) <= 63


# --- Parquet and CSV --------------------------------------------------------------------------------------------


@needs_pyarrow
def test_parquet_in_pyarrow_and_pandas(run, tmp_path):
    import pyarrow.parquet as pq

    path = export_run(run, to="parquet", out=tmp_path / "r.parquet")
    table = pq.read_table(path)
    assert table.column_names == list(measured(run))
    for name, values in measured(run).items():
        np.testing.assert_array_equal(np.array(table[name].to_numpy(), dtype=float), values, err_msg=name)
    assert table.schema.field("position").metadata[b"unit"].decode() == run.unit
    assert table.schema.field("position").metadata[b"what"].decode() == run.meta["output"]["quantity"]
    facts = {k.decode(): v.decode() for k, v in table.schema.metadata.items()}
    assert facts["smarig.source"] == run.meta["source"].upper()
    assert json.loads(facts["smarig.run"]) == run.meta
    steps, events = (json.loads(facts[f"smarig.{name}"]) for name in ("steps", "events"))
    assert steps == [{k: getattr(s, k) for k in s.__dataclass_fields__} for s in run.steps]
    assert [e["text"] for e in events] == [e.text for e in run.events]
    assert [e["severity"] for e in events] == [e.severity for e in run.events]
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_parquet(path)
    for name, values in measured(run).items():
        np.testing.assert_array_equal(frame[name].to_numpy(dtype=float), values, err_msg=name)


@pytest.mark.parametrize("name", ["one_wire", "two_wire"])
def test_csv_comes_back_through_the_import(runs, name, tmp_path):
    run = runs[name]
    path = export_run(run, to="csv", out=tmp_path / "r.csv")
    import_file(path, format="csv", rig=f"{name}_twin", out=tmp_path / "back.run.sqlite")
    back = load_run(tmp_path / "back.run.sqlite")
    for column in ("t_s", "step", "current_A", "input", "counts", "position", "quality"):
        np.testing.assert_array_equal(back[column], run[column], err_msg=column)


def test_csv_of_data_in_other_units_comes_back_through_a_mapping(runs, tmp_path):
    run = runs["timeless"]
    path = export_run(run, to="csv", out=tmp_path / "r.csv")
    with path.open(encoding="utf-8") as file:
        head = next(csv.reader(file))
    mapping = tmp_path / "back.toml"
    ignored = '[ignore]\ntick = "counted anew"\nflags = "all good"\n'
    mapping.write_text(TIMELESS.format(input="input [A/m]", position="position [T]") + ignored)
    assert {"input [A/m]", "position [T]"} <= set(head)
    import_file(path, format="csv", mapping=str(mapping), out=tmp_path / "back.run.sqlite")
    back = load_run(tmp_path / "back.run.sqlite")
    np.testing.assert_array_equal(back["input"], run["input"])
    np.testing.assert_array_equal(back["position"], run["position"])


# --- all ----------------------------------------------------------------------------------------------------------


def test_help_names_every_format_and_its_readers(capsys):
    from smarig.cli import run as cli

    assert cli(["export", "--help"]) == 0
    text = capsys.readouterr().out
    lines = [line.split()[0] for line in text.splitlines() if line.startswith("    ")]
    assert set(catalogue_names("smarig.exchange.writers")) <= set(lines)
    for reader in ("xarray", "ncread", "loadmat", "pandas", "smarig import"):
        assert reader in text


@pytest.mark.parametrize("name", ["csv", "mat", "netcdf", "parquet"])
def test_a_run_without_samples_is_exported_all_the_same(name, tmp_path):
    pytest.importorskip({"netcdf": "h5netcdf", "parquet": "pyarrow"}.get(name, "scipy"))
    Recorder(tmp_path / "e.run.sqlite", {"source": "twin"}).close("stopped")
    assert export_run(tmp_path / "e.run.sqlite", to=name, out=tmp_path / "e").stat().st_size > 10

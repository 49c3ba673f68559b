"""Runs exported and imported again: equal numbers, no partial files, nothing overwritten without --force."""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from full_disk import no_file_beyond
from smarig.core.errors import StorageError, UsageError
from smarig.exchange import export_run, import_file
from smarig.record import load_run
from smarig.record.new_run_file import write_run

PERIOD_S = 0.5


@pytest.fixture
def run(tmp_path):
    """A run of a one-wire twin: four holds of 30 s, with a channel missing and a NaN in another."""
    n = 240
    command = np.repeat([0.0, 0.4, 0.8, 0.3], n // 4)
    rng = np.random.default_rng(11)
    counts = np.round(np.repeat([0, 120, 300, 200], n // 4) + rng.normal(0, 0.3, n)).astype(int)
    ambient = 22 + rng.normal(0, 0.1, n)
    ambient[17] = np.nan
    columns = {
        "tick": list(range(n)),
        "t_s": np.arange(n) * PERIOD_S,
        "step": np.repeat(np.arange(4), n // 4),
        "current_command_A": command,
        "current_A": command + rng.normal(0, 2e-4, n),
        "input": rng.random(n),
        "counts": counts,
        "position": counts * 2 * np.pi * 15 / 2000,
        "ambient_degC": ambient,
        "quality": [4 * (k == 30) for k in range(n)],
    }
    per_count = 2 * np.pi * 15 / 2000
    meta = {
        "rig": "one_wire_twin",
        "source": "twin",
        "protocol": "test",
        "input": {"quantity": "wire temperature above ambient", "unit": "K"},
        "output": {"quantity": "displacement", "unit": "mm", "per_count": per_count},
    }
    steps = [
        (k, 0, 0, "up", 10.0 * k, 30.0 * k, 30.0 * k + 29.5, "settled", per_count * counts[60 * k + 30], 50)
        for k in range(4)
    ]
    path = tmp_path / "made.run.sqlite"
    write_run(path, meta, columns, steps, force=False)
    return load_run(path)


def test_csv_and_back_gives_the_same_samples(run, tmp_path):
    out = export_run(run, to="csv", out=tmp_path / "made.csv")
    head = out.read_text().splitlines()[0].split(",")
    assert head[:4] == ["tick", "time_s", "step", "current_command_A"]
    assert "position_mm" in head
    assert "input_K" in head
    assert "voltage_V" not in head  # never measured
    import_file(out, format="csv", rig="one_wire_twin", out=tmp_path / "back.run.sqlite")
    back = load_run(tmp_path / "back.run.sqlite")
    for name, column in run.columns.items():
        np.testing.assert_array_equal(back[name], column, err_msg=name)
    assert back.unit == "mm"
    assert back.input_unit == "K"
    assert [s.index for s in back.steps] == [0, 1, 2, 3]


def test_parquet_keeps_numbers_units_and_description(run, tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    table = pq.read_table(export_run(run, to="parquet", out=tmp_path / "made.parquet"))
    for name in table.column_names:
        got = np.array(table[name].to_numpy(), dtype=float)
        np.testing.assert_array_equal(got, run[name], err_msg=name)
    assert table["ambient_degC"].null_count == 1
    assert table.schema.field("position").metadata == {b"unit": b"mm", b"what": b"displacement"}
    assert table.schema.field("input").metadata[b"unit"] == b"K"
    assert json.loads(table.schema.metadata[b"smarig.run"]) == run.meta
    assert len(json.loads(table.schema.metadata[b"smarig.steps"])) == 4


@pytest.mark.parametrize("rows", [1, 7, 239, 240, 1000])
def test_a_file_written_in_blocks_is_the_file_written_at_once(run, tmp_path, monkeypatch, rows: int):
    """From memory and from the run's file, whose samples are never all in memory."""
    pq = pytest.importorskip("pyarrow.parquet")
    whole = {to: export_run(run, to=to, out=tmp_path / f"whole.{to}") for to in ("csv", "parquet", "mat")}
    monkeypatch.setattr("smarig.exchange.writers.csv.BLOCK_ROWS", rows)
    monkeypatch.setattr("smarig.exchange.writers.parquet.GROUP_ROWS", rows)
    for source in (run, run.path):
        made = {to: export_run(source, to=to, out=tmp_path / f"x.{to}", force=True) for to in whole}
        assert made["csv"].read_bytes() == whole["csv"].read_bytes()
        table = pq.read_table(made["parquet"])
        assert table.equals(pq.read_table(whole["parquet"]), check_metadata=True)
        assert pq.ParquetFile(made["parquet"]).num_row_groups == -(-240 // rows)
        samples = [loadmat(files["mat"])["samples"][0, 0] for files in (made, whole)]
        for name in samples[1].dtype.names:
            np.testing.assert_array_equal(samples[0][name], samples[1][name], err_msg=name)


def test_parquet_without_pyarrow_names_the_extra(run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(UsageError, match=r"pip install 'smarig\[parquet\]'"):
        export_run(run, to="parquet", out=tmp_path / "x.parquet")
    assert [p.name for p in tmp_path.iterdir()] == ["made.run.sqlite"]


def test_an_existing_file_is_kept_unless_forced(run, tmp_path):
    out = tmp_path / "kept.csv"
    out.write_text("precious")
    with pytest.raises(UsageError, match="exists; give another name or --force"):
        export_run(run, to="csv", out=out)
    assert out.read_text() == "precious"
    export_run(run.path, to="csv", out=out, force=True)
    assert out.read_text().startswith("tick,")


def test_a_failure_leaves_no_half_file_and_the_old_one(run, tmp_path, monkeypatch):
    out = tmp_path / "old.csv"
    out.write_text("precious")

    def full_disk(run, path):
        path.write_text("half a fi")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("smarig.exchange.writers.csv.csv", full_disk)
    with pytest.raises(StorageError, match="No space left on device"):
        export_run(run, to="csv", out=out, force=True)
    assert out.read_text() == "precious"
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize(
    ("to", "needed"),
    [("csv", "csv"), ("mat", "scipy"), ("netcdf", "h5netcdf"), ("parquet", "pyarrow"), ("rrd", "rerun")],
)
def test_a_disk_that_fills_is_a_sentence_in_every_format(run, tmp_path, to, needed, capfd):
    """Libraries that write by themselves end the process (HDF5) or report it in their own log lines (Rerun)."""
    pytest.importorskip(needed)
    with no_file_beyond(1000), pytest.raises(StorageError, match="cannot be written: .*[Ff]ile too large"):
        export_run(run, to=to, out=tmp_path / "out" / "it")
    assert capfd.readouterr() == ("", "")
    assert not list((tmp_path / "out").iterdir())


def test_an_unwritable_target_is_reported(run, tmp_path):
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(UsageError, match="is not a folder"):
        export_run(run, to="csv", out=tmp_path / "file" / "x.csv")


def test_an_unwritable_folder_is_reported(run, tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    if os.access(folder, os.W_OK):  # root writes anywhere, except where nothing is stored
        folder = Path("/proc")
    with pytest.raises(StorageError, match="cannot be written"):
        export_run(run, to="csv", out=folder / "x.csv")


def test_an_unknown_format_is_refused_with_the_known_ones(run, tmp_path):
    with pytest.raises(UsageError, match="'parket'; did you mean parquet"):
        export_run(run, to="parket", out=tmp_path / "x")

"""The actuator of a run, and the earlier runs of a model: by name beside the runs given, never by a recorded path."""

import contextlib
import json
import shutil
import sqlite3
from dataclasses import replace

import pytest

import smarig
from smarig.config import locate
from smarig.core import UsageError
from smarig.identification import identify
from smarig.record import load_run
from smarig.replay import recorded_actuator
from smarig.replay.provenance import earlier_runs, file_hash


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("made") / "a.run.sqlite"
    return smarig.run("first_order_descending", rig="one_wire_twin", out=out, partition_K="0,40,80,120,170")


@pytest.fixture
def run(made, tmp_path):
    """A run in a folder of its own that names an actuator file, without its values."""
    path = tmp_path / "data" / "runs" / "a.run.sqlite"
    path.parent.mkdir(parents=True)
    shutil.copy(made.path, path)
    with contextlib.closing(sqlite3.connect(path)) as db, db:
        db.execute("DELETE FROM run WHERE key IN ('actuator_values', 'hashes', 'end')")
        name = json.dumps("/lab/elsewhere/wire.toml")
        db.execute("UPDATE run SET value = ? WHERE key = 'actuator'", (name,))
    return load_run(path)


def wire_file(path):
    path.parent.mkdir(exist_ok=True)
    text = locate("actuators", "gorbet_one_wire").read_text("utf-8")
    path.write_text(text.replace('name = "gorbet_one_wire"', 'name = "mine"'), "utf-8")
    return path


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "runs/wire.toml",
        "wire.toml",
    ),
)
@pytest.mark.parametrize("place", ["runs/wire.toml", "wire.toml"])
def test_an_actuator_file_is_found_by_its_name_beside_the_run_or_above(run, place):
    with pytest.raises(UsageError, match=r"names the actuator '/lab/elsewhere/wire\.toml'.* beside the run"):
        recorded_actuator(run)
    wire_file(run.path.parents[1] / place)
    actuator = recorded_actuator(run)
    assert actuator is not None
    assert actuator.name == "mine"


def test_a_link_that_leads_out_and_a_file_of_another_kind_are_not_used_nor_quoted(run, tmp_path):
    beside = run.path.parent / "wire.toml"
    beside.symlink_to(wire_file(tmp_path / "outside" / "wire.toml"))
    with pytest.raises(UsageError, match="names the actuator"):
        recorded_actuator(run)
    beside.unlink()
    beside.write_text('password = "hunter2"\n')
    with pytest.raises(UsageError, match="which is no actuator file") as refusal:
        recorded_actuator(run)
    assert "hunter2" not in str(refusal.value)
    assert "password" not in str(refusal.value)


def test_the_values_in_the_record_are_used_before_any_file(made):
    wire_file(made.path.parent / "gorbet_one_wire")
    actuator = recorded_actuator(made)
    assert actuator is not None
    assert actuator.name == "gorbet_one_wire"


def test_an_earlier_run_is_found_by_name_and_hash_beside_the_runs_given(made, run, tmp_path):
    model = identify(made, "constant").model
    (entry,) = model.provenance
    assert entry.sha256 == file_hash(made)
    model = replace(model, provenance=(entry.model_copy(update={"run": "../train/a.run.sqlite"}),))
    assert earlier_runs(model, [run]) == [], "the run beside it has another hash"
    train = run.path.parents[1] / "train" / "a.run.sqlite"
    train.parent.mkdir()
    train.symlink_to(made.path)
    assert earlier_runs(model, [run]) == [], "a link that leads out"
    train.unlink()
    shutil.copy(made.path, train)
    assert [found.path for found in earlier_runs(model, [run])] == [train]

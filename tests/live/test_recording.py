"""An .rrd file, read back by Rerun's reader, holds the samples of the run with their times and stays small."""

import json
import os
import threading

import numpy as np
import pytest

from extras import skip_without
from smarig.cli import run as smarig
from smarig.live.recording_file import RecordingFile

skip_without("rerun", extra="live")


def reader(path):
    """Rerun's reader of a file, which takes 50 MB that only the tests of this module need."""
    from rerun.chunk import RrdReader

    return RrdReader(path)


def column(path, entity: str, component: str, timeline: str = "device_time"):
    """Times in seconds and values of a component, in the order of time."""
    times, values = [], []
    for chunk in reader(path).stream().filter(content=entity).to_chunks():
        if chunk.is_static or timeline not in chunk.timeline_names:
            continue
        batch = chunk.to_record_batch()
        name = next((n for n in batch.schema.names if n.endswith(f":{component}")), None)
        if name is not None:
            times.append(batch.column(timeline).to_numpy(zero_copy_only=False))
            values.extend(batch.column(name).to_pylist())
    seconds = np.concatenate(times).astype("timedelta64[ns]").astype("int64") / 1e9
    order = np.argsort(seconds, kind="stable")
    return seconds[order], [values[k] for k in order]


@pytest.fixture(scope="module")
def exported(one_wire, tmp_path_factory):
    path = tmp_path_factory.mktemp("rrd") / "one.rrd"
    assert smarig(["export", str(one_wire.path), "--to", "rrd", "-o", str(path)]) == 0
    return path


def test_the_samples_are_those_of_the_run(one_wire, exported):
    for entity, names in {
        "/position": ("position",),
        "/current": ("current_command_A", "current_A"),
        "/voltage": ("voltage_V",),
        "/temperature": ("input",),
    }.items():
        seconds, values = column(exported, entity, "scalars")
        assert np.allclose(seconds, one_wire["t_s"], atol=1e-9), entity
        read = np.array([row[: len(names)] for row in values])
        assert np.array_equal(read, np.c_[tuple(one_wire[name] for name in names)]), entity


def test_events_and_verdicts_are_in_it(one_wire, exported):
    _, texts = column(exported, "/log", "text")
    assert [text for (text,) in texts] == [f"{e.kind}: {e.text}" for e in one_wire.events]
    _, states = column(exported, "/lanes/verdict", "state")
    assert [s for (s,) in states].count("settled") == sum(s.verdict == "settled" for s in one_wire.steps) > 3


def test_units_and_the_twins_label_are_in_it(exported):
    chunks = reader(exported).stream().to_chunks()
    static = [c for c in chunks if c.is_static and c.entity_path != "/plane/plot/map"]
    text = "".join(str(c.to_record_batch().to_pydict()) for c in static)
    for word in ("position (mm)", "estimated temperature above ambient (K)", "TWIN", "measured"):
        assert word in text


def test_it_has_a_layout(exported):
    assert reader(exported).blueprints()
    assert reader(exported).recordings()[0].application_id == "smarig"


def test_ten_hours_are_less_than_a_hundred_megabytes(one_wire, exported):
    """These few minutes move more than an hour's holds do."""
    fixed = 400_000  # layout, axes, map: once
    hours = float(np.ptp(one_wire["t_s"])) / 3600
    per_hour = max(exported.stat().st_size - fixed, 0) / hours
    assert exported.stat().st_size > 100_000
    assert per_hour < 10e6


def test_view_saves_several_models_in_one_recording(one_wire, tmp_path, capsys):
    out = tmp_path / "view.rrd"
    model = tmp_path / "base.model.json"
    other = tmp_path / "extended.model.json"
    a_model().save(model)
    a_model().save(other)
    arguments = [
        "view",
        str(one_wire.path),
        "--model",
        str(model),
        "--model",
        str(other),
        "--save",
        str(out),
        "--json",
    ]
    assert smarig(arguments) == 0
    assert json.loads(capsys.readouterr().out)["models"] == ["base", "extended"]
    _, residuals = column(out, "/residual", "scalars")
    assert {len(row) for row in residuals} == {2}
    per_count = one_wire.meta["output"]["per_count"]
    assert np.nanstd(np.array(residuals, dtype=float)) < per_count
    assert smarig(arguments) == 2  # it exists now
    assert "exists" in json.loads(capsys.readouterr().out)["error"]


def a_model():
    """The twin's own surface, as a model file would hold it."""
    from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    from smarig.replay import Model, NoiseRecord
    from smarig.replay.model_file import ActuatorRecord, SignalDescription

    return Model(
        name="own",
        hysteresis=thesis_surface("one_e"),
        rig="one_wire_twin",
        actuator=ActuatorRecord(name="gorbet_one_wire", parameters={}),
        arrangement="one_wire",
        input=SignalDescription(quantity="temperature", unit="K"),
        output=SignalDescription(quantity="displacement", unit="mm"),
        mirrored=False,
        fit={},
        noise_floor=NoiseRecord(value=None, unit="mm", source=""),
        provenance=(),
        twin=True,
        created="",
    )


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
def test_the_writer_of_a_pipe_never_waits_for_its_reader(tmp_path, monkeypatch):
    """Whatever keeps the thread that reads: Rerun opens the pipe in the main thread, where no signal would end it."""
    with monkeypatch.context() as patch:
        patch.setattr(threading.Thread, "start", lambda _: None)
        recording = RecordingFile(tmp_path / "a.rrd")
    writer = os.open(recording.pipe, os.O_WRONLY | os.O_NONBLOCK)  # OSError without a reader
    recording.writer_opened()
    recording._thread.start()
    os.write(writer, b"recorded")
    os.close(writer)
    recording.close()
    assert (tmp_path / "a.rrd").read_bytes() == b"recorded"

"""Runs as MCAP and as bluesky documents, read back whole by their own libraries."""

import json
import sys

import numpy as np
import pytest

from exchange.test_export_formats import _incomplete, _twin
from smarig.core.errors import UsageError
from smarig.exchange import export_run


@pytest.fixture
def run(tmp_path):
    return _twin("one_wire_twin", tmp_path / "v.run.sqlite")


def read_mcap(path):
    reader = pytest.importorskip("mcap.reader", reason="mcap is not installed (pip install mcap)")
    found, times = {}, []
    with path.open("rb") as file:
        opened = reader.make_reader(file)
        for schema, channel, message in opened.iter_messages():
            assert schema.encoding == "jsonschema"
            assert channel.message_encoding == "json"
            found.setdefault(channel.topic, []).append(json.loads(message.data))
            times.append(message.log_time)
        metadata = {m.name: m.metadata for m in opened.iter_metadata()}
    assert times == sorted(times)
    return found, metadata, times


def test_mcap_holds_every_sample_step_and_event(run, tmp_path):
    found, metadata, times = read_mcap(export_run(run, to="mcap", out=tmp_path / "v.mcap"))
    for name in ("t_s", "current_A", "position", "tick"):
        np.testing.assert_array_equal([row[name] for row in found["/samples"]], run[name])
    assert [row["text"] for row in found["/events"]] == [e.text for e in run.events]
    assert [row["verdict"] for row in found["/steps"]] == [str(s.verdict) for s in run.steps]
    assert json.loads(metadata["run"]["description"])["protocol"] == "validation"
    assert times[0] / 1e9 > 1.6e9


def test_mcap_of_an_incomplete_run_leaves_out_what_is_unknown(tmp_path):
    run = _incomplete(tmp_path / "x.run.sqlite")
    found, *_ = read_mcap(export_run(run, to="mcap", out=tmp_path / "x.mcap"))
    assert len(found["/samples"]) == len(run)
    assert all(value == value for rows in found.values() for row in rows for value in row.values())


def test_without_the_library_the_extra_is_named(run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(UsageError, match=r"smarig\[mcap\]"):
        export_run(run, to="mcap", out=tmp_path / "v.mcap")
    assert not (tmp_path / "v.mcap").exists()


@pytest.mark.long("takes two seconds", cases=("False",))
@pytest.mark.parametrize("incomplete", [False, True])
def test_documents_are_valid_and_hold_the_run(run, tmp_path, incomplete):
    model = pytest.importorskip(
        "event_model", reason="event-model is not installed (pip install event-model)"
    )
    run = _incomplete(tmp_path / "x.run.sqlite") if incomplete else run
    path = export_run(run, to="documents", out=tmp_path / "v.jsonl")
    found = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    for name, document in found:
        model.schema_validators[model.DocumentNames[name]].validate(document)
    assert [found[0][0], found[-1][0]] == ["start", "stop"]
    names = {d["uid"]: d["name"] for n, d in found if n == "descriptor"}
    pages = [d for n, d in found if n == "event_page" and names[d["descriptor"]] == "primary"]
    position = [v for page in pages for v in page["data"]["position"]]
    np.testing.assert_array_equal(np.array(position, dtype=float), run["position"])
    assert found[-1][1]["exit_status"] == ("fail" if incomplete else "success")
    assert found[-1][1]["num_events"]["primary"] == len(run)
    again = export_run(run, to="documents", out=tmp_path / "again.jsonl").read_text("utf-8")
    assert again == path.read_text("utf-8")


def test_documents_rebuild_the_run_in_a_filler(run, tmp_path):
    model = pytest.importorskip(
        "event_model", reason="event-model is not installed (pip install event-model)"
    )
    path = export_run(run, to="documents", out=tmp_path / "v.jsonl")
    seen = []
    router = model.RunRouter([lambda name, doc: ([lambda n, d: seen.append(n)], [])])
    for line in path.read_text("utf-8").splitlines():
        router(*json.loads(line))
    assert seen.count("descriptor") == 3
    assert seen[-1] == "stop"

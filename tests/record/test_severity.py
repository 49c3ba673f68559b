"""Severities in the record: stored only where the level does not imply them, and read from any file."""

import json
import sqlite3

import pytest

import smarig
from record.runs import META, edited
from smarig.core.errors import Interrupted, LimitExceeded
from smarig.device.encoding.link_faults import Silent
from smarig.record import load_run
from smarig.record.recorder import Recorder
from smarig.report.run_page import run_page
from smarig.runner.listener import CallbackListener
from smarig.runner.session import Session

EVENTS = (
    ("mark", "info", "none", None),
    ("clock", "warning", "minor", None),
    ("jump", "error", "major", None),
    ("lost", "warning", "minor", None),
    ("still_on", "warning", "invalid", "invalid"),
    ("blind", "error", "invalid", "invalid"),
)


def stored(path):
    with sqlite3.connect(path) as db:
        found = db.execute("SELECT kind, data FROM event ORDER BY rowid").fetchall()
    db.close()
    return {kind: json.loads(data).get("severity") for kind, data in found}


def test_it_is_stored_only_where_the_level_does_not_imply_it(tmp_path):
    path = tmp_path / "a.run.sqlite"
    recorder = Recorder(path, META)
    for kind, level, _, _ in EVENTS:
        recorder.event(1.0, kind, "Something.", level=level)
    recorder.close("done", t_s=2.0)
    assert stored(path) == {kind: kept for kind, _, _, kept in EVENTS} | {"end": None}
    run = load_run(path)
    assert [str(e.severity) for e in run.events] == [severity for _, _, severity, _ in EVENTS] + ["none"]
    assert run.severity == "invalid"


def test_a_file_from_before_severities_has_them_by_kind_and_level(tmp_path):
    path = tmp_path / "a.run.sqlite"
    recorder = Recorder(path, META)
    recorder.event(1.0, "still_on", "Something.", level="warning")
    recorder.close("done")
    with edited(path) as db:
        db.execute("UPDATE event SET data = '{}'")
    db.close()
    assert load_run(path).severity == "invalid"


class Ending:
    """Ends a run by an error in its tenth sample."""

    def __init__(self, error):
        self.error = error

    def __call__(self, sample, _step, _input_K):
        if sample.tick == 10:
            raise self.error


@pytest.mark.parametrize(
    ("error", "severity", "kept"),
    [
        (LimitExceeded("Too hot."), "major", "major"),
        (Silent("Nobody answers."), "invalid", "invalid"),
        (Interrupted("enough"), "minor", None),
        (ZeroDivisionError("a bug"), "major", "major"),
    ],
)
def test_the_end_of_a_run_has_the_severity_of_its_cause(tmp_path, error, severity, kept):
    path = tmp_path / "a.run.sqlite"
    with Session("one_wire_twin") as session, pytest.raises(type(error)):
        session.run(
            "validation", {"points": "2"}, path, listeners=[CallbackListener(on_sample=Ending(error))]
        )
    run = load_run(path)
    assert run.severity == severity
    assert stored(path)["end"] == kept
    page = run_page(run)
    mark = f'<span class="severity {severity}">{severity}</span>'
    assert f"Highest severity of its events: {mark}" in page.split("<main")[0], "in the head"
    assert mark in page.split("<main")[1], "in the table of events"


def test_a_run_without_alarms_mentions_no_severity_in_its_head(tmp_path):
    run = smarig.run("validation", rig="one_wire_twin", out=tmp_path / "a.run.sqlite", points=2)
    assert run.severity == "none"
    assert set(stored(run.path).values()) == {None}
    assert "everity" not in run_page(run).split("<main")[0].split("</style>")[1]

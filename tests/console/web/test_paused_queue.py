"""A paused queue says so to whoever adds to it."""

from urllib.parse import urlencode

import pytest

from console.web.started_console import started_console

FORM = {"Content-Type": "application/x-www-form-urlencoded"}


@pytest.mark.long("takes three seconds")
def test_what_is_added_to_a_paused_queue_does_not_seem_started(tmp_path, monkeypatch):
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))
    with started_console(tmp_path / "runs") as console:
        sent = {**console.own, **FORM}
        assert console.ask("/queue/pause", "POST", sent, "").status == 303
        fields = {
            "rig": "one_wire_twin",
            "experiment": "validation",
            "set.points": "3",
            "out": "later.run.sqlite",
        }
        added = console.ask("/new", "POST", sent, urlencode({**fields, "do": "start"}))
        assert added.status == 303
        assert "which+is+paused" in added.headers["location"]
        assert "level=warning" in added.headers["location"]
        shown = console.ask("/").body
        assert "1 entry waiting, until the queue continues." in shown
        assert "will have ended" not in shown
        assert "Add to the paused queue" in console.ask("/new").body

"""Checks of a rig in progress, whoever has started them: shown by every console, and ended by "Stop everything"."""

import html
import os
import re
import signal
from urllib.parse import urlencode

import pytest

from console.web.started_console import started_console
from running.started_run import started_run, waited
from smarig.running import runs_in_progress

BENCH = 'name = "bench"\nbase = "one_wire_serial"\nwire = "check"\n[simulator]\nspeed = 2.0\n'
FORM = {"Content-Type": "application/x-www-form-urlencoded"}
ENDED = re.compile(
    r"The check was stopped by the operator \('Stop everything' in the console\)\. The current is at zero\."
)
STOPPED = "The check of bench was asked to stop. The queue is paused."


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in ("RUNNING", "LOCK", "HISTORY"):
        monkeypatch.setenv(f"SMARIG_{name}_DIR", str(tmp_path / name.lower()))
    (tmp_path / "bench.toml").write_text(BENCH)
    return tmp_path


def announced_check():
    return waited(lambda: next((run for run in runs_in_progress() if run.is_check), None), "a check")


def stop_everything(console):
    return html.unescape(console.ask(console.ask("/stop-all", "POST").headers["location"]).body)


@pytest.mark.long("takes three seconds")
def test_a_check_of_a_terminal_is_shown_by_the_console_of_its_folder_and_ended_by_it(folder):
    (folder / "mine.toml").write_text(BENCH)
    with started_run(folder, "check", "bench.toml", "--yes") as process, started_console(folder) as console:
        check = announced_check()
        overview = console.ask("/").body
        assert "Check of bench" in overview
        assert "Stop this check: Check of bench" in overview
        assert f"/runs/{check.key}/pause" not in overview
        assert f'href="/runs/{check.key}"' not in overview
        assert check.key not in console.ask("/overview/version").body  # its end is no end of a run
        assert re.search(r"mine\.toml</a>.*Being checked since", console.ask("/rigs").body)
        page = console.ask("/rigs/rig?rig=mine.toml").body
        assert "data-checking" in page
        assert 'action="/rigs/check"' not in page
        assert console.ask(f"/runs/{check.key}").status == 404
        assert console.ask(f"/runs/{check.key}/pause", "POST").status == 422
        assert STOPPED in stop_everything(console)
        _, err = process.communicate(timeout=60)
        assert process.returncode == 130
        assert ENDED.search(err)
        assert "No run and no check of this console was in progress. The queue is paused." in stop_everything(
            console
        )
        page = console.ask("/rigs/rig?rig=mine.toml").body
        assert "data-checking" not in page
        assert 'action="/rigs/check"' in page


@pytest.mark.long("takes three seconds")
def test_the_button_of_a_check_stops_it(folder):
    with started_run(folder, "check", "bench.toml", "--yes") as process, started_console(folder) as console:
        reply = console.ask(f"/runs/{announced_check().key}/stop", "POST")
        assert "The+check+is+asked+to+stop" in reply.headers["location"]
        assert "stopped by the operator (console)" in process.communicate(timeout=60)[1]
    assert process.returncode == 130


@pytest.mark.long("takes three seconds")
def test_a_check_of_a_killed_console_is_ended_by_the_next(folder):
    with started_console(folder) as first:
        first.ask("/rigs/check", "POST", first.own | FORM, urlencode({"rig": "bench.toml"}))
        check = announced_check()
        os.kill(first.process.pid, signal.SIGKILL)
    with started_console(folder) as second:
        assert check.alive
        assert STOPPED in stop_everything(second)
        waited(lambda: not check.alive, "the end of the check")
        assert "without finishing" not in second.ask("/").body  # it has switched off and said so


@pytest.mark.long("takes three seconds")
def test_a_check_of_its_own_is_told_of_once_and_why_it_ended(folder):
    with started_console(folder) as console:
        console.ask("/rigs/check", "POST", console.own | FORM, urlencode({"rig": "bench.toml"}))
        announced_check()
        assert stop_everything(console).count("was asked to stop") == 1
        page = waited(
            lambda: "data-checking" not in (body := console.ask("/rigs/rig?rig=bench.toml").body) and body,
            "the end of the check",
        )
        assert ENDED.search(html.unescape(page))


def test_a_killed_check_is_shown_until_it_is_dismissed(folder):
    with started_run(folder, "check", "bench.toml", "--yes") as process, started_console(folder) as console:
        announced_check()
        process.kill()
        process.wait()
        body = console.ask("/").body
        assert f"The check of bench (process {process.pid}) ended without finishing; it began at 20" in body
        assert "Make sure that no current flows" in body
        assert "smarig resume" not in body
        dismiss = re.search(r'action="(/ended/[^"]+/dismiss)"', body)[1]
        assert console.ask(dismiss, "POST").status == 303
        assert "without finishing" not in console.ask("/").body

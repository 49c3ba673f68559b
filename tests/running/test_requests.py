"""Requests of other processes to a run, and the status that it shows them."""

import os

import pytest

from smarig.core import UsageError
from smarig.runner import RunControl
from smarig.running import RunStatus, memory_layout, runs_in_progress
from tests.running.made import INFO, feed, made
from tests.running.runs import wait_for

pytestmark = pytest.mark.usefixtures("folder")


def test_a_stop_is_not_hidden_by_a_later_request():
    control = RunControl()
    with made(control):
        (run,) = runs_in_progress()
        for request in ("stop", "pause", "continue"):
            run.ask(request, "console")
        wait_for(lambda: control.reports())
        assert control.cause == "stopped by the operator (console)"
        assert not control.paused


def test_the_same_request_counts_again_after_another():
    control = RunControl()
    with made(control):
        (run,) = runs_in_progress()
        for request in ("pause", "continue", "pause"):
            run.ask(request, "console")
            wait_for(lambda wanted=request: control.paused == (wanted == "pause"))


def test_a_request_counts_once():
    """A key that continues the run is not undone by an earlier request to pause it."""
    control = RunControl()
    with made(control):
        (run,) = runs_in_progress()
        run.ask("pause", "console")
        wait_for(lambda: control.paused)
        control.paused = False
        shown = run.status()
        wait_for(lambda: run.status() != shown or not run.status()["paused"])
        assert not control.paused


def test_an_unknown_request_is_refused():
    with made():
        (run,) = runs_in_progress()
        with pytest.raises(UsageError, match="not to 'heat'"):
            run.ask("heat", "console")


@pytest.mark.parametrize("damage", [0, 9, 60, memory_layout.REQUEST_SIZE - 1])
def test_half_a_request_is_not_obeyed(damage, folder):
    control = RunControl()
    with made(control):
        (run,) = runs_in_progress()
        content = bytearray(memory_layout.packed_request(os.urandom(8), "stop", "console"))
        content[damage] ^= 0xFF
        with next(folder.iterdir()).open("r+b") as file:
            file.seek(memory_layout.request_at("stop"))
            file.write(content)
        run.ask("pause", "console")  # is looked for after the stop
        wait_for(lambda: control.paused)
        assert not control.stopping


def test_who_asks_is_shortened_and_printable():
    control = RunControl()
    with made(control):
        (run,) = runs_in_progress()
        run.ask("stop", "\x1b[2J" + "é" * 1000)
        wait_for(lambda: control.stopping)
    assert control.cause.isprintable()
    assert len(control.cause) < 250


def test_requests_are_obeyed_although_the_status_cannot_be_told():
    class Broken(RunStatus):
        @property
        def left_s(self):
            raise RuntimeError("changed during iteration")

    control = RunControl()
    with made(control, Broken(INFO, control)) as listener:
        feed(listener, 1, 3)
        (run,) = runs_in_progress()
        run.ask("pause", "console")
        wait_for(lambda: control.paused)
        assert run.status() == {}
        assert run.samples().newest == 3


def test_the_status_follows_the_run():
    control = RunControl()
    status = RunStatus(INFO, control)
    with made(control, status):
        (run,) = runs_in_progress()
        first = wait_for(run.status)
        assert (first["step_number"], first["last_event"], first["settling"]) == (1, None, None)
        status.event(3.5, "still_on", "é" * 5000 + "\x1b", level="warning")
        shown = wait_for(lambda: run.status()["last_event"])
        assert (shown["t_s"], shown["kind"], shown["severity"]) == (3.5, "still_on", "invalid")
        assert shown["text"].isprintable()
        assert len(shown["text"]) < 310
        status.end(None)
        assert wait_for(lambda: run.status()["ending"])["kind"] == "done"


def test_systems_without_pread_and_owners_work_too(monkeypatch):
    """Windows has none of these."""
    for name in ("pread", "pwrite", "posix_fallocate", "getuid"):
        monkeypatch.delattr(os, name, raising=False)
    control = RunControl()
    with made(control) as listener:
        feed(listener, 1, 10)
        (run,) = runs_in_progress()
        assert len(run.samples().samples) == 10
        run.ask("stop", "console")
        wait_for(lambda: control.stopping)
    assert not run.alive

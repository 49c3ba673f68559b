"""A console lists and stops what is of its folder and on the rigs that it has opened; the rest it only shows, apart."""

import signal
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlencode

import pytest

from console.web.started_console import Console, started_console
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.core import Requester
from smarig.runner import RunControl
from smarig.running import PanelRunInfo, RunStatus, announced, runs_in_progress
from tests.running.test_hostile_folder import GOOD, announcement

BENCH = 'name = "bench"\nbase = "one_wire_serial"\nwire = "shared"\n'
FORM = {"Content-Type": "application/x-www-form-urlencoded"}


class World(NamedTuple):
    """A console, and three runs: in its folder, in another folder, and in another folder on the wire of a bench."""

    console: Console
    inside: RunControl
    outside: RunControl
    on_bench: RunControl

    def key(self, name: str) -> str:
        return next(run.key for run in runs_in_progress() if run.info["protocol"] == name)


def info(name: str, folder: Path, source: str = "twin", wire: str = "w") -> PanelRunInfo:
    return PanelRunInfo(name, "r", wire, source, False, "mm", 0.1, 5, 300.0, folder / f"{name}.run.sqlite")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("scope") / "mine"
    found.mkdir()
    (found / "bench.toml").write_text(BENCH)
    return found


@pytest.fixture(scope="module")
def console(folder):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder.parent / "running"))
        with started_console(folder) as found:
            yield found


@pytest.fixture
def world(console, folder):
    """Their process is that of the test, which ignores the signal that follows a request."""
    controls = [RunControl() for _ in range(3)]
    told = [info("inside", folder / "deep"), info("outside", folder.parent, wire="shared")]
    told.append(info("on_bench", folder.parent, "bench", "shared"))
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with ExitStack() as stack:
        stack.callback(signal.signal, signal.SIGTERM, before)
        for each, control in zip(told, controls, strict=True):
            stack.enter_context(announced(each, control, RunStatus(each, control)))
        yield World(console, *controls)


def test_the_overview_lists_the_runs_of_its_folder_and_counts_the_others(world: World):
    shown = world.console.ask("/").body
    assert "Inside on r" in shown
    assert "Outside on r" not in shown
    assert '<a href="/elsewhere">2 runs of other folders are in progress</a>' in shown
    assert world.key("outside") not in world.console.ask("/overview/version").body


def test_the_others_are_shown_apart_and_cannot_be_asked(world: World):
    page, key = world.console.ask("/elsewhere").body, world.key("outside")
    assert "Outside on r" in page
    assert "On bench on r" in page
    assert "Inside on r" not in page
    assert "/stop" not in page.replace("/stop-all", "")
    assert f"/runs/{key}/stop" not in world.console.ask(f"/runs/{key}").body
    for wanted in ("stop", "pause"):
        reply = world.console.ask(f"/runs/{key}/{wanted}", "POST")
        assert reply.status == 422
        assert "This run belongs to" in reply.body
    assert not world.outside.stopping
    assert not world.outside.paused


def test_stop_everything_reaches_the_runs_of_its_folder_only_and_says_who_asked(world: World):
    reply = world.console.ask("/stop-all", "POST")
    assert "1+run+asked+to+stop" in reply.headers["location"]
    assert world.inside.cause == "stopped by the operator ('Stop everything' in the console)"
    assert world.inside.stopped_by is Requester.CONSOLE
    assert not world.outside.stopping
    assert not world.on_bench.stopping


def test_a_rig_is_stopped_with_one_click_whoever_drives_it(world: World):
    assert 'action="/rigs/stop"' in world.console.ask("/rigs/rig?rig=bench.toml").body
    assert 'action="/rigs/stop"' not in world.console.ask("/rigs/rig?rig=two_wire_serial").body
    sent = world.console.own | FORM
    world.console.ask("/rigs/stop", "POST", sent, urlencode({"rig": "bench.toml"}))
    assert "Stop this rig" in world.on_bench.cause
    assert world.on_bench.stopped_by is Requester.CONSOLE
    assert not world.inside.stopping
    assert not world.outside.stopping


def test_the_wire_of_a_rig_that_was_opened_is_in_scope(folder):
    from smarig.console.web.rig_files import rig_entry

    scope, bench = ConsoleScope(folder), {"folder": "/elsewhere", "source": "bench", "wire": "shared"}
    assert not scope.has(bench), "a rig file that lies in the folder opens nothing"
    scope.open_rig(rig_entry("bench.toml", folder).file)
    assert scope.has(bench)
    assert not scope.has(bench | {"source": "twin"}), "each twin has a wire of its own"
    assert scope.has(bench | {"source": "twin", "rig_kind": "bench"}), "simulated devices are a bench"
    scope.open_rig(rig_entry("one_wire_twin", folder).file)
    scope.open_rig(None)
    assert not scope.has({"folder": "/elsewhere", "source": "twin", "wire": "twin-one-wire"})


@pytest.mark.parametrize("told", ["/", "", "..", "a\0b", "x" * 5000, "{folder}/../other", "{folder}_2"])
def test_no_other_name_of_a_folder_is_inside(folder, told):
    assert not ConsoleScope(folder).has({"folder": told.format(folder=folder), "out": "/x"})


def test_a_link_to_the_folder_is_the_folder(folder, tmp_path):
    (tmp_path / "link").symlink_to(folder)
    assert ConsoleScope(folder.resolve()).has({"folder": str(tmp_path / "link" / "a")})


def test_dead_runs_are_left_to_the_console_of_their_folder(tmp_path, monkeypatch):
    running = tmp_path / "running"
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(running))
    running.mkdir(mode=0o700)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        dead = GOOD | {"out": str(tmp_path / name / f"{name}.run.sqlite"), "protocol": name}
        (running / f"{name}.run-in-progress").write_bytes(announcement(dead))
    for name in ("a", "b"):
        found = EndedRuns(ConsoleScope(tmp_path / name)).found()
        assert [Path(run.file).name for run in found] == [f"{name}.run.sqlite"]


def test_a_list_of_dead_runs_that_came_with_the_folder_names_no_command_and_no_file_outside(tmp_path):
    (tmp_path / "console.ended_runs.json").write_text(
        '[{"key": "1", "sentence": "s", "file": "/etc/passwd", "command": "rm -rf /"},'
        f' {{"key": "2", "sentence": "s", "file": "{tmp_path}/a b.run.sqlite", "command": "rm -rf /"}}]'
    )
    (found,) = EndedRuns(ConsoleScope(tmp_path)).found()
    assert found.command == f"smarig resume '{tmp_path}/a b.run.sqlite'"

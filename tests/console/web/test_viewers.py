"""The viewer of a run from the console: in the browser where there is no screen, and never longer than the console."""

import html
import os
import re
import signal
import urllib.error
import urllib.request

import pytest

import smarig
from console.web.started_console import Console, started_console
from running.started_run import waited

LINK = r'<a href="(http://127\.0\.0\.1:\d+/[^"]*)" target="_blank" rel="noopener noreferrer">'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a run; no screen."""
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "runs").mkdir()
    smarig.run("validation", rig="one_wire_twin", out=tmp_path / "runs" / "a.run.sqlite", points=2)
    return tmp_path / "runs"


def entry_of(console: Console) -> str:
    def found():
        return re.search(r'href="(/library/\w+)">a<', console.ask("/library").body)

    return waited(found, "the entry of the run")[1]


def answers(address: str) -> bool:
    try:
        with urllib.request.urlopen(address, timeout=10) as reply:
            return reply.status == 200
    except (urllib.error.URLError, OSError):
        return False


@pytest.mark.parametrize(
    "end",
    [
        pytest.param(end, marks=pytest.mark.long("takes ten seconds"))
        for end in (signal.SIGTERM, signal.SIGKILL)
    ],
)
def test_it_opens_in_the_browser_and_ends_with_the_console(folder, end):
    pytest.importorskip("rerun", reason="the extra 'live' is not installed")
    with started_console(folder) as console:
        place = entry_of(console)
        reply = console.ask(f"{place}/viewer", "POST")
        assert (reply.status, reply.headers["location"]) == (303, f"{place}#viewer")
        body = console.ask(place).body
        address = html.unescape(re.search(LINK, body)[1])
        waited(lambda: answers(address), "the viewer")  # its server may need a moment on a busy machine
        console.ask(f"{place}/viewer", "POST")  # it is open already
        assert html.unescape(re.search(LINK, console.ask(place).body)[1]) == address
        assert "default-src 'none'" in console.ask(place).headers["content-security-policy"]
        os.kill(console.process.pid, end)
        console.process.wait(60)
    waited(lambda: not answers(address), "the end of the viewer")


@pytest.mark.long("takes three seconds")
def test_a_missing_extra_is_its_one_sentence(folder, tmp_path, monkeypatch):
    (tmp_path / "without" / "rerun").mkdir(parents=True)
    (tmp_path / "without" / "rerun" / "__init__.py").write_text("raise ImportError")
    path = os.pathsep.join([str(tmp_path / "without"), os.environ.get("PYTHONPATH", "")])
    monkeypatch.setenv("PYTHONPATH", path)
    with started_console(folder) as console:
        place = entry_of(console)
        console.ask(f"{place}/viewer", "POST")
        body = html.unescape(console.ask(place).body)
    assert (
        "<p class=\"notice bad\" role=\"alert\">The live view needs the extra 'live': pip install 'smarig[live]'.</p>"
        in body
    )
    assert not re.search(LINK, body)


@pytest.mark.long("takes three seconds")
def test_only_runs_have_a_viewer(folder):
    with started_console(folder) as console:
        assert console.ask("/library/nothing/viewer", "POST").status == 422
        assert console.ask("/runs/nothing/viewer", "POST").status == 303

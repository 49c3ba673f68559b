"""The panel in tmux: while a run is on, paused, tripped and stopped, and in a terminal that hangs."""

import json
import os
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from smarig.record import load_run

CLOSE_TIMEOUT_S = 60.0
SLOW = "5"  # × real time: a step stands on the screen for five seconds and more
TRIPPING = """name = "tripping"
base = "one_wire_serial"
wire = "tripping"
[simulator]
speed = 0.0
faults = "{faults}"
"""
BROKEN_WIRE = '[[fault]]\nkind = "open_wire"\ndevice = "amplifier"\nfrom_s = 30\n'


class RerunOutput:
    """A terminal of tmux's with one command in it; ``text`` is what a person sees."""

    def __init__(self, socket, tmp_path):
        self._tmux = ["tmux", "-u", "-S", str(socket), "-f", os.devnull]
        self._folder = tmp_path

    def run(self, *arguments, size=(100, 30), environment=()):
        words = " ".join(f"'{w}'" for w in (sys.executable, "-m", "smarig", *map(str, arguments)))
        given = " ".join(environment)
        command = f"cd '{self._folder}' && env {given} {words}; echo status $?; exec sleep 600"
        self("new-session", "-d", "-x", str(size[0]), "-y", str(size[1]), command)

    def __call__(self, *words):
        return subprocess.run(
            [*self._tmux, *words], capture_output=True, text=True, timeout=CLOSE_TIMEOUT_S
        ).stdout

    def text(self, *, coloured=False):
        return self("capture-pane", "-p", *(["-e"] if coloured else []))

    def shows(self, *patterns):
        """Wait until all patterns are on the screen; its text."""
        until = time.monotonic() + CLOSE_TIMEOUT_S
        while time.monotonic() < until:
            text = self.text()
            if all(re.search(p, text) for p in patterns):
                return text
            time.sleep(0.05)
        pytest.fail(f"{patterns} never stood on the screen:\n{text}")

    def key(self, key):
        self("send-keys", key)


@pytest.fixture
def screen(tmp_path, tmp_path_factory):
    if shutil.which("tmux") is None:
        pytest.skip("tmux is not installed")
    socket = tmp_path_factory.mktemp("t") / "s"
    found = RerunOutput(socket, tmp_path)
    yield found
    found("kill-server")


def _kept(name, text):
    """Store screenshots in $SMARIG_CAPTURES, for inspection by people."""
    folder = os.environ.get("SMARIG_CAPTURES")
    if folder:
        Path(folder, f"panel_{name}.txt").write_text(text, encoding="utf-8")


def test_a_run_a_pause_and_a_safe_stop(screen, tmp_path):
    screen.run("run", "validation", "--rig", "one_wire_twin", "-o", "v.run.sqlite", "--speed", SLOW)
    running = screen.shows(
        r"● running",
        r"step +2 of 42 +validation +to \+23\.4 K",
        "left",
        "real time",
        r"measured \+0\.36\d\d A",
    )
    _kept("run", running)
    for part in (
        r"TWIN +validation",
        "one_wire_twin",
        "wire twin-one-wire",
        r"set \+0\.3666 A +measured \+0\.36\d\d A",
        r"position +[+-]\d\.\d{3} mm",
        r"temperature +\+\d+\.\d K",
        r"\d:\d\d:\d\d elapsed +about 0:\d\d:\d\d left",
        r"0:\d\d:\d\d of waiting, at \d+(\.\d+)? × real time",
        r"p pauses +s stops safely",
    ):
        assert re.search(part, running), part
    screen.key("p")
    paused = screen.shows(r"▮▮ PAUSED: the current stays", r"r resumes +s stops safely", r"paused: Paused by")
    _kept("pause", paused)
    screen.key("r")
    screen.shows(r"● running", "unpaused")
    screen.key("s")
    stopped = screen.shows(r"status 130")
    _kept("stop", stopped)
    line = r"■ STOPPED validation \(TWIN\): \d of 42 steps in .* stopped by the operator \(key s\)"
    line += r", highest severity minor: v\.run\.sqlite"
    assert re.search(line, stopped.replace("\n", ""))
    assert "smarig: Run stopped by the operator" in stopped
    assert "╭" not in stopped  # the panel is removed, one line stays
    assert load_run(tmp_path / "v.run.sqlite").cause == "stopped by the operator (key s)"


def test_a_trip_stays_on_the_screen_in_words_and_in_red(screen, tmp_path):
    (tmp_path / "faults.toml").write_text(BROKEN_WIRE)
    rig = tmp_path / "tripping.toml"
    rig.write_text(TRIPPING.format(faults=tmp_path / "faults.toml"))
    screen.run("run", "validation", "--rig", rig, "-o", "v.run.sqlite")
    text = screen.shows("status 3")
    _kept("trip", text)
    assert re.search(r"state +✖ TRIP: The amplifier", text)
    assert re.search(r"✖ TRIP validation \(TWIN\): 1 of 42 steps", text)
    assert "wire" in text.split("smarig:")[1]
    assert re.search(r"\x1b\[31m(\x1b\[\d+m)*✖ TRIP", screen.text(coloured=True))


@pytest.mark.long("takes three seconds")
def test_a_narrow_and_short_terminal_without_colours(screen):
    wish = ("run", "validation", "--rig", "two_wire_twin", "-o", "v.run.sqlite", "--speed", SLOW)
    screen.run(*wish, size=(60, 8), environment=("NO_COLOR=1", "COLUMNS=200"))
    text = screen.shows("running", r"step +1 of 42")
    assert max(map(len, text.splitlines())) == 60
    assert text.count("╭") == text.count("╰") == 1
    assert not re.search(
        r"\x1b\[[\d;]*[34]\d", screen.text(coloured=True).replace("\x1b[39m", "").replace("\x1b[49m", "")
    )
    screen.key("s")
    screen.shows("status 130")


def test_a_dumb_terminal_gets_lines(screen):
    wish = ("run", "validation", "--rig", "one_wire_twin", "-o", "v.run.sqlite", "--set", "points=2")
    screen.run(*wish, environment=("TERM=dumb",))
    text = screen.shows("status 0")
    assert "Keys: p pauses" in text
    assert re.search(r"step 1 of 4 saturate to \+0\.0 K: settled", text)
    assert "╭" not in text


# --- a terminal that hangs -------------------------------------------------------------------------------------


@contextmanager
def stopped_terminal():
    """A pseudo-terminal whose output has been stopped, as by Ctrl-S: whoever writes to it waits."""
    import pty
    import termios

    master, slave = pty.openpty()
    termios.tcflow(slave, termios.TCOOFF)
    try:
        yield slave
    finally:
        os.close(master)
        os.close(slave)


@pytest.mark.long("takes two seconds", cases=("xterm",))
@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
@pytest.mark.parametrize(
    "term", ["xterm", pytest.param("dumb", marks=pytest.mark.long("takes five seconds"))]
)
def test_a_terminal_that_is_stopped_holds_up_nothing(tmp_path, term):
    """A whole run is recorded and the command ends, although its stderr never takes a byte."""
    out = tmp_path / "v.run.sqlite"
    arguments = ["run", "validation", "--rig", "one_wire_twin", "-o", str(out), "--set", "points=3", "--json"]
    with stopped_terminal() as terminal:
        done = subprocess.run(
            [sys.executable, "-m", "smarig", *(arguments if term == "dumb" else arguments[:-1])],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=terminal,
            env={**os.environ, "TERM": term},
            timeout=CLOSE_TIMEOUT_S,
            text=True,
        )
    assert done.returncode == 0
    assert load_run(out).cause == "done"
    if term == "dumb":
        assert json.loads(done.stdout)["runs"][0]["steps"] == 5

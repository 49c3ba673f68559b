"""Simulated devices that do not start: the wait ends with them and can be stopped, and their last words are told."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from smarig.config import load_rig
from smarig.core.errors import ConfigError, Interrupted, RigFault
from smarig.core.resources import shipped
from smarig.plant.actuator import Actuator
from smarig.rig.open_rig import open_rig
from smarig.rig.simulator_process import running_devices
from smarig.rig.twin import TwinSettings

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX files and signals")


@pytest.fixture(autouse=True)
def patience():
    """What waits longer than a start takes is ended, and fails."""

    def give_up(*_):
        raise AssertionError("it still waits")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(30)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture
def started(tmp_path, monkeypatch):
    """A function that starts devices of this code."""
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")

    def start(code: str, while_waiting=lambda: None):
        (tmp_path / "odd_devices.py").write_text(code)
        with running_devices(["odd_devices"], tmp_path / "messages", while_waiting, keep_until_lease=False):
            pass

    return start


def test_faults_in_a_pipe_are_refused_at_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("faults.toml")
    Path("mine.toml").write_text(
        'base = "one_wire_serial"\nname = "mine"\n[simulator]\nfaults = "faults.toml"\n'
    )
    file = load_rig("mine.toml")
    with (
        pytest.raises(
            ConfigError, match=r"were not started: faults\.toml is not a regular file, so it is not"
        ),
        open_rig("mine.toml", file, Actuator.named(file.actuator), TwinSettings()),
    ):
        pass
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("module", ["simulators", "simulators.text_bench"])
def test_an_error_of_any_devices_is_one_of_the_configuration(module, tmp_path, capsys):
    """Reference devices, and instruments on a clock of their own."""
    words = [module, "--rig", str(tmp_path / "none.toml"), "--seed", "0"]
    with (
        pytest.raises(
            ConfigError, match=r"^The simulated devices were not started: There is no file .*none\.toml\.$"
        ),
        running_devices(words, tmp_path / "messages", lambda: None, keep_until_lease=False),
    ):
        pass
    assert "Error" not in capsys.readouterr().err, "the sentence is not repeated"


def test_a_crash_is_told_in_its_last_line(started, capsys):
    with pytest.raises(
        RigFault, match=r"^The simulated devices ended with status 1: ValueError: no bytes\.$"
    ):
        started("raise ValueError('no bytes')")
    assert "Traceback" in capsys.readouterr().err  # the lines before the last


def test_the_wait_ends_with_the_process_although_another_one_holds_its_output(started):
    code = (
        "import subprocess, sys\n"
        "subprocess.Popen([sys.executable, '-c', 'import sys; sys.stdin.read()'], stderr=subprocess.DEVNULL)\n"
        "sys.exit('nobody there')\n"
    )
    with pytest.raises(RigFault, match=r"status 1: nobody there\.$"):
        started(code)


def test_a_stop_does_not_wait_for_the_start(started):
    def stop():
        raise Interrupted("terminated (SIGTERM)")

    with pytest.raises(Interrupted):
        started("import sys; sys.stdin.read()", stop)


def test_devices_that_are_starting_end_with_their_host(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    code = (
        "import sys\n"
        "from simulators.starting import starting\n"
        "with starting():\n"
        "    print('starting', flush=True)\n"
        "    open(sys.argv[1]).read()\n"
    )
    path = os.pathsep.join([str(shipped("simulators").parent), os.environ.get("PYTHONPATH", "")])
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "pipe")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": path},
    ) as process:
        try:
            assert process.stdout.readline() == b"starting\n"
            process.stdin.close()
            assert process.wait() == 1
        finally:
            process.kill()

"""``--live``, ``--web`` and ``view`` on the command line: one more listener, or an error message."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from smarig.cli import run as smarig
from smarig.live import live_view
from smarig.live.viewer_process import ViewerProcess
from smarig.record import load_run

pytest.importorskip("rerun_cli", reason="rerun is not installed")

PATIENCE_S, LOOK_S = 60.0, 0.05
RUN = (
    "run",
    "step_currents",
    "--rig",
    "one_wire_twin",
    "--set",
    "currents_A=0.4",
    "--set",
    "settle.timeout_s=30",
)


def test_a_run_is_watched_on_loopback_and_recorded_all_the_same(tmp_path, capsys, monkeypatch):
    started: list[ViewerProcess] = []
    web = ViewerProcess.web

    def remembered(url: str, port: int) -> ViewerProcess:
        started.append(web(url, port))
        return started[-1]

    monkeypatch.setattr(ViewerProcess, "web", remembered)
    out = tmp_path / "watched.run.sqlite"
    assert smarig([*RUN, "-o", str(out), "--wire", "watched", "--web"]) == 0
    printed = capsys.readouterr().err
    assert "Live view: http://127.0.0.1:" in printed
    assert "telemetry" in printed
    assert len(load_run(out)) == 300
    assert [v.running for v in started] == [False]


def test_a_missing_dependency_is_reported_before_the_run_begins(tmp_path, capsys, monkeypatch):
    monkeypatch.delitem(sys.modules, "smarig.live.rerun_output", raising=False)
    monkeypatch.setitem(sys.modules, "rerun", None)
    out = tmp_path / "never.run.sqlite"
    assert smarig([*RUN, "-o", str(out), "--wire", "never", "--live"]) == 2
    assert "pip install 'smarig[live]'" in capsys.readouterr().err
    assert not out.exists()
    assert smarig([*RUN, "-o", str(out), "--wire", "never"]) == 0  # and nobody needs it otherwise


def test_a_viewer_that_cannot_start_does_not_stop_the_run(tmp_path, capsys, monkeypatch):
    def broken(url: str) -> ViewerProcess:
        return ViewerProcess(["--no-such-option"])

    monkeypatch.setattr(ViewerProcess, "native", broken)
    out = tmp_path / "alone.run.sqlite"
    assert smarig([*RUN, "-o", str(out), "--wire", "alone", "--live"]) == 0
    assert len(load_run(out)) == 300


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="others need no such variable")
def test_without_a_screen_nothing_is_begun(one_wire, tmp_path, capsys, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    out = tmp_path / "unseen.run.sqlite"
    for command in ([*RUN, "-o", str(out), "--live"], ["view", str(one_wire.path)]):
        assert smarig(command) == 2
        err = capsys.readouterr().err
        assert "No screen is available: neither DISPLAY nor WAYLAND_DISPLAY is set" in err
        assert err.strip().count("\n") == 0
    assert not out.exists()


def test_only_error_lines_are_reported(tmp_path):
    viewer = ViewerProcess(["--version"])
    try:
        viewer.process.wait(PATIENCE_S)
        log, info = viewer._log, "\x1b[32mINFO\x1b[0m Hosting a web-viewer at http://127.0.0.1:9090\n"
        log.write_text(info)
        assert viewer.complaint == ""
        log.write_text(f"\x1b[31mERROR\x1b[0m no adapter\n{info}\n")
        assert viewer.complaint == "ERROR no adapter"
    finally:
        viewer.close()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--web", "--save", "v.rrd"], "Leave --web out"),
        (["--speed", "3", "--save", "v.rrd"], "Leave --speed out"),
        (["--save", "view"], "Rename view to view.rrd"),
    ],
)
def test_a_view_that_is_saved_takes_no_options_of_one_that_is_shown(
    one_wire, tmp_path, capsys, monkeypatch, options, says
):
    monkeypatch.chdir(tmp_path)
    assert smarig(["view", str(one_wire.path), *options]) == 2
    assert says in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_drawing_that_fails_does_not_stop_the_run(tmp_path, capsys, monkeypatch):
    def broken(self, items, lost=0):
        raise RuntimeError("out of colours")

    monkeypatch.setattr(live_view.SceneRenderer, "draw", broken)
    out = tmp_path / "undrawn.run.sqlite"
    assert smarig([*RUN, "-o", str(out), "--wire", "undrawn", "--web"]) == 0
    assert "The live view ended before the run did: out of colours." in capsys.readouterr().err
    assert len(load_run(out)) == 300


@pytest.mark.long("takes two seconds")
def test_a_model_of_another_rig_is_refused(two_wire, tmp_path, capsys):
    from live.test_recording import a_model

    model = tmp_path / "wire.model.json"
    a_model().save(model)
    assert smarig(["view", str(two_wire.path), "--model", str(model), "--save", str(tmp_path / "v.rrd")]) == 4
    assert "cannot be compared" in capsys.readouterr().err
    arguments = [
        "run",
        "validation",
        "--rig",
        "two_wire_twin",
        "-o",
        str(tmp_path / "r"),
        "--live-model",
        str(model),
    ]
    assert smarig(arguments) == 2
    assert "is in mm, but the rig measures in deg" in capsys.readouterr().err


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the kernel of Linux ends orphans, others do not"
)
def test_the_viewer_does_not_outlive_a_host_that_was_killed():
    program = (
        "from smarig.live.viewer_process import ViewerProcess, free_port, viewer_address\n"
        "import time\n"
        "v = ViewerProcess.web(viewer_address(free_port()), free_port())\n"
        "print(v.process.pid, v._home, flush=True)\n"
        "time.sleep(60)\n"
    )
    host = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert host.stdout is not None
    pid, home = host.stdout.readline().split()
    until = time.monotonic() + PATIENCE_S
    while "rerun" not in Path(f"/proc/{pid}/comm").read_text():  # it becomes the viewer
        assert time.monotonic() < until
        time.sleep(LOOK_S)
    host.send_signal(signal.SIGKILL)
    host.wait()
    host.stdout.close()
    while alive(int(pid)):
        assert time.monotonic() < until, "the viewer outlived us"
        time.sleep(LOOK_S)
    later = ViewerProcess(["--version"])  # nobody was there to remove its folder: the next one does
    assert not Path(home).exists()
    assert Path(later._home).is_dir()
    later.close()


def alive(pid: int) -> bool:
    """Whether a process runs; one that only waits to be buried does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_nothing_of_the_viewer_is_written_into_a_home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    viewer = ViewerProcess(["--version"])
    try:
        viewer.process.wait(PATIENCE_S)
        assert viewer.process.returncode == 0
        assert '"analytics_enabled": false' in (Path(viewer._home) / "rerun" / "analytics.json").read_text()
    finally:
        viewer.close()
    assert not list(tmp_path.iterdir())

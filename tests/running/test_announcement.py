"""Every command that drives a rig announces its run; one that cannot be announced runs, and its record says so."""

import subprocess
import sys

import pytest

from running.started_run import VALIDATION, found_run, started_run
from smarig.record import stored_run
from smarig.runner import RunControl
from smarig.running import PanelRunInfo, announced, runs_in_progress

COMMANDS = {
    "characterise": ("characterise", "--rig", "one_wire_twin"),
}


def _warnings(path):
    with stored_run(path) as run:
        return [(e.level, e.text) for e in run.events if e.kind == "not_announced"], run.cause


def _run(folder, **more):
    command = [
        sys.executable,
        "-m",
        "smarig",
        *VALIDATION[:4],
        "--set",
        "points=2",
        "--quiet",
        "-o",
        "a.run.sqlite",
    ]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, **more)


@pytest.mark.parametrize("place", ["a file", "open to others", "a link"])
def test_a_folder_that_cannot_be_used_leaves_the_run_alone_and_is_recorded(tmp_path, running_dir, place):
    if place == "a file":
        running_dir.write_text("mine")
    elif place == "open to others":
        running_dir.mkdir()
        running_dir.chmod(0o777)
    else:
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        running_dir.symlink_to(tmp_path / "elsewhere")
    done = _run(tmp_path)
    assert done.returncode == 0, done.stderr
    ((level, text),), cause = _warnings(tmp_path / "a.run.sqlite")
    assert level == "warning"
    assert text.startswith("Other processes cannot see this run: ")
    assert cause == "done"


def test_a_full_file_system_leaves_the_run_alone(tmp_path, running_dir, monkeypatch):
    import errno

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.posix_fallocate", full)
    control = RunControl()
    with announced(_info(tmp_path), control) as announcement:
        assert announcement is None
    ((kind, text, level),) = control.reports()
    assert (kind, level) == ("not_announced", "warning")
    assert "No space left on device" in text
    assert list(running_dir.iterdir()) == []


def test_a_file_size_limit_of_the_process_leaves_the_announcement_away_and_not_the_program(
    tmp_path, running_dir
):
    """The system refuses the blocks, as a full memory does; a hole would end the process at the first sample."""
    script = (
        "import resource, sys; from pathlib import Path; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000)); "
        "from smarig.runner import RunControl; from smarig.running import PanelRunInfo, announced\n"
        "control = RunControl()\n"
        "info = PanelRunInfo('p', 'r', 'w', 'twin', False, 'mm', 0.1, 5, 300.0, Path('a'))\n"
        "with announced(info, control) as a: print(a, control.reports()[0][0])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.stdout.strip(), done.returncode) == ("None not_announced", 0), done.stderr
    assert list(running_dir.iterdir()) == []


def _info(folder, **other):
    facts = ("validation", "one_wire_twin", "w1", "twin", False, "mm", 0.1, 5, 300.0, folder / "a.run.sqlite")
    return PanelRunInfo(*facts, **other)


def test_a_description_that_cannot_be_written_leaves_the_run_alone(tmp_path, running_dir):
    control = RunControl()
    with announced(_info(tmp_path, done_s=1j), control) as announcement:  # no value of JSON
        assert announcement is None
    assert [kind for kind, _, _ in control.reports()] == ["not_announced"]
    assert list(running_dir.iterdir()) == []


def test_a_status_that_cannot_be_written_does_not_end_obedience(tmp_path, monkeypatch):
    control = RunControl()
    with announced(_info(tmp_path), control) as announcement:
        assert announcement is not None

        def broken(_):
            raise ZeroDivisionError

        monkeypatch.setitem(type(announcement)._attend.__globals__, "status_of", broken)
        announcement._finished.wait(0.3)
        runs_in_progress()[0].ask("stop", "test")
        for _ in range(100):
            if control.stopping:
                break
            announcement._finished.wait(0.1)
    assert control.cause == "stopped by the operator (test)"


def test_the_announcement_ends_with_an_error_of_the_run(tmp_path, running_dir):
    with pytest.raises(RuntimeError, match="of the run, 1 found"), announced(_info(tmp_path), RunControl()):
        raise RuntimeError(f"of the run, {len(runs_in_progress())} found")
    assert list(running_dir.iterdir()) == []


def test_names_that_a_terminal_would_execute_are_escaped_in_the_description(tmp_path):
    hostile = PanelRunInfo(
        "p\x1b[2J", "r\n", "w\udc80", "twin", False, "mm", 0.1, 5, 300.0, tmp_path / "b\udcff"
    )
    with announced(hostile, RunControl()):
        (run,) = runs_in_progress()
    assert run.info["protocol"] == "p\\x1b[2J"
    assert "\udc80" not in run.info["wire"]
    assert run.info["out"] == str(tmp_path / "b\udcff")  # the file must be found


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_that_drives_a_rig_is_announced(tmp_path, name):
    more = () if name == "characterise" else ("--speed", "20")
    out = "folder" if name == "characterise" else "a.run.sqlite"
    with started_run(tmp_path, *COMMANDS[name], *more, "-o", out) as process:
        run = found_run(process)
        assert run.info["rig"] == "one_wire_twin"
        assert name in run.info["command"]


def test_a_resumed_run_is_announced_with_what_was_done_before(tmp_path):
    with started_run(tmp_path) as process:
        run = found_run(process)
        while run.status()["step_number"] < 3:
            assert process.poll() is None
        process.kill()
        process.wait()
    with started_run(tmp_path, "resume", "a.run.sqlite", "--speed", "20") as process:
        info = found_run(process).info
    assert "resume" in info["command"]
    assert info["done_steps"] >= 1
    assert info["done_s"] > 0

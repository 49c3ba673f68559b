"""``smarig resume``, ``--notify`` and the keys, as used in the lab."""

import json
import os
import select
import shlex
import shutil
import sqlite3
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

import smarig
from runner.interrupted import cut
from smarig.cli import run as cli
from smarig.cli.panel.keyboard import press
from smarig.config import locate
from smarig.core import Interrupted
from smarig.record import WireHistory, load_run
from smarig.runner.run_control import RunControl
from smarig.runner.runner import Runner

PATIENCE_S = 120.0  # ends a test that has failed


def call(capsys, *arguments):
    status = cli([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return status, out, err


@pytest.fixture
def killed(tmp_path):
    whole = smarig.run("validation", rig="one_wire_twin", out=tmp_path / "whole.run.sqlite", points=3)
    return cut(whole.path, tmp_path / "killed.run.sqlite", 1700)


def test_resume_reports_how_it_ended(capsys, killed):
    status, out, err = call(capsys, "resume", killed, "--json")
    found = json.loads(out)
    assert status == 0
    assert (found["cause"], found["start_over"], found["run"]) == ("done", False, str(killed))
    assert found["void"] >= 4
    assert found["before"].startswith("incomplete")
    assert "ended with the cause: incomplete: the run was never closed.\nThe rig was re-armed." in err


def test_a_command_without_a_question_says_so(capsys):
    status, _, err = call(capsys, "run", "validation", "--rig", "one_wire_twin", "--yes")
    assert status == 2
    assert err == "smarig: smarig run asks no question, so it has no option --yes. Leave it out.\n"
    assert "No such option" in call(capsys, "run", "validation", "--rig", "one_wire_twin", "--yess")[2]


_CARRY_OUT = Runner._carry_out


def _stopped(self, command):
    """A recorded command during which somebody presses Ctrl-C."""
    if len(self.listeners) == 1:  # a preview
        return _CARRY_OUT(self, command)
    raise Interrupted("interrupted by the keyboard (Ctrl-C)")


@pytest.mark.parametrize("command", ["run", "resume"])
def test_a_stopped_run_names_the_whole_command_that_continues_it(capsys, tmp_path, monkeypatch, command):
    rig, out = tmp_path / "rig.toml", tmp_path / "a.run.sqlite"
    rig.write_text('name = "rig"\nbase = "one_wire_twin"\n')
    options = ("run", "validation", "--rig", rig, "-o", out, "--set", "points=2", "--quiet")
    if command == "resume":
        assert call(capsys, *options)[0] == 0
        out = cut(out, tmp_path / "k.run.sqlite", 1500)
        options = ("resume", out, "--rig", rig, "--quiet")
    monkeypatch.setattr(Runner, "_carry_out", _stopped)
    status, _, err = call(capsys, *options)
    assert status == 130
    assert err.strip().endswith(f"the current is at zero. smarig resume {out} --rig {rig} continues it.")
    assert err.count("smarig resume") == 1


OWN_PROTOCOL = """from smarig.core import Hold, Settled
SUMMARY = "Two levels."
def two_levels(setup):
    for input_K in (40.0, 60.0):
        yield Hold(setup.current_for(input_K), Settled(0.01, 1.0), target=input_K)
"""


@pytest.mark.parametrize("own", ["protocol", "file"])
def test_the_command_that_continues_a_stopped_run_continues_it(capsys, tmp_path, monkeypatch, own):
    """It names the user's own protocol and profile again, also where their paths hold a blank."""
    folder = tmp_path / "of mine"
    folder.mkdir()
    protocol, profile, out = folder / "two_levels.py", folder / "p.csv", tmp_path / "a.run.sqlite"
    protocol.write_text(OWN_PROTOCOL)
    profile.write_text("temperature_K\n10\n60\n")
    what = {"protocol": [protocol], "file": ["step_currents", "--set", f"file={profile}"]}[own]
    with monkeypatch.context() as stopping:
        stopping.setattr(Runner, "_carry_out", _stopped)
        status, _, err = call(capsys, "run", *what, "--rig", "one_wire_twin", "-o", out, "--quiet")
    assert status == 130
    program, *arguments = shlex.split(err.strip().rpartition("zero. ")[2].removesuffix(" continues it."))
    assert program == "smarig"
    status, result, err = call(capsys, *arguments, "--quiet", "--json")
    assert status == 0, err
    assert json.loads(result)["cause"] == "done"


@pytest.mark.parametrize(
    ("status", "arguments", "says"),
    [
        (2, ["whole.run.sqlite"], "is finished"),
        (2, ["nowhere.run.sqlite"], "nowhere.run.sqlite"),
        (2, ["killed.run.sqlite", "--rig", "two_wire_twin"], "not on 'two_wire_twin'"),
        (2, ["killed.run.sqlite", "--wire", "b"], "to wire 'twin-one-wire', not to 'b'"),
        (4, ["notes.txt"], "is not a run file"),
    ],
)
def test_a_mistake_gets_its_status_and_one_sentence(
    capsys, tmp_path, monkeypatch, killed, status, arguments, says
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("not a run")
    before = killed.read_bytes()
    got, _, err = call(capsys, "resume", *arguments)
    assert got == status
    assert says in err
    assert err.strip().count("\n") == 0
    assert killed.read_bytes() == before


def test_an_imported_run_is_refused(capsys, tmp_path):
    table = tmp_path / "t.csv"
    table.write_text("input_K,position_mm\n" + "".join(f"{k},{k / 10}\n" for k in range(20)))
    call(capsys, "import", table, "--format", "csv", "-o", tmp_path / "i.run.sqlite")
    status, _, err = call(capsys, "resume", tmp_path / "i.run.sqlite")
    assert status == 2, err


@pytest.mark.long("takes three seconds")
def test_reports_and_exports_read_a_resumed_run(capsys, tmp_path, killed):
    with sqlite3.connect(killed) as db:  # of a wire that outlives its runs
        db.execute("INSERT INTO run VALUES ('wire_history', '\"3 runs\"')")
    db.close()
    assert call(capsys, "resume", killed)[0] == 0
    assert call(capsys, "report", killed, "-o", tmp_path / "r.html")[0] == 0
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "re-establish" in page
    assert "Wire before this run" in page
    assert "3 runs" in page
    assert call(capsys, "export", killed, "--to", "csv", "-o", tmp_path / "r.csv")[0] == 0


def test_wires_are_listed(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path))
    WireHistory("A7", runs=2, cycles=20, largest_input_K=174.0).save()
    WireHistory("old", twin=True, runs=1).save()
    status, out, _ = call(capsys, "list", "wires", "--json")
    assert status == 0
    listed = json.loads(out)["wires"]
    assert list(listed) == ["A7", "old (twin)"]
    assert listed["A7"].startswith("2 runs, 20 cycles, ")


# --- a rig that was edited meanwhile ---------------------------------------------------------------------------


@pytest.fixture
def killed_on_own_files(tmp_path, monkeypatch):
    """A killed run on a rig file with a base and an actuator beside it."""
    monkeypatch.chdir(tmp_path)
    base = locate("rigs", "one_wire_twin").read_text("utf-8")
    Path("base.toml").write_text(base.replace('"gorbet_one_wire"', '"wire.toml"'), "utf-8")
    Path("mine.toml").write_text('name = "mine"\nbase = "base.toml"\n', "utf-8")
    shutil.copy(locate("actuators", "gorbet_one_wire"), "wire.toml")
    whole = smarig.run("validation", rig="mine.toml", out="whole.run.sqlite", points=2)
    return cut(whole.path, Path("killed.run.sqlite"), 900)


def edit(name, old, new):
    text = Path(name).read_text("utf-8")
    assert text.count(old) == 1
    Path(name).write_text(text.replace(old, new), "utf-8")


RADIUS = ("wire.toml", "radius = { value = 15.0", "radius = { value = 18.0")
COUNTS = ("base.toml", "counts_per_rev = 2000", "counts_per_rev = 4000")
COMMENT = ("wire.toml", "[transmission]", "[transmission]  # of the pulley")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (RADIUS, "transmission.radius was 15 mm, is now 18 mm"),
        (COUNTS, "encoder.counts_per_rev was 2000, is now 4000"),
    ],
)
def test_another_scale_is_refused_before_anything_moves(capsys, killed_on_own_files, change, says):
    """One position column has one scale."""
    before = killed_on_own_files.read_bytes()
    edit(*change)
    arguments = ("run", "validation", "--set", "points=2", "--rig", "mine.toml", "-o", killed_on_own_files)
    for words in (
        ("resume", killed_on_own_files, "--rig", "mine.toml"),
        (*arguments, "--continue", "--quiet"),
    ):
        status, _, err = call(capsys, *words)
        assert status == 2
        assert says in err
        assert err.strip().count("\n") == 0
        assert killed_on_own_files.read_bytes() == before


@pytest.mark.long("takes three seconds")
def test_a_comment_is_told_in_a_line(capsys, killed_on_own_files):
    edit(*COMMENT)
    status, out, err = call(capsys, "resume", killed_on_own_files, "--rig", "mine.toml", "--quiet", "--json")
    assert status == 0
    assert "the actuator file has another text, but the same values" in json.loads(out)["how"]
    assert err.splitlines()[-1].endswith("the actuator file has another text, but the same values.")
    assert [e.data["key"] for e in load_run(killed_on_own_files).events if e.kind == "rig"] == [
        "actuator_text"
    ]


@pytest.mark.long("takes three seconds")
def test_a_raised_limit_is_told_in_the_log_before_the_run_goes_on(capsys, killed_on_own_files):
    edit("base.toml", "temperature_max_K = 185.0", "temperature_max_K = 190.0")
    status, _, err = call(capsys, "resume", killed_on_own_files, "--rig", "mine.toml")
    assert status == 0
    lines = err.splitlines()
    told = next(k for k, line in enumerate(lines) if "MINOR rig: Since the interruption: limits" in line)
    assert "limits.temperature_max_K was 185, is now 190" in lines[told]
    assert told < next(k for k, line in enumerate(lines) if line.startswith("✔"))


# --- --notify --------------------------------------------------------------------------------------------------

TELL = 'echo "$SMARIG_STATUS|$SMARIG_CAUSE|$SMARIG_RUN" > told.txt'


@pytest.mark.skipif(os.name == "nt", reason="a POSIX shell")
def test_the_notify_command_runs_at_the_end_and_at_a_trip(capsys, tmp_path, monkeypatch, killed):
    monkeypatch.chdir(tmp_path)
    notification_file = tmp_path / "told.txt"
    assert call(capsys, "resume", killed, "--notify", TELL)[0] == 0
    assert notification_file.read_text() == f"0|done|{killed}\n"
    out = tmp_path / "t; touch evil.run.sqlite"
    arguments = ["run", "validation", "--rig", "one_wire_twin", "-o", out, "--set", "points=2"]
    monkeypatch.setattr("smarig.rig.twin.Twin.step", _tripping)
    status, _, err = call(capsys, *arguments, "--notify", TELL)
    assert status == 3
    cause = "The twin was struck by lightning. The current is at zero."
    assert notification_file.read_text() == f"3|{cause}|{out}\n"
    assert not list(tmp_path.glob("evil*"))
    assert err.count("lightning") == 1


def _tripping(self, current_A, at_most=1):
    from smarig.core.errors import RigFault

    if not self.settings.noise:  # the preview's
        self.output_A = current_A
        return (self._advance(current_A),)
    raise RigFault("The twin was struck by lightning.")


@pytest.mark.skipif(os.name == "nt", reason="a POSIX shell")
def test_a_failing_notify_command_is_a_message_and_no_failure(capsys, tmp_path):
    out = tmp_path / "v.run.sqlite"
    arguments = ["run", "validation", "--rig", "one_wire_twin", "-o", out, "--set", "points=2"]
    status, text, err = call(capsys, *arguments, "--json", "--notify", "echo noise; exit 7")
    assert status == 0
    assert json.loads(text)["runs"][0]["cause"] == "done"
    assert [line for line in err.splitlines() if "--notify" in line] == [
        "--notify: 'echo noise; exit 7' failed: exit status 7."
    ]


# --- keys ----------------------------------------------------------------------------------------------------------


AT_A_TERMINAL = """
import fcntl, os, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.executable, [sys.executable, "-m", "smarig", *sys.argv[1:]])
"""


def test_what_keys_mean():
    control = RunControl()
    for key, paused in (("p", True), ("x", True), ("r", False), ("p", True)):
        press(control, key)
        assert control.paused is paused
    press(control, "s")
    assert control.stopping


@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
def test_keys_of_a_terminal_pause_resume_and_stop(tmp_path):
    """Another process at a terminal of its own: every key shows in the record, and the terminal comes back."""
    import pty
    import termios

    out = tmp_path / "r.run.sqlite"
    terminal, theirs = pty.openpty()
    command = ["run", "first_order_descending", "--rig", "one_wire_twin", "-o", str(out), "--speed", "100"]
    child = subprocess.Popen(
        [sys.executable, "-c", AT_A_TERMINAL, *command],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        start_new_session=True,
    )
    before = termios.tcgetattr(terminal)
    try:
        _wait_until(terminal, lambda: _samples(out) > 0)
        assert not termios.tcgetattr(terminal)[3] & termios.ICANON
        os.write(terminal, b"\x1a")  # Ctrl-Z must not stop a host whose wire is hot
        os.write(terminal, b"p")
        _wait_until(terminal, lambda: "paused" in _kinds(out))
        paused_at = _samples(out)
        _wait_until(terminal, lambda: _samples(out) > paused_at + 100)
        os.write(terminal, b"r")
        _wait_until(terminal, lambda: "unpaused" in _kinds(out))
        os.write(terminal, b"s")
        _wait_until(terminal, lambda: child.poll() is not None)
        after = termios.tcgetattr(terminal)
    finally:
        child.kill()
        child.wait()
        os.close(terminal)
        os.close(theirs)
    assert child.returncode == 130
    assert after == before
    run = load_run(out)
    assert run.cause == "stopped by the operator (key s)"
    pause, go_on = (next(e.t_s for e in run.events if e.kind == k) for k in ("paused", "unpaused"))
    held = run["current_command_A"][(run["t_s"] > pause) & (run["t_s"] <= go_on)]
    assert held.size > 100
    assert len(set(held)) == 1


def _samples(out):
    try:
        return len(load_run(out))
    except smarig.core.errors.SmarigError:
        return 0


def _kinds(out):
    return {e.kind for e in load_run(out).events}


def _read(terminal):
    """Whatever it has written, so that it never waits for us."""
    if select.select([terminal], [], [], 0.02)[0]:
        with suppress(OSError):
            os.read(terminal, 65536)


def _wait_until(terminal, condition):
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        _read(terminal)
        if condition():
            return
    pytest.fail("nothing of it was seen in the record")


# --- campaigns ---------------------------------------------------------------------------------------------------

CAMPAIGN = """
name = "two"
summary = "Two short ones."
[[step]]
protocol = "initialise"
[[step]]
protocol = "validation"
set = { points = 3 }
[[step]]
protocol = "validation"
name = "again"
set = { points = 2 }
"""


@pytest.mark.long("takes two seconds")
def test_a_campaign_resumes_where_it_was_interrupted(capsys, tmp_path):
    plan, out = tmp_path / "two.toml", tmp_path / "runs"
    plan.write_text(CAMPAIGN, encoding="utf-8")
    command_line = ("run", plan, "--rig", "one_wire_twin", "-o", out)
    assert call(capsys, *command_line)[0] == 0
    first, second, third = sorted(out.glob("*.run.sqlite"))
    whole = second.rename(tmp_path / "whole.run.sqlite")
    cut(whole, second, 1700)
    third.unlink()
    done = first.read_bytes()
    status, _, err = call(capsys, *command_line)
    assert (status, "--continue" in err) == (2, True)
    status, _, err = call(capsys, *command_line, "--continue")
    assert status == 0, err
    assert first.read_bytes() == done
    assert [load_run(p).cause for p in (second, third)] == ["done", "done"]
    assert any(s.void for s in load_run(second).steps)
    assert "is finished." in err
    assert "Resumed" in err


def test_resuming_with_another_experiment_is_refused(capsys, tmp_path, killed):
    before = killed.read_bytes()
    for other in (
        ["validation", "--set", "points=4"],
        ["congruency"],
        ["validation", "--set", "points=3", "--wire", "b"],
    ):
        status, _, err = call(capsys, "run", *other, "--rig", "one_wire_twin", "-o", killed, "--continue")
        assert (status, "Give another folder" in err) == (2, True)
    assert killed.read_bytes() == before


@pytest.mark.long("takes a second", cases=("interrupted",))
@pytest.mark.parametrize("second_run", ["interrupted", "missing"])
def test_a_campaign_is_not_continued_on_another_scale(capsys, tmp_path, killed_on_own_files, second_run):
    """Not even where its finished runs are only skipped: the runs of a campaign belong together."""
    plan, out = tmp_path / "two.toml", tmp_path / "runs"
    plan.write_text(CAMPAIGN, encoding="utf-8")
    command_line = ("run", plan, "--rig", "mine.toml", "-o", out, "--quiet")
    assert call(capsys, *command_line)[0] == 0
    first, second, third = sorted(out.glob("*.run.sqlite"))
    whole = second.rename(tmp_path / "second.run.sqlite")
    third.unlink()
    if second_run == "interrupted":
        cut(whole, second, 1700)
    before = {path: path.read_bytes() for path in out.iterdir()}
    edit(*RADIUS)
    status, _, err = call(capsys, *command_line, "--continue")
    assert (status, "transmission.radius was 15 mm, is now 18 mm" in err) == (2, True)
    assert f"{first.name} was made with other values" in err
    assert {path: path.read_bytes() for path in out.iterdir()} == before


@pytest.mark.long("takes three seconds")
def test_a_run_that_a_fault_ended_says_how_to_continue_it(capsys, tmp_path):
    faults, rig, out = tmp_path / "faults.toml", tmp_path / "rig.toml", tmp_path / "a.run.sqlite"
    jump = '[[fault]]\nkind = "jumping_encoder"\ndevice = "encoder_daq"\ncounts = 500\nfrom_s = {}\n'
    faults.write_text(jump.format(30))
    rig.write_text(f'name = "rig"\nbase = "one_wire_serial"\nsimulator.faults = "{faults}"\n')
    options = ("run", "step_currents", "--rig", rig, "-o", out, "--set", "currents_A=0.4", "--quiet")
    status, _, err = call(capsys, *options)
    assert status == 3
    assert (
        f"When the cause is removed, smarig resume {out} --rig {rig} continues this run.\nsmarig: The position"
        in err
    )
    faults.write_text(jump.format(5))
    status, _, err = call(capsys, "resume", out, "--rig", rig, "--quiet")
    assert status == 3
    assert f"When the cause is removed, smarig resume {out} --rig {rig} continues this run." in err
    faults.write_text(jump.format(9000))
    assert call(capsys, "resume", out, "--rig", rig, "--quiet")[0] == 0
    assert load_run(out).cause == "done"
    missing = tmp_path / "missing.toml"
    missing.write_text(
        'name = "missing"\nbase = "bench_one_wire"\nlinks.amplifier.url = "/dev/absent"\n'
        'links.encoder_daq.url = "/dev/absent2"\n'
    )
    status, _, err = call(capsys, *options[:3], missing, "-o", tmp_path / "b.run.sqlite", *options[6:])
    assert status != 0
    assert "resume" not in err, "nothing was recorded"

"""Every ending is safe and recorded: signals, exceptions, a full disk, kill -9, with real processes and
files.

The delay of the ending is measured with ``SMARIG_LONG``, on a machine that keeps real time.
"""

import contextlib
import os
import pwd
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import smarig
from smarig.core.errors import Interrupted, StorageError
from smarig.record import check_run
from smarig.record import recorder as recorder_module
from smarig.runner import signal_handling
from smarig.runner.listener import CallbackListener
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session

SPEED = 100  # × real time: a run lasts much longer than any test waits
LONG = bool(os.environ.get("SMARIG_LONG"))
PATIENCE_S = 60.0  # ends a test that has failed
SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
posix = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")


def start(out: Path, *extra: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "smarig", "run", "first_order_descending", "--rig", "one_wire_twin"]
    return subprocess.Popen(
        [*command, "-o", str(out), "--speed", str(SPEED), *extra],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def wait_for_samples(process: subprocess.Popen, out: Path, at_least: int) -> None:
    """Until another process (this one) can read that many samples of the growing run."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        if out.exists():
            try:
                if len(smarig.load_run(out)) >= at_least:
                    return
            except smarig.record.run.DataError:
                pass  # the file exists, its tables not yet
        try:
            process.wait(timeout=0.02)
        except subprocess.TimeoutExpired:
            continue
        break
    pytest.fail(f"no {at_least} samples: {process.communicate()}")


@pytest.mark.long("takes two seconds", cases=("SIGHUP",))
@posix
@pytest.mark.parametrize("name", [s.name for s in SIGNALS])
def test_signals_close_the_run_at_zero_within_a_second(tmp_path, name):
    out = tmp_path / "r.run.sqlite"
    process = start(out)
    wait_for_samples(process, out, 100)
    asked = time.monotonic()
    process.send_signal(getattr(signal, name))
    _, stderr = process.communicate(timeout=PATIENCE_S)
    assert not LONG or time.monotonic() - asked < 1.0
    assert process.returncode == 130
    assert sum(line.startswith("smarig:") for line in stderr.splitlines()) == 1, stderr
    assert "Traceback" not in stderr
    run = smarig.load_run(out)
    assert run.complete
    assert run.cause != "done"
    assert name in run.cause or "Ctrl-C" in run.cause
    assert not list(tmp_path.glob("*-wal"))


@posix
@pytest.mark.parametrize("name", [s.name for s in SIGNALS])
def test_a_signal_ends_the_run_with_the_next_tick(tmp_path, name):
    def at_50(sample, _step, _input_K):
        if sample.tick == 50:
            signal.raise_signal(getattr(signal, name))

    out = tmp_path / "r.run.sqlite"
    before = {number: signal.getsignal(number) for number in SIGNALS}
    try:
        with Session("one_wire_twin") as session:
            with pytest.raises(Interrupted):
                session.run("first_order_descending", {}, out, listeners=[CallbackListener(on_sample=at_50)])
            assert session.rig.output_A == 0.0
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    run = smarig.load_run(out)
    assert (len(run), run.complete) == (50, True)
    asked = run.stopped_by
    assert asked.kind == ("user" if name == "SIGINT" else "signal")
    assert asked.account == pwd.getpwuid(os.getuid()).pw_name
    assert f"Its end was requested by {asked.text}." in check_run(out).sentences()[1]
    assert check_run(out).to_json()["stopped_by"] == {"kind": asked.kind, "account": asked.account}


@pytest.mark.long("takes two seconds")
@posix
def test_a_storm_of_signals_ends_as_one(tmp_path):
    """Impatience tears nothing: one sentence, the run closed, status 130."""
    out = tmp_path / "r.run.sqlite"
    process = start(out)
    wait_for_samples(process, out, 100)
    for number in [signal.SIGTERM, signal.SIGHUP, *[signal.SIGTERM] * 30]:
        process.send_signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=0.02)
    _, stderr = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert stderr.count("smarig: ") == 1, stderr
    assert "Traceback" not in stderr
    assert smarig.load_run(out).complete


@posix
def test_repeated_ctrl_c_reports_that_the_current_is_at_zero(tmp_path):
    """A key held down is one wish: the run is closed into one file, and the sentence is that of any interrupted run."""
    out = tmp_path / "r.run.sqlite"
    process = start(out)
    wait_for_samples(process, out, 100)
    for _ in range(12):
        process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=0.002)
    _, stderr = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert "Ctrl-C): it is closed, the current is at zero." in stderr
    assert smarig.load_run(out).complete
    assert sorted(p.name for p in tmp_path.iterdir()) == [out.name]


class Clock:
    """The time that endings goes by."""

    now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s


def impatient(control: RunControl, put_away: list[str], clock: Clock) -> None:
    """Ctrl-C twice at once, a third time after a while, and a fourth while things are put away."""
    with signal_handling.stop_on_signals(control):
        try:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
            clock.now_s += 1.1 * signal_handling.INSISTS_S
            put_away.append("nothing torn yet")
            signal.raise_signal(signal.SIGINT)
            put_away.append("never reached")
        finally:
            signal.raise_signal(signal.SIGINT)
            put_away.append("closed")


@posix
def test_a_second_ctrl_c_acts_once_and_reports_the_same_cause(monkeypatch):
    """A run that does not end is torn by a second Ctrl-C; what it puts away then is not torn by a third."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    put_away, control, clock = [], RunControl(), Clock()
    monkeypatch.setattr(signal_handling, "time", clock)
    try:
        with pytest.raises(Interrupted, match="Ctrl-C"):
            impatient(control, put_away, clock)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert put_away == ["nothing torn yet", "closed"]
    assert control.stopping


@pytest.mark.long("takes two seconds")
@posix
def test_what_was_to_be_ignored_is_ignored(tmp_path):
    """nohup: a night's run does not end with the login."""
    out = tmp_path / "r.run.sqlite"
    ignoring = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        process = start(out)
    finally:
        signal.signal(signal.SIGHUP, ignoring)
    wait_for_samples(process, out, 100)
    process.send_signal(signal.SIGHUP)
    wait_for_samples(process, out, len(smarig.load_run(out)) + 500)
    process.terminate()
    process.communicate(timeout=PATIENCE_S)
    assert "SIGTERM" in smarig.load_run(out).cause


@posix
@pytest.mark.parametrize("moment", range(10) if LONG else [1])
def test_kill_9_loses_at_most_the_last_second(tmp_path, moment):
    out = tmp_path / "r.run.sqlite"
    process = start(out)
    wait_for_samples(process, out, random.Random(moment).randint(1, 4000))
    observed = len(smarig.load_run(out))
    assert smarig.load_run(out).cause == "incomplete: the run is still being recorded"
    killed = time.time()
    process.kill()
    process.communicate()
    run = smarig.load_run(out)
    assert len(run) >= observed
    assert not run.complete
    assert "never closed" in run.cause
    started = next(e for e in run.events if e.kind == "start").data["epoch"]
    assert not LONG or run["t_s"][-1] / SPEED >= killed - started - 1.0
    assert list(run["tick"]) == list(range(1, len(run) + 1))


def test_a_full_disk_stops_the_run_and_keeps_what_was_written(tmp_path, monkeypatch):
    out = tmp_path / "r.run.sqlite"
    free = {"bytes": 10**12}

    def fill_up_at_200(sample, _step, _input_K):
        if sample.tick == 200:
            free["bytes"] = 1000

    usage = type("Usage", (), {"free": property(lambda _: free["bytes"])})()
    monkeypatch.setattr(recorder_module.shutil, "disk_usage", lambda _: usage)
    monkeypatch.setattr(recorder_module, "COMMIT_INTERVAL_S", 0.001)
    with Session("one_wire_twin", speed=2000) as session:
        with pytest.raises(StorageError, match="cannot be written"):
            session.run(
                "first_order_descending", {}, out, listeners=[CallbackListener(on_sample=fill_up_at_200)]
            )
        assert session.rig.rig.output_A == 0.0
    run = smarig.load_run(out)
    assert len(run) >= 200
    assert "cannot be written" in run.cause


def test_a_long_run_is_refused_before_it_starts_when_space_is_short(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder_module.shutil, "disk_usage", lambda p: type("U", (), {"free": 10_000_000})())
    out = tmp_path / "r.run.sqlite"
    with pytest.raises(StorageError, match="MB free"), Session("one_wire_twin") as session:
        session.run("validation", {}, out)
    assert not out.exists()


def test_an_exception_in_a_listener_closes_the_run_with_its_cause(tmp_path):
    class Broken:
        def sample(self, s, step, input_value):
            if s.tick == 50:
                raise ZeroDivisionError("viewer bug")

        def step(self, *a, **k): ...
        def event(self, *a, **k): ...

    out = tmp_path / "r.run.sqlite"
    with pytest.raises(ZeroDivisionError), Session("one_wire_twin") as session:
        session.run("validation", {}, out, listeners=[Broken()])
    run = smarig.load_run(out)
    assert run.cause == "failed: ZeroDivisionError: viewer bug"
    assert len(run) == 50
    assert session.rig.output_A == 0.0


def test_a_disk_that_fails_at_the_very_end_is_not_passed_over(tmp_path, monkeypatch):
    def refuse(self):
        raise recorder_module.sqlite3.OperationalError("database or disk is full")

    out = tmp_path / "r.run.sqlite"
    recorder = recorder_module.Recorder(out, {"rig": "x"})
    monkeypatch.setattr(recorder_module.Recorder, "_commit", refuse)
    with pytest.raises(StorageError, match="disk is full"):
        recorder.close()
    assert smarig.load_run(out).meta["rig"] == "x"

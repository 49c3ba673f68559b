"""Runs of the command line, found and controlled from this process."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from control.model_files import model_of
from smarig.core import UsageError
from smarig.record import load_run
from smarig.running import collect_ended, runs_in_progress
from tests.running.runs import announced_run, files, started, wait_for

POSIX = pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
STOPPED_READER = """
import os, signal, sys
from smarig.running import run_in_progress, runs_in_progress
run = runs_in_progress()[0]
reading = run_in_progress.AnnouncedFile.read
def stopped_while_it_reads(self, at, size):
    if size > 100_000:
        os.kill(os.getpid(), signal.SIGSTOP)
    return reading(self, at, size)
run_in_progress.AnnouncedFile.read = stopped_while_it_reads
with run_in_progress.opened(run.path) as file:
    assert file.is_held()  # a lock that is not released either
    run.samples(0)
    file.samples(0)
"""


def test_a_run_is_found_followed_paused_continued_and_stopped(folder, tmp_path):
    out = tmp_path / "v.run.sqlite"
    with started(out, "--speed", "20", "--json") as process:
        run = announced_run(process)
        assert run.alive
        assert {k: run.info[k] for k in ("protocol", "rig", "source", "out", "command")} == {
            "protocol": "validation",
            "rig": "one_wire_twin",
            "source": "twin",
            "out": str(out),
            "command": "smarig run validation",
        }
        assert run.info["limits"]["current_max_A"] == 1.0
        newest, blocks = 0, []
        while newest < 200:
            new = run.samples(newest)
            assert new.lost == 0
            newest = new.newest
            blocks.append(new.samples)
        followed = np.concatenate(blocks)
        assert wait_for(run.status)["step_number"] in (1, 2)
        run.ask("pause", "test bench")
        wait_for(lambda: run.status()["paused"], process)
        done = run.status()["left_s"]
        at_pause = run.samples(newest).newest
        wait_for(lambda: run.samples(at_pause).newest > at_pause + 50, process)  # sampling continues
        assert abs(run.status()["left_s"] - done) < 5
        run.ask("continue", "test bench")
        wait_for(lambda: not run.status()["paused"], process)
        run.ask("stop", "test bench")
        assert process.wait(60) == 130
        assert not run.alive
        with pytest.raises(UsageError, match="has ended"):
            run.ask("pause", "test bench")
        with pytest.raises(UsageError, match="has ended"):
            run.status()
    assert runs_in_progress() == ()
    assert collect_ended() == ()
    assert files(folder) == []
    recorded = load_run(out)
    assert recorded.cause == "stopped by the operator (test bench)"
    told = [e.text for e in recorded.events if e.kind == "request"]
    assert told == ["test bench asked this run to pause.", "test bench asked this run to continue."]
    assert followed["number"].tolist() == list(range(1, len(followed) + 1))
    block = {name: np.concatenate([b[name] for b in recorded.blocks([name])]) for name in ("t_s", "position")}
    np.testing.assert_array_equal(followed["t_s"], block["t_s"][: len(followed)])
    np.testing.assert_array_equal(followed["position"], block["position"][: len(followed)])


@pytest.mark.long("takes three seconds", cases=("regulate-words0",))
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("regulate", ["--setpoint", "6", "--hold-s", "600"]),
        pytest.param(
            "track",
            ["--reference", "steps", "--set", "seconds=600"],
            marks=pytest.mark.long("takes three seconds"),
        ),
    ],
)
def test_a_closed_loop_is_found_and_stopped_too(name, words, folder, tmp_path):
    model = tmp_path / "one_e.model.json"
    model_of("one_e").save(model)
    out = tmp_path / "loop.run.sqlite"
    with started(out, "--speed", "20", "--quiet", words=[name, str(model), *words]) as process:
        run = announced_run(process)
        assert {k: run.info[k] for k in ("rig", "source", "out")} == {
            "rig": "one_wire_twin",
            "source": "twin",
            "out": str(out),
        }
        assert run.info["command"].startswith(f"smarig {name} {os.sep}"), "long ones are cut"
        run.ask("stop", "test bench")
        assert process.wait(60) == 130
    assert load_run(out).cause == "stopped by the operator (test bench)"
    assert files(folder) == []


@pytest.mark.long("takes a second")
@POSIX
def test_a_killed_run_is_told_of_once_and_removed(folder, tmp_path):
    with started(tmp_path / "v.run.sqlite", "--speed", "20", "--quiet") as process:
        run = announced_run(process)
        wait_for(run.status)
        assert collect_ended() == ()
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert not run.alive
        assert runs_in_progress() == ()
        (ended,) = collect_ended()
        assert ended.info["pid"] == process.pid
        assert ended.status["step_number"] >= 1
        assert ended.sentence.startswith(f"validation on one_wire_twin (process {process.pid}) ended without")
        assert collect_ended() == ()
        assert files(folder) == []


@POSIX
def test_terminate_ends_the_run_safely(folder, tmp_path):
    with started(tmp_path / "v.run.sqlite", "--speed", "20", "--quiet") as process:
        run = announced_run(process)
        run.terminate()
        assert process.wait(60) == 130
        run.terminate()  # nothing is sent to whoever has the number now
    assert load_run(tmp_path / "v.run.sqlite").cause == "terminated (SIGTERM)"
    assert files(folder) == []


@pytest.mark.long("takes five seconds")
@POSIX
@pytest.mark.usefixtures("folder")
def test_a_reader_that_is_stopped_while_it_reads_changes_nothing(tmp_path):
    with started(tmp_path / "v.run.sqlite", "--speed", "50", "--quiet") as process:
        run = announced_run(process)
        wait_for(lambda: run.samples().newest > 1500, process)
        with subprocess.Popen([sys.executable, "-c", STOPPED_READER]) as reader:
            try:
                _, state = wait_for(lambda: _stopped_or_ended(reader.pid))
                assert os.WIFSTOPPED(state), "the reader ended before it was stopped"
                before, shown = run.samples().newest, run.status()["elapsed_s"]
                wait_for(lambda: run.samples(before).newest > before + 100, process)
                wait_for(lambda: run.status()["elapsed_s"] > shown, process)
                run.ask("stop", "second reader")
                assert process.wait(60) == 130
            finally:
                reader.kill()
    recorded = load_run(tmp_path / "v.run.sqlite")
    assert recorded.cause == "stopped by the operator (second reader)"
    assert not [e for e in recorded.events if e.kind in ("late", "lost")]


def _stopped_or_ended(pid):
    found = os.waitpid(pid, os.WUNTRACED | os.WNOHANG)
    return found if found[0] else None


@pytest.mark.long("takes five seconds")
@pytest.mark.usefixtures("folder")
def test_a_twin_as_fast_as_possible_overruns_slow_readers_but_tears_nothing(tmp_path):
    """Two readers, one of which sleeps: what it missed is counted, and every sample that it gets is of one tick."""
    out = tmp_path / "v.run.sqlite"
    with started(out, "--quiet") as process:
        run = announced_run(process)
        got, lost, first = [], 0, 0
        newest = slow_newest = 0
        while process.poll() is None:
            try:
                new = run.samples(newest)
                if new.newest > slow_newest + 10_000:
                    slow = run.samples(slow_newest)
                    first, slow_newest = slow_newest, slow.newest
                    assert slow.lost + len(slow.samples) == slow.newest - first
                    assert slow.lost > 5_000
                    lost += slow.lost
                    got.append(slow.samples)
            except UsageError:
                break
            assert new.lost + len(new.samples) == new.newest - newest
            newest = new.newest
            got.append(new.samples)
    recorded = load_run(out)
    columns = ("t_s", "current_A", "voltage_V", "position")
    true = {n: np.concatenate([b[n] for b in recorded.blocks([n])]) for n in columns}
    seen = np.concatenate(got)
    assert lost > 0
    for name in columns:
        np.testing.assert_array_equal(seen[name], true[name][seen["number"].astype(int) - 1])


CAMPAIGN = """
name = "two"
summary = "Two short runs."

[[step]]
protocol = "validation"
purpose = "test"
name = "first"
set = { points = 2 }

[[step]]
protocol = "validation"
purpose = "test"
set = { points = 3 }
"""


@pytest.mark.long("takes five seconds")
@pytest.mark.usefixtures("folder")
def test_each_run_of_a_campaign_is_announced_in_its_turn(tmp_path):
    (tmp_path / "two.toml").write_text(CAMPAIGN)
    campaign = str(tmp_path / "two.toml")
    with started(tmp_path / "runs", "--quiet", "--speed", "200", protocol=campaign) as process:
        seen = []
        while process.poll() is None:
            seen += [r for r in runs_in_progress() if r.key not in {s.key for s in seen}]
    assert process.returncode == 0
    assert [(run.info["place"], run.info["steps"]) for run in seen] == [("run 1 of 2", 4), ("run 2 of 2", 5)]
    assert {run.info["pid"] for run in seen} == {process.pid}

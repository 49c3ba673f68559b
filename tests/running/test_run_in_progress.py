"""Runs in processes of their own are found, followed, paused, stopped, and missed when they were killed."""

import os
import signal
import time

import numpy as np
import pytest

from running.started_run import VALIDATION, found_run, started_run, waited
from smarig.core import UsageError
from smarig.record import stored_run
from smarig.running import collect_ended, runs_in_progress

LONG = (*VALIDATION[:-1], "points=60", "-o", "a.run.sqlite")


def _events(folder):
    with stored_run(folder / "a.run.sqlite", verify=False) as run:
        return [(e.kind, e.level, e.text) for e in run.events], run.cause


def test_a_run_is_found_described_and_followed_without_a_gap(tmp_path, running_dir):
    with started_run(tmp_path) as process:
        run = found_run(process)
        about = {k: run.info[k] for k in ("pid", "protocol", "rig", "source", "out", "two_wire", "steps")}
        assert about == {
            "pid": process.pid,
            "protocol": "validation",
            "rig": "one_wire_twin",
            "source": "twin",
            "out": str(tmp_path / "a.run.sqlite"),
            "two_wire": False,
            "steps": 5,
        }
        assert run.alive
        assert abs(run.info["start_epoch"] - time.time()) < 120
        parts, after = [], 0
        while run.alive:
            try:
                found, after, lost = run.samples(after)
                status = run.status()
            except UsageError:
                break
            assert lost == 0
            parts.append(found)
            assert 0 <= status["share"] <= 1
            time.sleep(0.05)
        assert process.wait(60) == 0
        assert not run.alive
        assert list(running_dir.iterdir()) == []
        for late in (run.status, run.samples, lambda: run.ask("stop", "test")):
            with pytest.raises(UsageError, match="has ended"):
                late()
        run.terminate()  # nothing to do
    followed = np.concatenate(parts)
    with stored_run(tmp_path / "a.run.sqlite") as stored:
        block = next(iter(stored.blocks(("t_s", "position", "current_A", "input"))))
    n = followed.size
    assert n > 1000
    for own, theirs in (
        ("t_s", "t_s"),
        ("position", "position"),
        ("current_A", "current_A"),
        ("input_K", "input"),
    ):
        np.testing.assert_allclose(followed[own], block[theirs][:n], rtol=1e-6, atol=1e-6, err_msg=own)


def test_pause_continue_and_stop_take_effect_and_stand_in_the_record_with_who_asked(tmp_path):
    with started_run(tmp_path, *LONG) as process:
        run = found_run(process)
        run.ask("pause", "Ada <b>")
        waited(lambda: run.status()["paused"], "the pause")
        step = run.status()["step_number"]
        newest = run.samples()[1]
        waited(lambda: run.samples(newest)[1] > newest + 20, "samples in the pause")
        assert run.status()["step_number"] == step
        run.ask("continue", "Ben")
        waited(lambda: not run.status()["paused"], "the end of the pause")
        run.ask("stop", "Cyd")
        run.ask("continue", "Dan")  # does not undo the stop
        assert process.wait(60) == 130, process.communicate()
    events, cause = _events(tmp_path)
    assert ("request", "info", "Asked to pause by Ada <b>.") in events
    assert ("request", "info", "Asked to continue by Ben.") in events
    assert {"paused", "unpaused"} <= {kind for kind, _, _ in events}
    assert cause == "stopped by the operator (Cyd)"


def test_only_what_a_run_understands_can_be_asked(tmp_path):
    with started_run(tmp_path) as process, pytest.raises(UsageError, match="pause, continue, stop"):
        found_run(process).ask("explode", "test")


def test_terminate_ends_a_run_safely(tmp_path):
    with started_run(tmp_path, *LONG) as process:
        found_run(process).terminate()
        assert process.wait(60) in (130, 143)
    assert "SIGTERM" in _events(tmp_path)[1]


def test_a_killed_run_is_reported_once_and_its_file_is_removed(tmp_path, running_dir):
    with started_run(tmp_path) as process:
        run = found_run(process)
        process.kill()
        process.wait()
        assert not run.alive
        assert runs_in_progress() == ()
        assert [ended.key for ended in collect_ended()] == [run.key]
        assert collect_ended() == ()
        assert list(running_dir.iterdir()) == []


def test_a_reader_that_is_stopped_with_the_file_open_does_not_hold_up_the_run(tmp_path):
    with started_run(tmp_path, *LONG) as process:
        run = found_run(process)
        reader = os.fork()
        if reader == 0:  # a reader with everything open, and a lock that it tried
            from smarig.running.run_in_progress import _is_held, _mapped, _opened

            with _opened(run.path) as file, _mapped(file) as memory:
                _is_held(file)
                memory.status()
                os.kill(os.getpid(), signal.SIGSTOP)
            os._exit(0)
        try:
            os.waitpid(reader, os.WUNTRACED)
            newest = run.samples()[1]
            waited(lambda: run.samples(newest)[1] > newest + 100, "samples beside a stopped reader")
            run.ask("stop", "test")
            assert process.wait(60) == 130
            assert not run.alive
        finally:
            os.kill(reader, signal.SIGKILL)
            os.waitpid(reader, 0)


def test_a_twin_faster_than_its_reader_loses_samples_and_says_how_many(tmp_path):
    fast = ("run", "validation", "--rig", "one_wire_twin", "--set", "points=200", "-o", "a.run.sqlite")
    with started_run(tmp_path, *fast) as process:
        run = found_run(process)
        _, first, _ = run.samples()
        newest = waited(lambda: (n := run.samples(first)[1]) > first + 6000 and n, "6000 samples")
        found, newest, lost = run.samples(first)
        assert lost > 0
        assert lost + found.size == newest - first
        assert np.all(np.diff(found["t_s"]) > 0)

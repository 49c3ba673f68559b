"""Entries as processes on the twin: in order, refused, tripped, killed; the worker is in this process."""

import json
import os
import signal

import pytest

from console.queue.entries import events, opened, request, wait_until, work_until_idle, worker
from smarig.console.queue.entry_process import EntryFiles, bound_log, is_alive
from smarig.console.queue.queue_entry import EntryState
from smarig.record import load_run

DONE, WAITING = EntryState.DONE, EntryState.WAITING
HOT = """base = "one_wire_twin"
name = "hot"
temperature_noise_K = 40.0  # its preview has no noise
temperature_noise_time_s = 1.0
"""


def states(queue):
    return {entry.id: entry.state for entry in queue.entries()}


@pytest.mark.long("takes three seconds")
def test_runs_follow_each_other_in_the_order_of_the_queue(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        first, removed, edited = (queue.add(request(name)) for name in ("first", "removed", "edited"))
        queue.remove(removed)
        queue.move(edited, before=first)
        queue.edit(edited, request("edited", seed=5))
        added = []
        work_until_idle(one, after_start=lambda: added.append(queue.add(request("added"))))
        ended = queue.entries()
    assert [entry.id for entry in ended] == [edited, first, *added]
    assert [entry.state for entry in ended] == [DONE] * 3
    assert all(a.ended <= b.started for a, b in zip(ended, ended[1:]))
    assert load_run(tmp_path / "edited.run.sqlite").info.seed == 5
    assert json.loads(EntryFiles.of(tmp_path, edited).result.read_text())["runs"][0]["cause"] == "done"
    assert not (tmp_path / "removed.run.sqlite").exists()


@pytest.mark.long("takes three seconds")
def test_the_queue_stops_after_this_one_and_while_it_is_paused(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        a, b = queue.add(request("a")), queue.add(request("b"))
        queue.pause()
        assert not one.step()
        queue.go_on()
        work_until_idle(one, after_start=queue.stop_after_this)
        assert states(queue) == {a: DONE, b: WAITING}
        assert queue.state().sentence == f"Stopped after entry {a}."
        queue.go_on()
        work_until_idle(one, after_start=queue.pause)  # what runs is not touched
        assert states(queue) == {a: DONE, b: DONE}
        assert queue.state().sentence == "Paused by a person."


def test_a_tripped_rig_pauses_the_queue_and_a_refused_command_does_not(tmp_path):
    (tmp_path / "hot.toml").write_text(HOT)
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        refused = queue.add(request("refused"))
        (tmp_path / "refused.run.sqlite").write_text("somebody else's")
        tripped, next_one = queue.add(request("tripped", rig="hot.toml")), queue.add(request("next"))
        work_until_idle(one)
        assert states(queue) == {
            refused: EntryState.FAILED,
            tripped: EntryState.FAILED,
            next_one: WAITING,
        }
        assert queue.entry(refused).exit_status == 2
        assert "refused.run.sqlite exists" in queue.entry(refused).sentence
        assert queue.entry(tripped).exit_status == 3
        assert "position jumped" in queue.entry(tripped).sentence
        state = queue.state()
    assert state.paused_by == tripped
    assert state.sentence.startswith(f"Entry {tripped} (validation) is failed: The position jumped")
    assert (tmp_path / "refused.run.sqlite").read_text() == "somebody else's"


def test_a_killed_run_is_interrupted_and_continued_on_request(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        killed, next_one = queue.add(request("killed", speed=100.0)), queue.add(request("next"))
        assert one.step()
        run = tmp_path / "killed.run.sqlite"
        wait_until(lambda: run.exists() and events(tmp_path, killed, "start"), "the run did not start")
        wait_until(lambda: len(load_run(run)) > 100, "no samples")
        os.kill(queue.entry(killed).pid, signal.SIGKILL)
        work_until_idle(one)
        assert states(queue) == {killed: EntryState.INTERRUPTED, next_one: WAITING}
        assert queue.entry(killed).sentence == "The process was killed (SIGKILL)."
        assert queue.state().paused_by == killed
        queue.remove(next_one)
        queue.continue_interrupted(killed)
        work_until_idle(one)
        assert states(queue) == {killed: DONE}
    run = load_run(run)
    assert run.cause == "done"
    assert any(step.branch == "re-establish" for step in run.steps)


def test_a_run_that_a_person_stops_pauses_the_queue(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        stopped, next_one = queue.add(request("stopped", speed=10.0)), queue.add(request("next"))
        assert one.step()
        wait_until(lambda: events(tmp_path, stopped, "start"), "the run did not start")
        os.kill(queue.entry(stopped).pid, signal.SIGTERM)
        work_until_idle(one)
        assert states(queue) == {stopped: EntryState.STOPPED, next_one: WAITING}
        assert queue.state().paused_by == stopped


def test_an_entry_whose_start_was_cut_off_is_interrupted_and_not_started_again(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as killed:
        one = queue.add(request())
        assert killed._take_next().id == one  # on the disk; its worker ends here
        with worker(tmp_path) as later:
            work_until_idle(later)
        assert states(queue) == {one: EntryState.INTERRUPTED}
        assert "killed, or the machine was restarted" in queue.entry(one).sentence
        assert queue.state().paused
    assert not EntryFiles.of(tmp_path, one).lines.exists()


def test_a_result_that_no_worker_saw_is_stored_later(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as killed:
        one = queue.add(request())
        killed._take_next()
        result = EntryFiles.of(tmp_path, one).result
        result.parent.mkdir()
        result.write_text('{"error": "The wire is broken.", "exit_status": 3}')
        with worker(tmp_path) as later:
            work_until_idle(later)
        found = queue.entry(one)
    assert (found.state, found.exit_status, found.sentence) == (EntryState.FAILED, 3, "The wire is broken.")


def test_an_earlier_result_is_not_taken_for_that_of_the_next_start(tmp_path):
    with opened(tmp_path) as queue, worker(tmp_path) as killed:
        one = queue.add(request())
        result = EntryFiles.of(tmp_path, one).result
        result.parent.mkdir()
        result.write_text('{"runs": []}')
        killed._take_next()
        with worker(tmp_path) as later:
            work_until_idle(later)
        assert queue.entry(one).state is EntryState.INTERRUPTED


def test_a_log_keeps_its_last_whole_lines_while_it_is_being_written(tmp_path):
    log = tmp_path / "lines.jsonl"
    with log.open("a") as file:
        for k in range(1000):
            file.write(f"line {k}\n")
            file.flush()
            bound_log(log, largest=500)
            assert log.stat().st_size <= 510
    lines = log.read_text().splitlines()
    assert lines[-1] == "line 999"
    assert lines == [f"line {k}" for k in range(1000 - len(lines), 1000)]
    assert not is_alive(tmp_path, 1)

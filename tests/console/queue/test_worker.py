"""The worker as a process of its own: killed during a run and started again; two of them; a full disk."""

import os
import signal
import subprocess
import sys

import pytest

from console.queue.entries import events, opened, request, wait_until, worker
from smarig.console.queue import ensure_worker as starting
from smarig.console.queue import worker as worker_module
from smarig.console.queue.ensure_worker import ensure_worker
from smarig.console.queue.entry_process import EntryFiles, Outcome, is_alive, outcome_of
from smarig.console.queue.queue_entry import EntryState
from smarig.console.queue.worker import lock_key, work
from smarig.core import InUse, StorageError, check_free
from smarig.record import load_run


def is_served(folder):
    try:
        check_free(lock_key(folder), "", "")
    except InUse:
        return True
    return False


@pytest.fixture
def workers(tmp_path):
    """The workers that ``ensure_worker`` starts for a folder; killed at the end."""
    started = []

    def start():
        assert ensure_worker(tmp_path)
        started.append(starting._started[lock_key(tmp_path)])
        wait_until(lambda: is_served(tmp_path), "the worker did not start")
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


@pytest.mark.long("takes two seconds")
def test_a_worker_that_is_killed_leaves_the_run_and_the_next_one_stores_its_outcome(tmp_path, workers):
    with opened(tmp_path) as queue:
        one = queue.add(request(speed=100.0))
        first = workers()
        wait_until(lambda: queue.entry(one).pid is not None, "nothing was started")
        pid = queue.entry(one).pid
        wait_until(lambda: events(tmp_path, one, "start"), "the run did not start")
        first.send_signal(signal.SIGKILL)
        first.wait()
        assert is_alive(tmp_path, one)
        assert os.getpgid(pid) == pid  # no signal to the worker's group reaches it
        workers()
        assert not ensure_worker(tmp_path)
        second = subprocess.run(
            [sys.executable, "-m", "smarig.console.queue.worker", str(tmp_path)],
            capture_output=True,
            text=True,
        )
        assert second.returncode == 5
        assert f"The queue of {tmp_path} is served by process" in second.stderr
        wait_until(lambda: queue.entry(one).state is not EntryState.RUNNING, "the run did not end")
        found = queue.entry(one)
    assert found.state is EntryState.DONE
    assert found.exit_status == 0
    assert len(events(tmp_path, one, "start")) == 1
    assert load_run(tmp_path / "v.run.sqlite").cause == "done"
    log = (tmp_path / "queue.log").read_text()
    assert log.count(f"Entry {one} was started as process {pid}.") == 1
    assert log.count(f"Entry {one} is done.") == 1


def test_the_sentence_of_an_entry_is_its_warning_or_its_error(tmp_path):
    files = EntryFiles.of(tmp_path, 1)
    files.lines.parent.mkdir()
    files.lines.write_text(
        '{"event": {}}\nWarning: 2 holds did not settle.\n8 settled points\n\nsmarig: No room.\n'
    )
    assert outcome_of(tmp_path, 1, 0).sentence == "Warning: 2 holds did not settle."
    assert outcome_of(tmp_path, 1, 4) == Outcome(EntryState.FAILED, 4, "No room.")
    assert outcome_of(tmp_path, 1, 4).pauses
    assert outcome_of(tmp_path, 1, -9).state is EntryState.INTERRUPTED
    assert outcome_of(tmp_path, 1, None).state is EntryState.INTERRUPTED
    files.result.write_text("[1]")
    assert outcome_of(tmp_path, 1, None).state is EntryState.INTERRUPTED


def test_a_worker_without_work_ends_and_leaves_no_lock(tmp_path):
    with opened(tmp_path) as queue:
        queue.add(request())
        queue.pause()
        work(tmp_path, idle_s=0.01)
        assert [entry.state for entry in queue.entries()] == [EntryState.WAITING]
    assert not is_served(tmp_path)


def test_an_entry_added_while_the_worker_leaves_is_seen(tmp_path, monkeypatch):
    rounds = []

    def idle(worker, folder, idle_s):
        rounds.append(worker)
        if len(rounds) == 1:
            queue.add(request())  # the lock is held: ensure_worker starts none
            assert not ensure_worker(folder)
        else:
            queue.pause()

    monkeypatch.setattr(worker_module, "_work_until_idle", idle)
    monkeypatch.setattr(starting, "_start", lambda _folder: pytest.fail("a second worker was started"))
    monkeypatch.setattr(starting, "check_free", _refuse)
    with opened(tmp_path) as queue:
        work(tmp_path)
    assert len(rounds) == 2


def _refuse(*_arguments):
    raise InUse("held")


def test_an_outcome_waits_for_room_on_the_disk(tmp_path, monkeypatch, capsys):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        entry = queue.entry(queue.add(request()))
        update, refusals = one._file.update, [StorageError("The disk is full."), InUse("Busy.")]

        def refused_at_first(*arguments, **columns):
            if refusals:
                raise refusals.pop(0)
            update(*arguments, **columns)

        monkeypatch.setattr(one._file, "update", refused_at_first)
        monkeypatch.setattr(worker_module, "RETRY_S", 0.0)
        one._end(entry, Outcome(EntryState.DONE, 0, ""))
        assert queue.entry(entry.id).state is EntryState.DONE
    assert "The disk is full.\n" in capsys.readouterr().err


def test_nothing_is_started_that_could_not_be_marked_as_running(tmp_path, monkeypatch):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        entry = queue.add(request())
        db = one._file._db
        db.execute("PRAGMA query_only = ON")  # as a disk that refuses: nothing can be written
        monkeypatch.setattr(worker_module, "start_process", lambda *_: pytest.fail("it was started"))
        with pytest.raises(StorageError):
            one.step()
        assert queue.entry(entry).state is EntryState.WAITING


def test_a_pause_in_the_last_moment_is_obeyed(tmp_path, monkeypatch):
    with opened(tmp_path) as queue, worker(tmp_path) as one:
        queue.add(request())
        look = one._next

        def pausing_after_a_look():
            found = look()
            monkeypatch.setattr(one, "_next", look)
            queue.pause()
            return found

        monkeypatch.setattr(one, "_next", pausing_after_a_look)
        monkeypatch.setattr(worker_module, "start_process", lambda *_: pytest.fail("it was started"))
        assert not one.step()


def test_what_cannot_be_started_fails_and_pauses(tmp_path, monkeypatch):
    def refuse(*_arguments):
        raise OSError(12, "Cannot allocate memory")

    with opened(tmp_path) as queue, worker(tmp_path) as one:
        entry = queue.add(request())
        monkeypatch.setattr(worker_module, "start_process", refuse)
        one.step()
        found = queue.entry(entry)
        assert queue.state().paused_by == entry
    assert (found.state, found.sentence) == (
        EntryState.FAILED,
        "It could not be started: Cannot allocate memory.",
    )

"""What people do with a queue: order, edit, remove, pause; all of it stored, from several threads and processes."""

import threading

import pytest

from console.queue.entries import opened, request, unpreviewed
from smarig.console.queue.entry_preview import EntryPreview
from smarig.console.queue.queue import Queue
from smarig.console.queue.queue_entry import EntryState
from smarig.console.queue.queue_file import QueueFile
from smarig.core import UsageError


def order(queue):
    return [entry.id for entry in queue.entries() if entry.state is EntryState.WAITING]


def as_running(folder, number):
    with QueueFile(folder) as file:
        file.update(number, state=EntryState.RUNNING, started=1000.0)


@pytest.fixture
def queue(tmp_path):
    with opened(tmp_path) as queue:
        yield queue


def test_the_order_is_that_of_adding_until_somebody_moves_one(queue):
    a, b, c = (queue.add(request(name)) for name in "abc")
    assert order(queue) == [a, b, c]
    queue.move(c, before=a)
    assert order(queue) == [c, a, b]
    queue.move(c)
    assert order(queue) == [a, b, c]
    queue.move(b, before=b)
    assert order(queue) == [a, b, c]
    d = queue.add(request("d"))
    assert order(queue) == [a, b, c, d]


def test_what_waits_is_edited_and_removed_and_what_runs_is_not(queue, tmp_path):
    a, b = queue.add(request("a")), queue.add(request("b"))
    queue.edit(b, request("b", seed=7))
    assert queue.entry(b).request.seed == 7
    queue.remove(b)
    assert queue.entry(b).state is EntryState.REMOVED
    assert order(queue) == [a]
    as_running(tmp_path, a)
    for change in (lambda: queue.edit(a, request("a")), lambda: queue.remove(a), lambda: queue.move(a)):
        with pytest.raises(UsageError, match="Entry 1 is running; only entries that wait can be changed"):
            change()
    with pytest.raises(UsageError, match="no entry 99"):
        queue.remove(99)


def test_everything_is_found_again_by_another_process(queue, tmp_path):
    added = queue.add(request("a", effects=("creep", "settling=3"), notes="ä “quoted” note", speed=2.5))
    queue.pause()
    with opened(tmp_path) as again:
        assert again.entry(added) == queue.entry(added)
        assert again.entry(added).request.effects == ("creep", "settling=3")
        assert again.state().paused


def test_pausing_says_why_and_going_on_clears_it(queue, tmp_path):
    with pytest.raises(UsageError, match="Nothing is running"):
        queue.stop_after_this()
    assert not queue.state().paused
    queue.pause()
    assert (queue.state().paused, queue.state().sentence) == (True, "Paused by a person.")
    as_running(tmp_path, queue.add(request("a")))
    queue.stop_after_this()
    assert queue.state().stop_after_this
    queue.go_on()
    assert not queue.state().paused
    assert not queue.state().stop_after_this


def test_the_end_of_everything_counts_what_is_left(tmp_path):
    durations = iter([100.0, 40.0, 10.0])
    with Queue.open(tmp_path, lambda *_: EntryPreview(0.0, next(durations))) as queue:
        assert queue.ends_at(500.0) is None
        first = queue.add(request("a"))
        queue.add(request("b"))
        queue.remove(queue.add(request("c")))
        assert queue.ends_at(500.0) == 640.0
        as_running(tmp_path, first)  # since 1000 s
        assert queue.ends_at(1030.0) == 1030.0 + 70.0 + 40.0
        assert queue.ends_at(5000.0) == 5040.0  # late: it may end at any moment


def test_an_interrupted_entry_waits_for_a_persons_word(queue, tmp_path):
    a, b, c = (queue.add(request(name)) for name in "abc")
    with QueueFile(tmp_path) as file:
        for number in (a, c):
            file.update(number, state=EntryState.INTERRUPTED, sentence="It was killed.", ended=2.0)
        file.set(paused={"sentence": "Entry was killed.", "by": a})
    with pytest.raises(UsageError, match="Entry 2 is waiting. There is nothing to continue"):
        queue.continue_interrupted(b)
    queue.skip_interrupted(c)
    assert queue.entry(c).state is EntryState.STOPPED
    assert queue.entry(c).sentence == "It was killed. It was not continued."
    assert queue.state().paused  # by another entry
    queue.continue_interrupted(a)
    assert order(queue) == [a, b]
    assert queue.entry(a).continued
    assert not queue.state().paused
    with pytest.raises(UsageError, match="continues a run"):
        queue.edit(a, request("a", seed=3))


def test_threads_and_processes_add_at_once(tmp_path):
    with opened(tmp_path) as one, opened(tmp_path) as other:

        def add(queue, name):
            for k in range(10):
                queue.add(request(f"{name}{k}"))

        threads = [
            threading.Thread(target=add, args=(q, n)) for n, q in [("a", one), ("b", one), ("c", other)]
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        found = one.entries()
    assert len({entry.id for entry in found}) == len({entry.place for entry in found}) == 30


def test_only_the_newest_of_the_ended_are_listed_on_request(queue, tmp_path):
    numbers = [queue.add(request(name)) for name in "abcd"]
    with QueueFile(tmp_path) as file:
        for number, ended in zip(numbers[:3], (30.0, 10.0, 20.0)):
            file.update(number, state=EntryState.DONE, ended=ended)
    assert [entry.id for entry in queue.entries()] == [2, 3, 1, 4]
    assert [entry.id for entry in queue.entries(newest=1)] == [1, 4]


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(Exception, match="Folder .* cannot be used"):
        Queue.open(tmp_path / "file" / "queue", unpreviewed)

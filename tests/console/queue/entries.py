"""Entries, and a worker in this process, for the tests of the queue."""

import json
import time
from contextlib import contextmanager

from smarig.console.queue.entry_preview import EntryPreview
from smarig.console.queue.entry_process import EntryFiles
from smarig.console.queue.entry_request import EntryRequest
from smarig.console.queue.queue import Queue
from smarig.console.queue.queue_file import QueueFile
from smarig.console.queue.worker import Worker

PATIENCE_S = 180.0  # ends a test that has failed


def request(name="v", **changes):
    """A validation of three points on the twin: five minutes, computed in half a second."""
    given = {"kind": "protocol", "experiment": "validation", "rig": "one_wire_twin"}
    return EntryRequest(**given | {"out": f"{name}.run.sqlite", "settings": {"points": "3"}} | changes)


def unpreviewed(_request, _folder):
    """A previewer that starts no process."""
    return EntryPreview(300.0, 300.0)


def opened(folder):
    """The queue of a folder whose entries are not previewed."""
    return Queue.open(folder, previewer=unpreviewed)


@contextmanager
def worker(folder):
    """A worker in this process. Its entries are processes of their own."""
    with QueueFile(folder) as file:
        yield Worker(folder, file)


def work_until_idle(one, after_start=lambda: None):
    """Let a worker do all there is to do. ``after_start`` is called once, when something runs."""
    end_s = time.monotonic() + PATIENCE_S
    called = False
    while one.step():
        if not called:
            called = True
            after_start()
        assert time.monotonic() < end_s
        time.sleep(0.02)


def wait_until(condition, why):
    """Wait for what another process does."""
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end_s, why
        time.sleep(0.02)


def events(folder, number, kind):
    """The events of one kind among the lines of an entry."""
    lines = EntryFiles.of(folder, number).lines.read_text("utf-8").splitlines()
    found = [json.loads(line) for line in lines if line.startswith("{")]
    return [line["event"] for line in found if line.get("event", {}).get("kind") == kind]

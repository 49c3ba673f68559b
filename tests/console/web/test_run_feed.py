"""What a browser receives of a run: the boundary at most ten times per second, and events with their severity."""

import asyncio
import json
import threading
import time

import pytest

from running.made import INFO, sample
from smarig.console.web.run_feed import RunFeed
from smarig.runner import RunControl
from smarig.running import RunStatus, announced, runs_in_progress


@pytest.fixture
def messages(tmp_path, monkeypatch):
    """The messages of half a second in which the input moves at each of 100 samples, with times."""
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))
    control, closing, found = RunControl(), threading.Event(), []
    with announced(INFO, control, RunStatus(INFO, control)) as listener:
        feed = RunFeed(runs_in_progress()[0], None, closing)
        feed._memory.begin(_File())
        feed._memory.caught_up()

        def run():
            for number in range(1, 101):
                listener.sample(sample(number), 1, number / 2)
                time.sleep(0.01)
            closing.set()

        async def read():
            async for text in feed.messages():
                head, _, content = text.strip().partition("\ndata: ")
                found.append((time.monotonic(), head.removeprefix("event: "), json.loads(content)))

        thread = threading.Thread(target=run)
        thread.start()
        asyncio.run(read())
        thread.join()
    return found


class _File:
    info = type("Info", (), {"initial": None, "actuator_values": {}, "rig_values": {}, "period_s": None})


def test_the_boundary_comes_at_most_ten_times_per_second(messages):
    times = [at for at, name, _ in messages if name == "boundary"]
    assert len(times) >= 3
    assert (len(times) - 1) / (times[-1] - times[0]) < 10.5
    last = [content for _, name, content in messages if name == "boundary"][-1]
    assert last["corners"][-1] == pytest.approx([last["input"]] * 2, abs=0.1)


def test_it_says_that_it_is_alive_whatever_the_run_does(messages):
    assert "alive" in [name for _, name, _ in messages]

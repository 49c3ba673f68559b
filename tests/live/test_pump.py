"""The tick never waits for drawing: ``put`` returns at once, memory is bounded, and lost items are counted."""

import threading

from smarig.core.command import StepResult, StepVerdict
from smarig.core.sample import NAN, Sample
from smarig.core.severity import Severity
from smarig.live.draw_queue import DrawQueue
from smarig.live.live_items import EventItem, QueueListener, SampleItem, StepItem

PATIENCE_S = 60.0  # before a test gives up; nothing waits that long


class BlockedDrawing:
    """A drawing function that starts and is blocked until it is released."""

    def __init__(self) -> None:
        self.began, self.go_on = threading.Event(), threading.Event()
        self.batches: list[tuple[list, int]] = []

    def __call__(self, items: list, lost: int) -> None:
        self.began.set()
        assert self.go_on.wait(PATIENCE_S)
        self.batches.append((list(items), lost))

    @property
    def items(self) -> list:
        return [item for batch, _ in self.batches for item in batch]


def test_everything_arrives_in_order_and_once():
    blocked = BlockedDrawing()
    blocked.go_on.set()
    draw_queue = DrawQueue(blocked, every_s=0.001)
    for k in range(20_000):
        draw_queue.put(k)
    assert draw_queue.close(PATIENCE_S)
    assert blocked.items == list(range(20_000))
    assert draw_queue.dropped == 0


def test_a_hanging_viewer_holds_nobody_up_and_costs_bounded_memory():
    blocked = BlockedDrawing()
    draw_queue = DrawQueue(blocked, size=100, every_s=0.001)
    draw_queue.put("first")
    assert blocked.began.wait(PATIENCE_S)
    for k in range(5_000):  # would never end if put waited
        draw_queue.put(k)
    assert len(draw_queue._queued) == 100
    blocked.go_on.set()
    assert draw_queue.close(PATIENCE_S)
    assert blocked.items == ["first", *range(4_900, 5_000)]
    assert draw_queue.dropped == 4_900
    assert [lost for _, lost in blocked.batches] == [0, 4_900]


def test_a_batch_ends_where_something_was_lost():
    """What was taken before the gap is not drawn as if it came after it."""
    batches = []
    draw_queue = DrawQueue(lambda items, lost: batches.append((items, lost)), size=4, every_s=PATIENCE_S)
    for k in range(4):
        draw_queue.put(k)
    taken, lost = [draw_queue._pop_oldest()], 0  # the thread has just taken the oldest
    for k in range(4, 7):
        draw_queue.put(k)
    draw_queue._after_gap = taken[0]
    draw_queue._next_drawn = lost
    draw_queue._drain()
    assert batches == [([0], 0), ([3, 4, 5, 6], 2)]
    assert draw_queue.close(PATIENCE_S)


def test_a_viewer_that_never_comes_back_is_left_behind():
    blocked = BlockedDrawing()
    draw_queue = DrawQueue(blocked, every_s=0.001)
    draw_queue.put("first")
    assert blocked.began.wait(PATIENCE_S)
    assert not draw_queue.close(0.01)
    blocked.go_on.set()


def test_a_drawing_that_fails_is_kept_and_reaches_nobody():
    def broken(items: list, lost: int) -> None:
        raise ValueError("no colours left")

    draw_queue = DrawQueue(broken, size=10, every_s=0.001)
    draw_queue.put(0)
    draw_queue._thread.join(PATIENCE_S)
    for k in range(100):
        draw_queue.put(k)
    assert not draw_queue.close()
    assert str(draw_queue.failure) == "no colours left"
    assert len(draw_queue._queued) == 10


def test_the_listener_queues_what_it_receives():
    items: list = []

    class Kept:
        put = staticmethod(items.append)

    listener = QueueListener(Kept())
    s = Sample(3, 0.3, 0.5, 0.5, 2.4, NAN, 12, 0.565, 22.0, 0)
    result = StepResult(4, StepVerdict.SETTLED, 0.5, 11.0, 0.1, 250, 0.1, 0.3)
    listener.sample(s, 4, 20.0)
    listener.step(result, branch="heating", target=20.0)
    listener.event(0.3, "mark", "a word", level="warning", more=1)
    assert items == [
        SampleItem(s, 4, 20.0),
        StepItem(0.1, 0.3, 4, "settled", "heating", 20.0, 0.5),
        EventItem(0.3, "warning", "mark", "a word", Severity.MINOR),
    ]

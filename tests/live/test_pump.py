"""The tick never waits: whatever the drawing does, ``put`` returns, memory is bounded, and losses are counted."""

import threading

from smarig.command import StepResult, Verdict
from smarig.live.pump import Pump
from smarig.live.seen import Stepped, Ticked, Told, Watcher
from smarig.sample import NAN, Sample

PATIENCE_S = 20.0  # before a test gives up; nothing waits that long


class Hanging:
    """A drawing that begins, and goes on only when it is let."""

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
    hanging = Hanging()
    hanging.go_on.set()
    pump = Pump(hanging, every_s=0.001)
    for k in range(20_000):
        pump.put(k)
    assert pump.close(PATIENCE_S)
    assert hanging.items == list(range(20_000))
    assert pump.dropped == 0


def test_a_hanging_viewer_holds_nobody_up_and_costs_bounded_memory():
    hanging = Hanging()
    pump = Pump(hanging, size=100, every_s=0.001)
    pump.put("first")
    assert hanging.began.wait(PATIENCE_S)
    for k in range(5_000):  # would never end if put waited
        pump.put(k)
    assert len(pump._waiting) == 100
    hanging.go_on.set()
    assert pump.close(PATIENCE_S)
    assert hanging.items == ["first", *range(4_900, 5_000)]
    assert pump.dropped == 4_900
    assert [lost for _, lost in hanging.batches] == [0, 4_900]


def test_a_batch_ends_where_something_was_lost():
    """What was taken before the gap is not drawn as if it came after it."""
    batches = []
    pump = Pump(lambda items, lost: batches.append((items, lost)), size=4, every_s=PATIENCE_S)
    for k in range(4):
        pump.put(k)
    taken, lost = [pump._oldest()], 0  # the thread has just taken the oldest
    for k in range(4, 7):
        pump.put(k)
    pump._after_gap = taken[0]
    pump._next = lost
    pump._empty()
    assert batches == [([0], 0), ([3, 4, 5, 6], 2)]
    assert pump.close(PATIENCE_S)


def test_a_viewer_that_never_comes_back_is_left_behind():
    hanging = Hanging()
    pump = Pump(hanging, every_s=0.001)
    pump.put("first")
    assert hanging.began.wait(PATIENCE_S)
    assert not pump.close(0.01)
    hanging.go_on.set()


def test_a_drawing_that_fails_is_kept_and_reaches_nobody():
    def broken(items: list, lost: int) -> None:
        raise ValueError("no colours left")

    pump = Pump(broken, size=10, every_s=0.001)
    pump.put(0)
    pump._thread.join(PATIENCE_S)
    for k in range(100):
        pump.put(k)
    assert not pump.close()
    assert str(pump.failure) == "no colours left"
    assert len(pump._waiting) == 10


def test_the_watcher_puts_what_it_is_told():
    items: list = []

    class Kept:
        put = staticmethod(items.append)

    watcher = Watcher(Kept())
    s = Sample(3, 0.3, 0.5, 0.5, 2.4, NAN, 12, 0.565, 22.0, 0)
    result = StepResult(4, Verdict.SETTLED, 0.5, 11.0, 0.1, 250, 0.1, 0.3)
    watcher.sample(s, 4, 20.0)
    watcher.step(result, branch="heating", target=20.0)
    watcher.event(0.3, "mark", "a word", level="warning", more=1)
    assert items == [
        Ticked(s, 4, 20.0),
        Stepped(0.1, 0.3, 4, "settled", "heating", 20.0, 0.5),
        Told(0.3, "warning", "mark", "a word"),
    ]

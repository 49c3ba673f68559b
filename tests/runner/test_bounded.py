"""A slow, blocked or failing listener does not delay the tick: its items are dropped and counted."""

import threading

from smarig.rig.twin import Twin
from smarig.runner.bounded_listener import BoundedListener
from smarig.runner.listener import CallbackListener

SAMPLE = Twin.named("one_wire_twin").step(0.1)[0]


def test_everything_arrives_in_order_when_it_fits():
    observed = []
    bounded = BoundedListener(
        CallbackListener(
            on_sample=lambda s, step, u: observed.append(u), on_event=lambda kind, t: observed.append(kind)
        )
    )
    for k in range(500):
        bounded.sample(SAMPLE, 0, float(k))
    bounded.event(1.0, "mark", "note")
    bounded.close()
    assert observed == [*map(float, range(500)), "mark"]
    assert bounded.dropped == 0


def test_a_stuck_listener_does_not_block_and_the_oldest_are_dropped():
    stuck, gate = threading.Event(), threading.Event()
    observed = []

    def slow(s, step, u):
        stuck.set()
        gate.wait(20)
        observed.append(u)

    bounded = BoundedListener(CallbackListener(on_sample=slow), size=100)
    bounded.sample(SAMPLE, 0, -1.0)
    assert stuck.wait(20)
    for k in range(1000):
        bounded.sample(SAMPLE, 0, float(k))
    assert bounded.dropped == 900
    gate.set()
    bounded.close()
    assert observed == [-1.0, *map(float, range(900, 1000))]


def test_a_broken_listener_is_kept_apart():
    def broken(s, step, u):
        raise RuntimeError("viewer died")

    bounded = BoundedListener(CallbackListener(on_sample=broken))
    bounded.sample(SAMPLE, 0, 0.0)
    bounded.close()
    assert "viewer died" in str(bounded.failure)
    bounded.sample(SAMPLE, 0, 0.0)
    assert bounded.dropped == 1

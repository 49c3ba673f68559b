"""A bench that can be stopped between its steps and while its lease expires, and can always be switched off."""

import pytest

from smarig.rig.stoppable_bench import StoppableBench


class Recorder:
    """A bench that notes what it is told."""

    period_s = 0.3

    def __init__(self):
        self.told = []

    def step(self, current_A, at_most):
        self.told.append(("step", current_A))
        return ()

    def idle(self, seconds):
        self.told.append(("idle", seconds))

    def safe(self):
        self.told.append(("safe", 0.0))


class Stop(Exception):
    """The request of a test."""


def stopped_after(looks):
    """A stop that is requested after so many looks."""

    def look():
        nonlocal looks
        looks -= 1
        if looks < 0:
            raise Stop

    return look


def test_without_a_stop_the_whole_time_passes_in_whole_ticks():
    bench = Recorder()
    StoppableBench(bench, stopped_after(1000)).idle(2.0)
    assert {what for what, _ in bench.told} == {"idle"}
    assert sum(seconds for _, seconds in bench.told) == pytest.approx(2.1)


def test_a_stop_does_not_wait_for_the_lease():
    bench = Recorder()
    with pytest.raises(Stop):
        StoppableBench(bench, stopped_after(2)).idle(600.0)
    assert bench.told == [("idle", 0.3), ("idle", 0.3)]


def test_no_step_follows_a_stop_but_the_current_goes_to_zero():
    bench = Recorder()
    stoppable = StoppableBench(bench, stopped_after(1))
    stoppable.step(0.1)
    with pytest.raises(Stop):
        stoppable.step(0.2)
    stoppable.safe()
    assert bench.told == [("step", 0.1), ("safe", 0.0)]

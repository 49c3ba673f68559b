"""The lease of a queried source counts from the first tick on: a busy host may pause before it, and between runs."""

import pytest

from rig.bench.instruments import FakeClock
from smarig.config import load_rig
from smarig.core import LeaseExpired, Quality
from smarig.device import Electrical, Garbled, HostClock, PolledPosition, PolledSource
from smarig.plant import Actuator
from smarig.rig import Bench

ONE = load_rig("bench_one_wire")
FILE = ONE.model_copy(update={"encoder": ONE.encoder.model_copy(update={"resolution": 0.002})})
PAUSE_S = 3.0  # the lease is 1 s


class Box:
    """A source and a laser on one clock. Its watchdog of 1 s trips whether or not a current flows, and latches."""

    identity, unit = "box", "mm"

    def __init__(self, clock):
        self.clock, self.tripped, self.has_lease = clock, "", False
        self.current_A, self.fed_s, self.armed = 0.0, clock(), 0
        self.watchdog_fits = True

    def arm(self):
        self.off()
        self.tripped, self.has_lease, self.fed_s = "", self.watchdog_fits, self.clock()
        self.armed += 1

    def watch(self):
        if self.has_lease and self.clock() - self.fed_s > FILE.lease_s:
            self.current_A, self.tripped = 0.0, "The watchdog of the box has expired."
        self.fed_s = self.clock()

    def set_current(self, current_A):
        self.watch()
        self.current_A = 0.0 if self.tripped else current_A

    def measure(self):
        self.watch()
        return Electrical(self.current_A, 5.0 * self.current_A)

    def off(self):
        self.current_A, self.fed_s = 0.0, self.clock()
        return ""

    def position(self):
        return 3.0

    def close(self):
        pass


@pytest.fixture
def rig():
    clock = FakeClock()
    box = Box(clock)
    sensor = PolledPosition(box, FILE, HostClock(FILE, clock))
    bench = Bench(
        FILE, Actuator.named(FILE.actuator), PolledSource(box), sensor, clock=clock, sleep=clock.sleep
    )
    return bench, box, clock


@pytest.mark.parametrize("first_A", [0.0, 0.4])
def test_three_seconds_before_the_first_tick_are_no_trip(rig, first_A):
    bench, box, clock = rig
    clock.sleep(PAUSE_S)
    samples = [s for _ in range(10) for s in bench.step(first_A)]
    samples += [s for _ in range(10) for s in bench.step(0.4)]
    assert {s.quality for s in samples} == {0}
    assert samples[-1].current_A == 0.4
    assert box.armed == 2


@pytest.mark.parametrize("first_A", [0.0, 0.4])
def test_three_seconds_between_two_runs_are_no_trip(rig, first_A):
    bench, _, clock = rig
    for current_A in (0.4, first_A, 0.4):
        bench.step(current_A)
    bench.safe()
    clock.sleep(PAUSE_S)
    samples = [s for _ in range(10) for s in bench.step(first_A)]
    assert {s.quality for s in samples} == {0}
    assert samples[-1].current_A == first_A


def test_a_pause_within_a_run_is_still_a_trip_and_stays_one(rig):
    bench, box, clock = rig
    bench.step(0.4)
    clock.sleep(PAUSE_S)
    assert bench.step(0.4)[-1].quality & Quality.TRIPPED
    with pytest.raises(LeaseExpired):
        bench.step(0.4)
    bench.safe()
    clock.sleep(PAUSE_S)
    with pytest.raises(LeaseExpired):
        bench.step(0.4)
    assert box.tripped, "switching off does not clear it"
    assert box.current_A == 0.0


def test_a_lease_that_cannot_be_armed_again_ends_the_run(rig):
    """The limits in force are those of a rig with a lease."""
    bench, box, _ = rig
    box.watchdog_fits = False
    with pytest.raises(Garbled, match="The lease of box could not be armed again"):
        bench.step(0.4)
    assert box.current_A == 0.0

"""A current source and an encoder that behave as the test prescribes, each with its own clock."""

from smarig.core.sample import NAN, Quality
from smarig.device.roles.ticked import CurrentReading, PositionReading


class FakeClock:
    """A clock whose time passes only in sleep()."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        assert seconds >= 0
        self.now += seconds


class Instrument:
    """One sample a period of its own clock, begun ``ahead`` ticks before the test."""

    identity = "fake"

    def __init__(self, clock, period_s=0.1, ahead=0, ppm=0.0):
        self.clock, self.period_s, self.ahead, self.ppm = clock, period_s, ahead, ppm
        self.begun = clock.now
        self.dead_until = 0.0
        self._latest = ahead
        self.closed = False

    def tick(self):
        passed = (self.clock.now - self.begun) * (1 + 1e-6 * self.ppm)
        self._latest = max(self._latest, int(passed / self.period_s + 1e-6) + self.ahead)
        return self._latest

    def ticks(self, first, at_most):
        if self.clock.now < self.dead_until:
            return range(0)
        return range(first, min(self.tick(), first + at_most - 1) + 1)

    def close(self):
        self.closed = True


class Source(Instrument):
    tripped = ""
    has_lease = True

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.sent = []
        self._since = []  # tick from which each flows
        self.offs = 0
        self.armed = 0

    def set(self, current_A):
        self.sent.append(current_A)
        self._since.append(self.tick() + 1)
        return self.tick()

    def flows(self, tick):
        """What flowed in a tick."""
        begun = sum(first <= tick for first in self._since)
        return self.sent[begun - 1] if begun else 0.0

    def since(self, tick, at_most):
        mark = Quality.TRIPPED if self.tripped else Quality.GOOD
        return [
            CurrentReading(k, self.flows(k), 5 * self.flows(k), NAN, mark) for k in self.ticks(tick, at_most)
        ]

    def arm(self):
        self.armed += 1
        self.tripped = ""

    def off(self):
        self.offs += 1


class Sensor(Instrument):
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.oldest = 0
        self.zeroed = 0
        self._zero_tick = 0  # later ticks count from its position, earlier ones as ever

    def since(self, tick, at_most):
        return [
            PositionReading(k, 10 * (k - self._zero_tick * (k > self._zero_tick)), 22.0, Quality.GOOD)
            for k in self.ticks(max(tick, self.oldest), at_most)
        ]

    def zero(self):
        self.zeroed += 1
        self._zero_tick = self.tick()

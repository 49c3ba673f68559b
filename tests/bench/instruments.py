"""A current source and an encoder that do what a test says, by clocks of their own."""

from smarig.drivers.roles import CurrentReading, PositionReading
from smarig.sample import NAN, Quality


class FakeClock:
    """Time that passes only when somebody sleeps."""

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
        self.closed = False

    def tick(self):
        passed = (self.clock.now - self.begun) * (1 + 1e-6 * self.ppm)
        return int(passed / self.period_s + 1e-6) + self.ahead

    def ticks(self, first, at_most):
        if self.clock.now < self.dead_until:
            return range(0)
        return range(first, min(self.tick(), first + at_most - 1) + 1)

    def close(self):
        self.closed = True


class Source(Instrument):
    tripped = ""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.sent = []
        self.offs = 0
        self.armed = 0

    def set(self, current_A):
        self.sent.append(current_A)
        return self.tick()

    def since(self, tick, at_most):
        now = self.sent[-1] if self.sent else 0.0
        mark = Quality.TRIPPED if self.tripped else Quality.GOOD
        return [CurrentReading(k, now, 5 * now, NAN, mark) for k in self.ticks(tick, at_most)]

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

    def since(self, tick, at_most):
        return [
            PositionReading(k, 10 * k, 22.0, Quality.GOOD)
            for k in self.ticks(max(tick, self.oldest), at_most)
        ]

    def zero(self):
        self.zeroed += 1

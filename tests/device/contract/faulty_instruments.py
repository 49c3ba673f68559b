"""An output and a position sensor that meet the contract, and ways to break it, one each. Their time is the test's."""

import math

from smarig.core import UsageError
from smarig.core.sample import Quality
from smarig.device import CurrentReading, Electrical, Garbled, PositionReading, Silent


class SimulatedTime:
    """Seconds that pass only when they are waited for."""

    def __init__(self):
        self.now_s = 1000.0

    def wait(self, seconds):
        self.now_s += seconds


class Output:
    """A current output with a watchdog of 1 s, through 5 ohm; what it drives survives its host (``state``)."""

    identity = "ACME,CC-1,42,1.0"

    def __init__(self, time, state, present=True):
        if not present:
            raise Silent("There is nobody.")
        self.time, self.state = time, state
        self.has_lease, self.tripped = False, ""
        self.off()

    def watch(self):
        if self.time.now_s - self.state.get("fed_s", self.time.now_s) > 1.0 and self.state["A"]:
            self.state["A"], self.tripped = 0.0, "Its watchdog has switched it off."
        self.state["fed_s"] = self.time.now_s

    def arm(self):
        self.state |= {"A": 0.0, "fed_s": self.time.now_s}
        self.has_lease, self.tripped = True, ""

    def set_current(self, current_A):
        if not math.isfinite(current_A):
            raise UsageError("No number.")
        self.watch()
        if not self.tripped:
            self.state["A"] = current_A

    def measure(self):
        self.watch()
        return Electrical(self.state["A"], 5 * self.state["A"])

    def off(self):
        self.state["A"] = 0.0
        return ""

    def close(self):
        pass


class Delayed(Output):
    """The host stalls for longer than the lease before some of its queries, as on a busy computer."""

    def measure(self):
        if self.state["A"] and self.state.get("stalls", 0):
            self.state["stalls"] -= 1
            self.time.wait(1.2)
        return super().measure()


class LeftOn(Output):
    def __init__(self, time, state, present=True):
        before = dict(state)
        super().__init__(time, state, present)
        self.state |= before

    def arm(self):
        kept = self.state.get("A", 0.0)
        super().arm()
        self.state["A"] = kept


class OnWhenOpened(Output):
    def arm(self):
        super().arm()
        self.state["A"] = 0.2


class MeasuresNoCurrent(Output):
    def measure(self):
        return Electrical(math.nan, 5 * self.state["A"])


class Weak(Output):
    def measure(self):
        now = super().measure()
        return now._replace(current_A=0.3 * now.current_A)


class Strong(Output):
    """Within the tolerance of a current, but 1.4 times what is ordered."""

    def measure(self):
        now = super().measure()
        return now._replace(current_A=1.4 * now.current_A)


class Thousandfold(Output):
    """It returns mA as A."""

    def measure(self):
        now = super().measure()
        return now._replace(current_A=1000 * now.current_A)


class Thousandth(Output):
    def measure(self):
        now = super().measure()
        return now._replace(current_A=now.current_A / 1000)


class Blind(Output):
    def measure(self):
        return super().measure()._replace(voltage_V=math.nan)


class StaysOn(Output):
    def off(self):
        return "" if "A" in self.state else super().off()


class OffRaises(Output):
    closed = False

    def off(self):
        if self.closed:
            raise OSError("bad file descriptor")
        return super().off()

    def close(self):
        self.closed = True


class NoLease(Output):
    """It claims a lease and has none."""

    def watch(self):
        pass


class SilentTrip(Output):
    """Its watchdog works, but it does not notice."""

    def watch(self):
        super().watch()
        self.tripped = ""


class StaysTripped(Output):
    def arm(self):
        kept = self.tripped
        super().arm()
        self.tripped = kept


class CloseRaises(Output):
    closed = False

    def close(self):
        if self.closed:
            raise OSError("bad file descriptor")
        self.closed = True


class Nameless(Output):
    identity = " "


class OutputByAnyName(Output):
    """Opens where there is no device."""

    def __init__(self, time, state, present=True):
        super().__init__(time, state, True)


class AbsenceAsTraceback(Output):
    def __init__(self, time, state, present=True):
        if not present:
            raise KeyError("port")
        super().__init__(time, state)


class TickedOutput:
    """A source that counts ticks, for the requirements that a queried one meets by construction."""

    identity, has_lease, tripped = "ACME,TC-1,42,1.0", False, ""

    def __init__(self, time, state, present=True):
        if not present:
            raise Silent("There is nobody.")
        self.time, self.state, self.begin_s = time, state, time.now_s
        state["A"] = 0.0

    def tick(self):
        return int((self.time.now_s - self.begin_s) / 0.1 + 1e-6)

    def arm(self):
        self.state["A"] = 0.0

    def set(self, current_A):
        if not math.isfinite(current_A):
            raise UsageError("No number.")
        self.state["A"] = current_A
        return self.tick()

    def reading(self, tick):
        return CurrentReading(tick, self.state["A"], 5 * self.state["A"], math.nan, Quality.GOOD)

    def since(self, tick, at_most):
        return [self.reading(k) for k in range(tick, min(self.tick(), tick + at_most - 1) + 1)]

    def off(self):
        self.state["A"] = 0.0
        return ""

    def close(self):
        pass


class Impatient(TickedOutput):
    """Its lease of 1 s counts from opening on, and nobody renews it until the first order."""

    has_lease = True

    def __init__(self, time, state, present=True):
        super().__init__(time, state, present)
        self.arm()

    def arm(self):
        super().arm()
        self.tripped, self.fed_s = "", self.time.now_s

    def fed(self):
        if self.time.now_s - self.fed_s > 1.0:
            self.state["A"], self.tripped = 0.0, "Its watchdog has switched it off."
        self.fed_s = self.time.now_s

    def set(self, current_A):
        self.fed()
        return self.tick() if self.tripped else super().set(current_A)

    def since(self, tick, at_most):
        self.fed()
        mark = Quality.TRIPPED if self.tripped else Quality.GOOD
        return [reading._replace(quality=mark) for reading in super().since(tick, at_most)]


class FedByOrders(Impatient):
    """Its lease is renewed by orders alone, as that of a box whose heartbeat is written with the set-point."""

    def since(self, tick, at_most):
        fed_s = self.fed_s
        found = super().since(tick, at_most)
        self.fed_s = fed_s
        return found


class TooMany(TickedOutput):
    def since(self, tick, at_most):
        return super().since(tick, at_most + 2)


class OldReadings(TickedOutput):
    def since(self, tick, at_most):
        return super().since(max(0, tick - 2), at_most)


class Backwards(TickedOutput):
    def since(self, tick, at_most):
        return super().since(tick, at_most)[::-1]


class AcceptsNaN(TickedOutput):
    def set(self, current_A):
        self.state["A"] = 0.0 if math.isnan(current_A) else current_A
        return self.tick()


class Sensor:
    """A position sensor of 10 samples a second at rest at 250 counts."""

    identity = "ACME,ENC,7"
    period_s = 0.1

    def __init__(self, time, state, present=True):
        if not present:
            raise Silent("There is nobody.")
        self.time, self.begin_s, self._zero = time, time.now_s, 0

    def tick(self):
        return int((self.time.now_s - self.begin_s) / self.period_s + 1e-6)

    def since(self, tick, at_most):
        last = min(self.tick(), tick + at_most - 1)
        return [PositionReading(k, 250 - self._zero, 22.0, Quality.GOOD) for k in range(tick, last + 1)]

    def zero(self):
        self._zero = 250

    def close(self):
        pass


class Slow(Sensor):
    period_s = 0.2


class Prophet(Sensor):
    def since(self, tick, at_most):
        return [PositionReading(tick, 0, 22.0, Quality.GOOD)]


class NoZero(Sensor):
    def zero(self):
        pass


class Fractional(Sensor):
    def since(self, tick, at_most):
        return [reading._replace(counts=0.5) for reading in super().since(tick, at_most)]


class Thermometer:
    identity = "ACME,PT100"

    def __init__(self, time, state, present=True):
        if not present:
            raise Garbled("No sensor.")

    def temperature_degC(self):
        return 22.5

    def close(self):
        pass


class Kelvin(Thermometer):
    def temperature_degC(self):
        return -295.6


class Cell(Thermometer):
    def force_N(self):
        return 12.0


class CellAsText(Cell):
    def force_N(self):
        return "12 N"

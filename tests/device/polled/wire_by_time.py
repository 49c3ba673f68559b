"""The wire of a twin with a current that changes at any time, to test instruments of other libraries on."""

import time

from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.rig import Specimen, TwinSettings

SPEED = 40.0  # device seconds per second


class WireByTime:
    """``drive`` sets the current; ``look`` lets the time that has passed act on the wire."""

    def __init__(self, rig="one_wire_twin", seed=1):
        self.file = load_rig(rig)
        self.actuator = Actuator.named(self.file.actuator)
        self.specimen = Specimen(self.file, self.actuator, TwinSettings(seed=seed))
        self.per_count = self.specimen.position_per_count
        self.current_A, self.begin_s = 0.0, time.monotonic()
        self.largest_A = 0.0

    def drive(self, current_A):
        self.look()
        self.current_A = current_A
        self.largest_A = max(self.largest_A, abs(current_A))

    def look(self):
        due = int((time.monotonic() - self.begin_s) * SPEED / self.file.period_s)
        while self.specimen.tick < due:
            self.specimen.advance(self.current_A)

    @property
    def voltage_V(self):
        self.look()
        return self.current_A * self.actuator.resistance_ohm

    @property
    def position_mm(self):
        self.look()
        return self.specimen.counts_now() * self.per_count


WIRE = [WireByTime()]  # of the test that runs; drivers in files of their own take it from here

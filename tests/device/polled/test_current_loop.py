"""The current loop of the host on a voltage output, against Ohm's law."""

import pytest

from smarig.config import load_rig
from smarig.device import CurrentLoop, Electrical

RIG = load_rig("bench_one_wire")  # a wire of 4.5 to 5 ohm, at most 1 A


class Stage:
    """A voltage output on a resistance that the test changes."""

    identity, has_lease, tripped = "stage", True, ""

    def __init__(self, ohm):
        self.ohm, self.voltage_V, self.offs = ohm, 0.0, 0

    def arm(self):
        self.voltage_V = 0.0

    def set_voltage(self, voltage_V):
        self.voltage_V = voltage_V

    def measure(self):
        return Electrical(self.voltage_V / self.ohm, self.voltage_V)

    def off(self):
        self.voltage_V, self.offs = 0.0, self.offs + 1
        return ""

    def close(self):
        pass


@pytest.mark.parametrize("ohm", [4.5, 4.8, 5.5])
def test_one_measurement_after_the_order_the_current_is_right(ohm):
    stage = Stage(ohm)
    loop = CurrentLoop(stage, RIG)
    loop.set_current(0.8)
    assert 0.5 < loop.measure().current_A <= 0.8, "the first step is rather low than high"
    assert loop.measure().current_A == pytest.approx(0.8, rel=1e-12)


def test_it_follows_a_resistance_that_changes():
    stage = Stage(5.0)
    loop = CurrentLoop(stage, RIG)
    loop.set_current(0.6)
    for k in range(50):
        stage.ohm = 5.0 - 0.01 * k
        loop.measure()
    assert loop.measure().current_A == pytest.approx(0.6, rel=0.003), "off by the change within one tick"


def test_a_short_circuit_or_an_open_wire_does_not_run_away():
    """The resistance is kept within that of the wire, and the voltage within what the largest current needs."""
    stage = Stage(0.01)
    loop = CurrentLoop(stage, RIG)
    loop.set_current(1.0)
    loop.measure()
    assert stage.voltage_V == pytest.approx(4.5 / 1.3), "that of the smallest resistance it may have"
    stage.ohm = 1e6
    for _ in range(20):
        loop.measure()
    assert stage.voltage_V <= 1.1 * 5.0 + 1e-12


def test_a_resistance_above_that_of_the_wire_does_not_raise_the_voltage_above_its_limit():
    stage = Stage(6.2)  # within the leeway of 1.3 x 5 ohm
    loop = CurrentLoop(stage, RIG)
    loop.set_current(1.0)
    for _ in range(3):
        loop.measure()
    assert stage.voltage_V == pytest.approx(1.1 * 5.0), "not 6.2 V"


def test_zero_is_zero_and_off_stays_off():
    stage = Stage(5.0)
    loop = CurrentLoop(stage, RIG)
    loop.set_current(0.8)
    loop.measure()
    loop.off()
    loop.measure()
    assert (stage.voltage_V, stage.offs) == (0.0, 1)


def test_a_tripped_output_is_not_driven():
    stage = Stage(5.0)
    loop = CurrentLoop(stage, RIG)
    loop.set_current(0.8)
    stage.tripped, stage.voltage_V = "its watchdog", 0.0
    loop.measure()
    assert (loop.tripped, stage.voltage_V) == ("its watchdog", 0.0)

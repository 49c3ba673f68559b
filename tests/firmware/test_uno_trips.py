"""The Uno drives, measures, and takes the current away: lease, stop, missing sensors, a program that hangs.

All times are device times.
"""

import numpy as np
import pytest

from firmware.codes import ARMED, IS_OFF, LEASE, OPEN, OVER_CURRENT, STOP, TRIPPED
from firmware.uno_emulator import AMPLIFIER, DAQ

NO_CURRENT_uA = 2000
HALF_uA = 500_000
LEASE_MS, TICK_MS, MEASURE_MS = 500, 100, 35


def driven(uno, current_uA=HALF_uA, **settings):
    """A board that drives a current, for some ticks."""
    board = uno()
    board.settings(**settings)
    board.arm()
    status = board.drive(current_uA, 5)
    assert (status["state"], status["output"]) == (ARMED, current_uA)
    return board


def last_flow_ms(trace):
    """When current flowed last."""
    return trace.ms[np.flatnonzero(trace.mean_uA > NO_CURRENT_uA)[-1]]


def silence_ms(trace):
    """The host's last byte before its longest silence."""
    bytes_ms = np.unique(trace.last_byte_ms[trace.last_byte_ms > 0])
    return bytes_ms[np.argmax(np.diff(bytes_ms))]


def test_both_devices_answer_on_one_line(uno):
    board = uno()
    amplifier, daq = board.command(), board.position()
    for status, definition in ((amplifier, AMPLIFIER), (daq, DAQ)):
        d = definition.device
        assert (status["kind"], status["version"], status["map_hash"]) == (d.kind, d.version, definition.hash)
        assert status["boot_count"] == 1
    assert amplifier["state"] == IS_OFF
    board.go(300)
    daq = board.position()
    assert abs(daq["counts"] - 1005) <= 1
    assert daq["fault"] == 0
    assert abs(daq.samples[-1][1] - 2200) <= 20, "the ambient temperature, 0.01 degC"


def test_it_drives_and_measures(uno):
    board = driven(uno)
    current, voltage, output, _, marks = board.drive(HALF_uA, 3).samples[-1]
    trace = board.close()
    assert (output, marks) == (HALF_uA, 0)
    assert abs(current - HALF_uA) < 2000
    assert 4.5 < voltage / current < 5.05, "the wire, and its lead"
    assert abs(np.mean(trace.mean_uA[-200:]) - HALF_uA) < 1000, "what really flows"


@pytest.mark.long("takes three seconds")
def test_the_ring_keeps_32_samples(uno):
    board = uno()
    board.settings(period=20)
    board.go(1000)
    status = board.command(ring_next=1)
    assert status["tick"] > 40
    assert (status["ring_first"], len(status.samples)) == (status["tick"] - 31, 12)


@pytest.mark.long("takes a second")
def test_the_lease_ends_the_current(uno):
    board = driven(uno)
    board.go(1000)
    status = board.command()
    trace = board.close()
    assert (status["state"], status["trip"]) == (TRIPPED, LEASE)
    flowed_ms = last_flow_ms(trace) - silence_ms(trace)
    assert 400 < flowed_ms <= LEASE_MS + TICK_MS + MEASURE_MS, "the lease, and the tick in which it ends"


def test_the_stop_input_ends_the_current_at_once(uno):
    board = driven(uno)
    stopped_ms, current_uA = board.now("stop open")
    assert current_uA > NO_CURRENT_uA
    board.go(200)
    status = board.command()
    assert (status["state"], status["trip"]) == (TRIPPED, STOP)
    trace = board.close()
    assert last_flow_ms(trace) <= stopped_ms + 8, "not at the end of the tick"


@pytest.mark.long("takes three seconds")
def test_a_short_stop_is_not_forgotten(uno):
    board = driven(uno)
    board.tell("stop open")
    board.go(5)
    board.tell("stop closed")
    board.go(200)
    assert board.command()["trip"] == STOP


@pytest.mark.long("takes a second")
def test_without_a_current_sensor_the_gate_closes(uno):
    board = driven(uno)
    board.tell("unplug ina219")
    board.go(450)
    status = board.command()
    assert (status["state"], status["trip"]) == (TRIPPED, OPEN)
    trace = board.close()
    assert np.sum(trace.mean_uA[-500:] > NO_CURRENT_uA) < 60, "no burst in later ticks"


@pytest.mark.long("takes ten seconds")
def test_the_current_sensor_may_come_back(uno):
    board = driven(uno)
    board.tell("unplug ina219")
    board.go(450)
    board.tell("plug ina219")
    board.arm()
    assert abs(board.drive(HALF_uA, 4).samples[-1][0] - HALF_uA) < 2000


@pytest.mark.long("takes a second")
def test_a_missing_magnet_or_encoder_is_a_fault(uno):
    board = uno()
    board.go(300)
    for broken, mended in (("magnet off", "magnet on"), ("unplug as5600", "plug as5600")):
        board.tell(broken)
        board.go(300)
        assert board.position()["fault"] == 1
        board.tell(mended)
        board.go(300)
        assert board.position()["fault"] == 0


def test_turns_are_counted(uno):
    board = uno()
    board.go(300)
    begin = board.position()["counts"]
    for turned in range(0, 6001, 500):
        board.tell(f"turned {turned}")
        board.go(3)
    assert abs(board.position()["counts"] - begin - 6000) <= 2


@pytest.mark.long("takes a second")
def test_a_shunt_that_jumps_cuts_the_gate(uno):
    board = driven(uno, current_uA=900_000)
    board.tell("gain 1.3")
    board.go(110)
    status = board.command()
    assert (status["state"], status["trip"]) == (TRIPPED, OVER_CURRENT)
    assert board.position()["fault"] == 0


def test_an_opened_supply_trips_as_open(uno):
    board = driven(uno)
    board.tell("supply 0")
    board.go(450)
    status = board.command()
    assert (status["state"], status["trip"]) == (TRIPPED, OPEN)


def flashes(trace, ms):
    """How often the LED is switched on in the last milliseconds."""
    return int(np.sum(np.diff(trace.led[-ms:]) > 0))


@pytest.mark.long("takes ten seconds")
def test_the_led_tells_the_state(uno):
    board = uno()
    board.settings()
    board.go(4000)
    assert flashes(board.close(), 4000) == 2, "off: every two seconds"
    board = driven(uno)
    assert board.close().led[-50:].all(), "current: on"
    board = driven(uno)
    board.tell("stop open")
    board.go(200 + 2 * 8 * 400)
    period_ms = (2 * 8 + 5) * 200
    assert flashes(board.close(), period_ms) == 8, "the number of the trip `stop`"


def test_a_hanging_program_is_reset_with_the_gate_closed(uno):
    board = driven(uno)
    boots = board.command()["boot_count"]
    hung_ms, _ = board.now("hang")
    board.go(400)
    status = board.command()
    assert (status["boot_count"], status["state"], status["echo"]) == (boots + 1, IS_OFF, 0)
    trace = board.close()
    assert last_flow_ms(trace) <= hung_ms + 130, "the watchdog's 120 ms"

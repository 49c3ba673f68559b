"""The amplifier's trips: lease timing to the tick, each cause at its limit, their order, and the latch."""

import itertools

import pytest

from firmware.codes import (
    ARM,
    ARMED,
    HEAT,
    IS_OFF,
    LEASE,
    NO_TEMPERATURE,
    NONE,
    NOT_NOW,
    OFF,
    OPEN,
    OVER_CURRENT,
    REARM,
    RESISTANCE,
    SHORT,
    SLEW,
    STOP,
    STOP_IS_OPEN,
    TRIPPED,
    WIRE_TEMPERATURE,
)

WIDE = {"current_min": -2_000_000, "current_max": 2_000_000, "slew_max": 1_000_000, "heat_max": 2**32 - 1}


def trip_tick(amp, *inputs, most=20):
    """The tick in which the same inputs trip, and the cause; 0 for never."""
    for tick in range(1, most + 1):
        amp.tick(*inputs)
        status = amp.status()
        if status["state"] == TRIPPED:
            assert amp.output_uA == status["output"] == status["lease_left"] == 0
            return tick, status["trip"]
    return 0, 0


@pytest.mark.parametrize(
    ("period", "lease", "ticks"),
    [
        (100, 500, 5),
        (1, 500, 500),
        (100, 549, 5),
        (100, 550, 6),
        (800, 2000, 3),
        (250, 500, 2),
        (1000, 2000, 2),
    ],
)
def test_the_lease_trips_in_its_tick(amp, period, lease, ticks):
    assert amp.settings(period=period, lease=lease, **WIDE) == 0
    amp.tick(0, 0, 0, 0, times=7)  # what came before does not count
    amp.command(order=ARM)
    assert amp.status()["lease_left"] == ticks * period
    amp.tick(0, 0, 0, 0, times=ticks)
    status = amp.status()
    assert (status["state"], status["lease_left"]) == (ARMED, 0)
    amp.tick(0, 0, 0, 0)
    status = amp.status()
    assert (status["state"], status["trip"]) == (TRIPPED, LEASE)


def test_only_new_sequence_words_feed_the_lease(amp):
    words = itertools.count(1)

    def after(feed):
        amp.command(sequence=next(words), order=OFF)
        last = next(words)
        amp.command(sequence=last, order=ARM)
        amp.tick(0, 0, 0, 0, times=5)
        feed(last)
        return trip_tick(amp, 0, 0, 0, 0)

    assert after(lambda last: None) == (1, LEASE)
    assert after(lambda last: amp.command(sequence=next(words))) == (6, LEASE)
    assert after(lambda last: amp.command(sequence=last)) == (1, LEASE)  # a repetition
    assert after(lambda last: amp.command(sequence=last - 1, order=ARM)) == (
        1,
        LEASE,
    )  # a frame delivered late
    assert after(lambda last: amp.command(sequence=last + 257)) == (1, LEASE)  # no host is so far ahead
    assert after(lambda last: amp.status()) == (1, LEASE)
    assert after(lambda last: amp.command(sequence=last + 1, order=ARM)) == (1, LEASE)  # refused
    assert after(lambda last: amp.settings()) == (1, LEASE)  # refused
    assert after(lambda last: amp.line("w 100 3 *0000")) == (1, LEASE)


def test_an_old_arm_frame_after_off_lets_no_current_flow(amp):
    amp.command(sequence=1, order=ARM, current=500_000)
    amp.command(sequence=2, order=OFF)
    assert amp.command(sequence=1, order=ARM, current=500_000) == 0  # answered
    status = amp.status()
    assert (status["state"], status["output"], status["echo"]) == (IS_OFF, 0, 2)


@pytest.mark.parametrize(
    ("last", "sequence", "new"),
    [
        (65_535, 65_536, True),
        (65_535, 65_535 + 256, True),
        (65_535, 65_535 + 257, False),
        (65_535, 1, False),
        (65_536, 1, False),
        (65_300, 65_556, True),
        (65_300, 65_557, False),
        (65_300, 20, False),
        (3, 65_535, False),
        (3, 2**32 - 1, False),
    ],
)
def test_one_of_the_next_numbers_is_new_and_none_goes_round(amp, last, sequence, new):
    for between in range(256, last, 256):
        amp.command(sequence=between)
    amp.command(sequence=last)
    amp.command(sequence=sequence)
    assert amp.status()["echo"] == (sequence if new else last)


@pytest.mark.parametrize(
    ("output", "current", "voltage", "hardware", "expected"),
    [
        (0, 0, 0, STOP_IS_OPEN, (1, STOP)),
        (0, 2_100_000, 10**7, 0, (6, LEASE)),  # the margin is 5 %
        (0, 2_100_001, 10**8, 0, (1, OVER_CURRENT)),
        (0, -2_100_001, 10**8, 0, (1, OVER_CURRENT)),
        (0, -(2**31), 0, 0, (1, OVER_CURRENT)),
        (100_001, 50_000, 10**6, 0, (3, OPEN)),
        (100_000, 50_000, 10**6, 0, (6, LEASE)),
        (-100_000, 49_999, 10**6, 0, (3, OPEN)),
        (49_999, 0, 0, 0, (6, LEASE)),  # too little to tell
        (50_000, 0, 0, 0, (3, OPEN)),
        (0, 50_000, 49_999, 0, (3, SHORT)),
        (0, -50_000, -49_999, 0, (3, SHORT)),
        (0, 50_000, 50_000, 0, (6, LEASE)),  # 1 ohm is not below 1 ohm
        (0, 49_999, 0, 0, (6, LEASE)),
        (0, -1_000_000, 20_000_001, 0, (3, RESISTANCE)),
        (0, 1_000_000, -20_000_000, 0, (6, LEASE)),
        (0, 2_000_000, -(2**31), 0, (3, RESISTANCE)),
    ],
)
def test_causes_at_their_borders(amp, output, current, voltage, hardware, expected):
    assert amp.settings(resistance_min=1000, resistance_max=20_000, **WIDE) == 0
    assert amp.command(order=ARM, current=output) == 0
    assert trip_tick(amp, current, voltage, 0, hardware) == expected


def test_three_in_a_row_means_in_a_row(amp):
    amp.command(order=ARM, current=100_000)
    for current in (0, 0, 100_000, 0, 0):
        amp.tick(current, 0, 0, 0)
    assert amp.status()["state"] == ARMED
    amp.command(order=OFF)
    amp.command(order=ARM, current=100_000)
    assert trip_tick(amp, 0, 0, 0, 0) == (3, OPEN)  # arming begins a new row


def test_the_margin_is_of_the_larger_limit(amp):
    amp.settings(**(WIDE | {"current_min": 0, "current_max": 999}))
    for current, trips in ((1048, False), (1049, True), (-49, False), (-50, True)):
        amp.command(order=OFF)
        amp.command(order=ARM)
        amp.tick(current, 0, 0, 0)
        assert (amp.status()["trip"] == OVER_CURRENT) == trips


@pytest.mark.parametrize(
    ("step", "trips"), [(100_000, False), (-100_000, False), (100_001, True), (-100_001, True)]
)
def test_slew(amp, step, trips):
    amp.settings(**(WIDE | {"slew_max": 1000}))
    amp.command(order=ARM, current=50_000)
    assert amp.command(sequence=77, current=50_000 + step) == 0  # accepted, and then
    status = amp.status()
    assert (
        (status["echo"], status["state"], status["trip"]) == (77, TRIPPED, SLEW) if trips else (77, ARMED, 0)
    )
    assert amp.output_uA == (0 if trips else 50_000 + step)


def test_slew_in_the_exchange_that_arms(amp):
    amp.settings(**(WIDE | {"slew_max": 1000}))
    assert amp.command(order=ARM, current=100_001) == 0
    assert amp.status()["trip"] == SLEW


def test_heat_tick_by_tick(amp):
    # 1 A for 100 ms is 100 000 of 1e-6 A²s; a time constant of 1 s forgets a tenth in each tick
    amp.settings(**(WIDE | {"heat_max": 271_000, "heat_settle": 1000}))
    amp.command(order=ARM)
    for heat, trip in (
        (100_000, 0),
        (190_000, 0),
        (271_000, 0),
        (343_900, HEAT),
    ):  # beyond, not at, its limit
        amp.tick(-1_000_999, 10**7, 0, 0)  # whole mA, towards zero
        assert (amp.status()["heat"], amp.status()["trip"]) == (heat, trip)
    amp.tick(0, 0, 0, 0)
    assert amp.status()["heat"] == 343_900 - 34_390  # it goes on when nothing flows


def test_heat_at_its_ends(amp):
    """The register's largest value; then all is forgotten within the time constant, or a sixtieth of it."""
    full = 2**32 - 1
    for settle, left in ((60_000, full - full // 60), (100, 0)):
        slow = {"period": 1000, "lease": 2000, "heat_settle": settle}
        assert amp.settings(**(WIDE | slow)) == 0
        amp.tick(-(2**31), 0, 0, 0)
        assert amp.status()["heat"] == full
        amp.tick(3000, 0, 0, 0)
        assert amp.status()["heat"] == left + 9


@pytest.mark.parametrize(
    ("ticks", "cause"),
    [
        (((200_000, 0, 0), (60_000, 0, 0), (2_100_001, 0, STOP_IS_OPEN)), STOP),
        (((60_000, 0, 0), (60_000, 0, 0), (2_100_001, 0, 0)), OVER_CURRENT),
        (((60_000, 0, 0), (60_000, 0, 0), (60_000, 0, 0)), OPEN),
        (((200_000, 0, 0), (200_000, 0, 0), (200_000, 0, 0)), SHORT),
        (((200_000, 200_000, 0), (200_000, 200_000, 0), (200_000, 200_000, 0)), RESISTANCE),
        (((0, 0, 0), (0, 0, 0), (2_000_000, 0, 0)), HEAT),
        (((0, 0, 0), (0, 0, 0), (0, 0, 0)), LEASE),
    ],
)
def test_the_order_of_causes(amp, ticks, cause):
    """In the third tick each cause comes together with the ones after it: the lease lasts two ticks."""
    limits = {"resistance_min": 1000, "resistance_max": 999, "heat_max": 29_000, "heat_settle": 60_000}
    assert amp.settings(**(WIDE | limits | {"period": 250})) == 0
    output = 200_000 if any(current for current, *_ in ticks[:2]) else 0
    amp.command(order=ARM, current=output)
    for current, voltage, hardware in ticks:
        assert amp.status()["state"] == ARMED
        amp.tick(current, voltage, 0, hardware)
    assert amp.status()["trip"] == cause


@pytest.mark.parametrize(
    ("limit", "before", "temperature", "expected"),
    [
        (9000, 2000, 9000, (6, LEASE)),
        (9000, 2000, 9001, (1, WIRE_TEMPERATURE)),
        (9000, NO_TEMPERATURE, 32767, (1, WIRE_TEMPERATURE)),
        (-1, -2, 0, (1, WIRE_TEMPERATURE)),
        (9000, 2000, NO_TEMPERATURE, (1, WIRE_TEMPERATURE)),
        (9000, NO_TEMPERATURE, NO_TEMPERATURE, (6, LEASE)),  # there is no thermometer
        (NO_TEMPERATURE, 2000, 32767, (6, LEASE)),
        (NO_TEMPERATURE, 2000, NO_TEMPERATURE, (6, LEASE)),
    ],
)
def test_wire_temperature(amp, limit, before, temperature, expected):
    assert amp.settings(wire_temperature_max=limit, **WIDE) == 0
    amp.tick(0, 0, before, 0)
    amp.command(order=ARM, current=40_000)
    assert trip_tick(amp, 40_000, 0, temperature, 0) == expected


def test_a_trip_of_wire_temperature_is_latched_until_cleared(amp):
    assert amp.settings(wire_temperature_max=9000, **WIDE) == 0
    amp.command(order=ARM, current=40_000)
    amp.tick(40_000, 0, 9001, 0)
    amp.tick(0, 0, 2000, 0, times=20)
    assert amp.command(order=ARM) == amp.command(current=1) == NOT_NOW
    assert (amp.status()["trip"], amp.output_uA) == (WIRE_TEMPERATURE, 0)
    assert amp.command(order=REARM, current=40_000) == 0
    assert (amp.status()["trip"], amp.output_uA) == (0, 40_000)


def test_a_trip_is_latched(amp):
    amp.command(order=ARM, current=100_000)
    amp.tick(100_000, 0, 0, STOP_IS_OPEN)
    amp.tick(3_000_000, 0, 0, 0, times=20)
    assert amp.command(order=NONE, current=0) == 0
    assert amp.command(order=ARM) == NOT_NOW
    assert amp.command(order=NONE, current=1) == NOT_NOW
    status = amp.status()
    assert (status["state"], status["trip"]) == (TRIPPED, STOP)  # the first cause stays
    assert amp.command(order=REARM, current=100_000) == 0
    assert (amp.status()["trip"], amp.output_uA) == (0, 100_000)


def test_off_and_arm_end_a_trip(amp):
    amp.command(order=ARM)
    amp.tick(0, 0, 0, STOP_IS_OPEN)
    assert amp.command(order=OFF) == 0
    assert (amp.status()["state"], amp.status()["trip"]) == (IS_OFF, 0)
    assert amp.command(order=ARM) == 0
    assert amp.status()["state"] == ARMED


def test_nothing_trips_while_off(amp):
    amp.tick(2**31 - 1, -(2**31), 0, STOP_IS_OPEN, times=10)
    assert (amp.status()["state"], amp.status()["trip"]) == (IS_OFF, 0)

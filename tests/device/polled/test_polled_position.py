"""A queried position as the sensor of a bench: counts of the rig's resolution, ticks of the host, gaps."""

import math

import pytest

from smarig.config import load_rig
from smarig.core import ConfigError, Quality
from smarig.device import FunctionInput, Garbled, HostClock, PolledPosition

ONE = load_rig("bench_one_wire")
RIG = ONE.model_copy(update={"encoder": ONE.encoder.model_copy(update={"resolution": 0.002})})


class Laser:
    identity, unit = "laser", "mm"

    def __init__(self, *positions):
        self.positions = list(positions)

    def position(self):
        return self.positions.pop(0) if len(self.positions) > 1 else self.positions[0]

    def close(self):
        self.positions = [math.nan]


class Clock:
    def __init__(self):
        self.now = 5.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_counts_are_steps_of_the_resolution_from_the_zero(clock):
    sensor = PolledPosition(Laser(3.0, 3.0, 3.5011), RIG, HostClock(RIG, clock))
    sensor.zero()
    clock.now += 0.1
    assert sensor.since(1, 5) == [(1, 251, 22.0, Quality.GOOD)], "(3.5011 - 3.0)/0.002, rounded"


@pytest.mark.parametrize("room", [None, FunctionInput("thermometer", lambda: 19.5)])
def test_the_ambient_temperature_is_measured_where_there_is_a_thermometer(clock, room):
    sensor = PolledPosition(Laser(3.0), RIG, HostClock(RIG, clock), room)
    clock.now += 0.1
    assert sensor.measures_ambient == (room is not None)
    assert sensor.since(1, 5)[0].ambient_degC == (19.5 if room else 22.0)


def test_a_late_reading_belongs_to_the_tick_in_which_it_was_taken(clock):
    """Its query was repeated, or waited: the wire went on meanwhile."""

    class Late(Laser):
        def position(self):
            clock.now += 0.25
            return super().position()

    sensor = PolledPosition(Late(3.0), RIG, HostClock(RIG, clock))
    clock.now = 5.3
    before = sensor.tick()
    (reading,) = sensor.since(before, 5)
    assert reading.tick == sensor.tick() == before + 2
    assert sensor.since(reading.tick + 1, 5) == [], "no tick has two"


def test_one_reading_a_tick_and_none_before_it_comes(clock):
    sensor = PolledPosition(Laser(3.0), RIG, HostClock(RIG, clock))
    assert sensor.since(sensor.tick() + 1, 5) == []
    clock.now += 0.55
    assert [reading.tick for reading in sensor.since(1, 5)] == [5], (
        "four ticks were missed and have no reading"
    )


@pytest.mark.parametrize("absurd", [1e30, -1e30, math.inf, 2.0**53 * 0.002])
def test_a_reading_larger_than_any_is_none(clock, absurd):
    sensor = PolledPosition(Laser(3.0, absurd, 3.1), RIG, HostClock(RIG, clock))
    for counts, quality in ((0, Quality.SUSPECT), (50, Quality.GOOD)):
        clock.now += 0.1
        (reading,) = sensor.since(1, 5)
        assert (reading.counts, reading.quality) == (1500 + counts, quality)


def test_a_simulated_device_runs_as_much_faster(clock):
    fast = ONE.model_copy(
        update={"simulator": load_rig("one_wire_serial").simulator.model_copy(update={"speed": 20.0})}
    )
    ticks = HostClock(fast, clock)
    clock.now += 1.0 + 1e-9
    assert ticks.tick() == 200, "20 s of the device in periods of 0.1 s"


def test_a_gap_keeps_the_last_position_marked_and_a_long_one_ends(clock):
    sensor = PolledPosition(Laser(3.0, math.nan), RIG, HostClock(RIG, clock))
    for tick in range(1, 21):
        clock.now = 5.0 + 0.1 * tick + 1e-6
        (reading,) = sensor.since(tick, 1)
        assert (reading.counts, reading.quality) == (1500, Quality.SUSPECT)
    clock.now += 0.1
    with pytest.raises(Garbled, match="no position for 2 s"):
        sensor.since(21, 1)


def test_no_position_at_the_start_is_one_sentence(clock):
    with pytest.raises(Garbled, match="laser gives no position. Check that its target is in range"):
        PolledPosition(Laser(math.nan), RIG, HostClock(RIG, clock))


def test_unit_and_resolution_must_fit_the_rig(clock):
    with pytest.raises(ConfigError, match=r"Give encoder\.resolution"):
        PolledPosition(Laser(3.0), ONE, HostClock(ONE, clock))
    turning = Laser(3.0)
    turning.unit = "deg"
    with pytest.raises(
        ConfigError, match="measures in deg, but the wire of rig 'bench_one_wire' moves in mm"
    ):
        PolledPosition(turning, RIG, HostClock(RIG, clock))


def test_the_room_is_that_of_a_thermometer_or_of_the_file(clock):
    class Room:
        identity = "room"

        def temperature_degC(self):
            return 19.5

        def close(self):
            pass

    sensor = PolledPosition(Laser(3.0), RIG, HostClock(RIG, clock), Room())
    clock.now += 0.1
    assert sensor.since(1, 1)[0].ambient_degC == 19.5


def test_another_opening_is_another_clock(clock):
    """So that a resumed run does not take its zero for the earlier one."""
    first, second = (PolledPosition(Laser(3.0), RIG, HostClock(RIG, clock)).identity for _ in range(2))
    assert first.startswith("laser, clock of the host since")
    assert first.split("since")[0] == second.split("since")[0]

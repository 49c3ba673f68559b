"""The thermometer of a room: what no room can have is suspect, and makes no limit higher."""

import math

import pytest

from rig.lying import TamperedRig
from smarig.config import load_rig
from smarig.core.errors import LimitExceeded
from smarig.core.sample import Quality
from smarig.plant import Actuator
from smarig.rig.guard import Guard
from smarig.rig.plausibility import Plausibility
from smarig.rig.room_temperature import RoomTemperature

FILE = load_rig("one_wire_twin")
HOT = FILE.limits.temperature_max_K + FILE.ambient_degC + 100  # a wire far above its limit
PER_MINUTE = round(60 / FILE.period_s)
IMPOSSIBLE = (5000.0, -400.0, 1e300, -1e300, math.inf, 500.0, FILE.ambient_degC + 31)


def after(readings, rig=FILE):
    room = RoomTemperature(rig)
    suspects = []
    for tick, reading in enumerate(readings):
        room.add(reading, tick)
        suspects.append(room.suspect)
    return room, suspects


@pytest.mark.parametrize("reading", [*IMPOSSIBLE, FILE.ambient_degC + 8, FILE.ambient_degC - 8])
def test_a_reading_that_no_room_can_have_is_suspect_and_makes_no_limit_higher(reading):
    room, suspects = after([21.0] * 10 + [reading] * 60 * PER_MINUTE)
    assert suspects[10]
    assert not any(suspects[:10])
    assert room.degC <= 21.0
    if reading > 21.0:
        assert all(suspects[10:])


@pytest.mark.parametrize("reading", IMPOSSIBLE)
def test_a_first_reading_that_no_room_can_have_leaves_the_room_of_the_file(reading):
    room, suspects = after([reading])
    assert (room.degC, suspects, room.known) == (FILE.ambient_degC, [True], False)


@pytest.mark.parametrize("minute_K", [3.0, -3.0])
def test_a_room_that_changes_as_rooms_do_is_followed(minute_K):
    start_degC = FILE.ambient_degC - 3 * minute_K
    ramp = [start_degC + minute_K * k / PER_MINUTE for k in range(6 * PER_MINUTE)]
    noisy = [x + (-1) ** k * 2.0 for k, x in enumerate(ramp)]
    room, suspects = after(noisy)
    assert not any(suspects)
    assert room.degC == pytest.approx(ramp[-1], abs=2.1)


def test_a_ramp_of_a_thermometer_that_fails_does_not_take_the_limit_along():
    room, suspects = after([21.0 + k for k in range(PER_MINUTE)])
    assert room.degC < 21.0 + 3.0
    assert suspects[-1]


def test_one_wrong_reading_and_none_leave_the_next_right():
    _, suspects = after([21.0, 50.0, 21.0, math.nan, 21.5, -7.0, 21.0])
    assert suspects == [False, True, False, False, False, True, False]


def test_a_chamber_has_a_rig_file_with_its_temperature():
    _, suspects = after([90.0, 90.5], FILE.model_copy(update={"ambient_degC": 85.0}))
    assert not any(suspects)


def guarded(readings, wire_degC=math.nan):
    """A guard whose thermometers of room and wire read what is given from tick 20 on."""

    def lie(s):
        return s._replace(ambient_degC=readings, temperature_degC=wire_degC) if s.tick >= 20 else s

    lying, actuator = TamperedRig("one_wire_twin", lie), Actuator.named(FILE.actuator)
    return Guard(lying, FILE.limits, actuator, Plausibility(FILE, actuator), room=RoomTemperature(FILE))


def heat(guard, ticks):
    return [sample for _ in range(ticks) for sample, _ in guard.step(0.1)]


@pytest.mark.parametrize("room_degC", [5000.0, 1e300, 500.0, 50.0, math.nan])
def test_a_wire_above_its_limit_trips_whatever_the_thermometer_of_the_room_reads(room_degC):
    guard = guarded(room_degC, HOT)
    with pytest.raises(
        LimitExceeded, match=r"is \d+\.\d K above ambient and exceeds the limit temperature_max_K"
    ):
        heat(guard, 30)


@pytest.mark.parametrize("room_degC", [5000.0, -400.0, 1e300])
def test_its_samples_are_suspect_and_the_user_is_warned_once_a_minute(room_degC):
    guard = guarded(room_degC)
    samples = heat(guard, PER_MINUTE + 30)
    assert all(bool(s.quality & Quality.SUSPECT) == (s.tick >= 20) for s in samples)
    assert {s.ambient_degC for s in samples if s.tick >= 20} == {room_degC}, "it is recorded as read"
    alarms = guard.alarms()
    assert [(a.level, a.kind) for a in alarms] == [("warning", "room")] * 2
    assert alarms[0].text.startswith(
        f"The thermometer of the room reads {room_degC:.4g} °C, which a room of 2"
    )
    assert "correct ambient_degC" in alarms[0].text
    guard.raise_if_tripped()

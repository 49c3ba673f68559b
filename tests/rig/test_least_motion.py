"""A reading that does not change by one count while every wire within the tolerance must have moved is frozen."""

import math
import random

import pytest

from rig.lying import TamperedRig
from smarig.config import load_rig
from smarig.core import Quality
from smarig.plant import Actuator
from smarig.preisach import Preisach, thesis_surface
from smarig.rig import Guard, Plausibility, Twin, TwinSettings
from smarig.rig.channel_checks import HARDWARE_TOLERANCE, RigReadings
from smarig.rig.least_motion import HELD, LeastMotion
from smarig.rig.wire_bounds import WireBounds

PERIOD_S = 0.1
HOT_TICKS, COOL_TICKS = 300, 700


def guarded(change, *, rig="one_wire_twin", noise=True):
    """A guard with the tolerance of hardware, of whose encoder nothing else is known."""
    file = load_rig(rig)
    limits = file.limits.model_copy(update={"model_tolerance": HARDWARE_TOLERANCE})
    file, actuator = file.model_copy(update={"limits": limits}), Actuator.named(file.actuator)
    lying = TamperedRig(rig, change)
    lying.twin = Twin(file, actuator, TwinSettings(noise=noise))
    readings = RigReadings(noise=False)
    return Guard(lying, limits, actuator, Plausibility(file, actuator, readings))


def driven(guard, *holds):
    """The marked samples of holds, given by current and ticks, until the guard trips; the alarms."""
    marked, alarms = [], []
    for current_A, ticks in holds:
        for _ in range(ticks):
            marked += [s.tick for s, _ in guard.step(current_A) if s.quality & Quality.SUSPECT]
            alarms += guard.alarms()
            if guard.tripped:
                return marked, alarms
    return marked, alarms


@pytest.mark.parametrize("jumps_by", [0, -10])
def test_a_sensor_that_sticks_on_a_hot_wire_is_seen_while_it_cools_for_the_first_time(jumps_by):
    stuck = []

    def change(s):
        if s.tick < HOT_TICKS - 50:
            return s
        stuck.append(s.counts)
        return s._replace(counts=stuck[0] + jumps_by)

    guard = guarded(change)
    marked, alarms = driven(guard, (0.8, HOT_TICKS), (0.0, COOL_TICKS))
    (fault,) = [alarm for alarm in alarms if alarm.level == "error"]
    assert fault.kind == "frozen"
    assert marked[-1] < HOT_TICKS + COOL_TICKS, "in its first cool-down"
    assert HOT_TICKS - 50 <= fault.doubtful_from < marked[-1], "since it stands, not since it is certain"


def test_wires_of_all_time_constants_are_not_one_group():
    """A slow wire and a fast one together hardly move in a loop; each of them does."""
    largest_A, ticks = 0.8, 350
    stuck = []

    def change(s):
        stuck.append(s.counts if s.tick < HOT_TICKS - 50 else stuck[-1])
        return s._replace(counts=stuck[-1])

    loop = [(largest_A * (1 - k / ticks), 1) for k in range(ticks)]
    marked, _ = driven(guarded(change), (largest_A, HOT_TICKS), *loop, *reversed(loop))
    assert marked[0] <= HOT_TICKS + ticks + HELD + 10, "with one group: 18 ticks later"


@pytest.mark.parametrize(("lag", "group"), [(0.4, 0), (0.9, 0), (1.1, 1), (2.5, 1)])
@pytest.mark.parametrize("factor", [0.72, 1.28])
def test_a_wire_lies_between_the_bounds_of_its_group(lag, group, factor):
    """Reversals within a beat, too."""
    tolerance, stroke = 0.3, 0.7
    surface, actuator = thesis_surface("one_e"), Actuator.named("gorbet_one_wire")
    wire = Preisach(surface, "negative")
    bounds = WireBounds(actuator, PERIOD_S, 1.0, tolerance, 22.0)
    dice, input_K, current_A, compared = random.Random(3), 0.0, 0.0, 0
    decay = math.exp(-PERIOD_S / (lag * actuator.tau_s))
    for k in range(2000):
        if k % 7 == 0:
            current_A = dice.uniform(0.0, 1.0)
        source_K = factor * actuator.input_for(current_A)
        input_K = source_K + (input_K - source_K) * decay
        y = stroke * (wire.step(input_K) - surface.y_lower)
        bounds.step(current_A)
        if bounds.positions is not None:
            groups = len(bounds.like_positions) // 2
            of_heat = 0 if factor < 1 else groups - 1
            low, high = bounds.like_positions[group * groups + of_heat]
            assert low <= y <= high
            compared += 1
    assert compared > 100


@pytest.mark.parametrize("rig", ["one_wire_twin", "two_wire_twin"])
def test_a_sound_sensor_without_any_noise_is_never_frozen(rig):
    """Small loops, which move the wire little or not at all, and rests."""
    guard = guarded(lambda s: s, rig=rig, noise=False)
    holds = [(current_A, 150) for current_A in (0.9, 0.85, 0.9, 0.6, 0.5, 0.55, 0.5, 0.3, 0.0, 0.1, 0.0)]
    assert driven(guard, *holds) == ([], [])


def test_a_reading_that_is_held_until_the_next_query_is_not_frozen():
    """It shows a moving wire with a delay."""
    for held, expected in ((HELD, False), (3 * HELD, True)):
        motion, unmoved = LeastMotion(margin=1.0), []
        for k in range(200):
            motion.add(k // held, [(k - 0.5, k + 0.5)], 1)
            unmoved.append(motion.unmoved)
        assert any(unmoved) == expected


def test_every_group_of_wires_must_have_moved():
    motion = LeastMotion(margin=1.0)
    for k in range(200):
        motion.add(0.0, [(k - 0.5, k + 0.5), (0.0, 0.5)], 1)
    assert not motion.unmoved

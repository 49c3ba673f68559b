"""Each channel is predicted up to one constant: what contradicts is marked, then trips; what a sound wire does is not.

``smarig benchmark plausibility`` has the whole table; here is a slice of it.
"""

import copy
import math
import random

import pytest

from benchmarks.plausibility import cell_of, channels, guarded, healthy, levels_A, one_hold
from smarig.config import load_rig
from smarig.core import Quality, Sample
from smarig.plant import Actuator
from smarig.plant.effects.dead_zone import dead_zone
from smarig.rig import TwinSettings
from smarig.rig.channel import FROZEN, ChannelCheck, Constant
from smarig.rig.channel_checks import ChannelChecks, RigReadings, tolerance_of
from smarig.rig.wire_bounds import WireBounds
from smarig.runner import Runner

PERIOD_S = 0.1
WIRE = Actuator.named("gorbet_one_wire")
FILE = load_rig("one_wire_twin")


def test_constants_that_agree_with_all_samples_are_kept_and_others_are_a_gap():
    constant = Constant()
    assert [constant.gap(0.0, 3.0), constant.gap(2.0, 5.0)] == [0.0, 0.0]
    assert (constant.low, constant.high) == (2.0, 3.0)
    assert constant.gap(3.5, 4.0) == 0.5
    assert constant.gap(-1.0, 1.0) == 1.0
    constant.widen(1.0)
    assert constant.gap(3.5, 4.0) == 0.0


def counter(**settings):
    return ChannelCheck(10.0, 4.0, PERIOD_S, counter=True, **settings)


def test_a_jump_larger_than_the_tolerance_is_certain_at_once_and_a_smaller_one_is_marked():
    for by, fault, suspect in ((20.0, "jump", True), (8.0, "", True), (3.0, "", False)):
        channel = counter()
        channel.add(0.0, None, 0.0, ticks=1, changes=False)
        channel.add(by, None, 0.0, ticks=1, changes=False)
        assert (channel.fault, channel.suspect) == (fault, suspect)


@pytest.mark.parametrize(
    ("readings", "suspect"),
    [
        (((0, 1), (5, 1), (20, 3), (25, 1)), False),  # taken at the end of three ticks
        (((0, 1), (5, 1), (10, 3), (25, 1)), False),  # taken at their beginning
        (((0, 1), (5, 1), (20, 3), (35, 1)), True),
        (((0, 1), (5, 1), (10, 1), (25, 1)), True),
    ],
)
def test_the_motion_while_a_reply_is_late_is_no_jump(readings, suspect):
    """The wire moves by 5 counts a tick at most; a step is 4."""
    channel, marked = ChannelCheck(100.0, 4.0, PERIOD_S), []
    for value, ticks in readings:
        channel.add(float(value), None, 5.0 * ticks, ticks=ticks, changes=True)
        marked.append(channel.suspect)
    assert any(marked) == suspect


@pytest.mark.parametrize(
    ("moving", "jump", "suspect"),
    [
        ((0, 2, 4, 6), 20, True),  # new at each query: it rests at 6, and then jumps
        ((0, 0, 0, 6), 20, False),  # repeats a reading until the next: it may have moved meanwhile
        ((0, 2, 4, 6), 7, False),
    ],
)
def test_what_gathers_while_a_reading_rests_counts_for_a_sensor_that_repeats_readings_only(
    moving, jump, suspect
):
    """The wire moves by 3 counts a tick at most; a step is 4."""
    channel = ChannelCheck(100.0, 4.0, PERIOD_S)
    for value in (*moving, *[6] * 10, 6 + jump):
        channel.add(float(value), None, 3.0, ticks=1, changes=True)
    assert channel.suspect == suspect


@pytest.mark.parametrize("absolute", [True, False])
def test_a_jump_of_an_absolute_sensor_leaves_the_readings_after_it_right(absolute):
    checks = ChannelChecks(FILE, WIRE, RigReadings(counter=False, absolute=absolute))
    alarms = []
    for tick, counts in enumerate((0, 0, 9, 0), start=1):
        checks.pass_ticks(0.0, 1)
        reading = Sample(tick, tick * PERIOD_S, 0.0, 0.0, 0.0, math.nan, counts, 0.0, 22.0, 0)
        alarms += checks.check(reading, 0.0)
    (jump,) = alarms
    assert jump.kind == "jump"
    assert ("from here on" in jump.text) != absolute
    assert ("This reading may be off by as much" in jump.text) == absolute


def test_a_single_wrong_reading_of_a_thermometer_is_no_fault():
    channel = ChannelCheck(10.0, 4.0, PERIOD_S)
    faults = []
    for k in range(100):
        channel.add(80.0 if k == 50 else 20.0, [(20.0, 20.0)], 0.0, ticks=1, changes=False)
        faults.append(channel.fault)
    assert set(faults) == {""}


def test_a_contradiction_must_hold_against_every_kind_of_wire():
    for kinds, expected in (([(50.0, 50.0)], "contradiction"), ([(50.0, 50.0), (0.0, 0.0)], "")):
        channel = counter(kinds=len(kinds))
        channel.add(0.0, [(0.0, 0.0)] * len(kinds), 0.0, ticks=1, changes=False)
        found = []
        for _ in range(100):
            channel.add(0.0, kinds, 0.0, ticks=1, changes=False)
            found.append(channel.fault)
        assert max(found) == expected


@pytest.mark.parametrize("known", [True, False])
def test_only_a_reading_of_known_noise_is_frozen_when_it_stands_still(known):
    """A real encoder may flicker at the edge of a count, and rest in the middle of one for hours."""
    dice = random.Random(1)
    channel = counter(flickers=known)
    for _ in range(300):
        channel.add(round(dice.gauss(0.0, 0.4)), None, 1.0, ticks=1, changes=True)
    assert not channel.suspect
    for _ in range(FROZEN + 50):
        channel.add(0.0, None, 1.0, ticks=1, changes=True)
    assert channel.suspect == known


def test_a_reading_that_stands_while_every_wire_moves_is_frozen():
    channel = counter()
    for k in range(100):
        channel.add(0.0, [(k - 30.0, k + 30.0)], 1.0, ticks=1, changes=True)
    assert channel.suspect


def test_a_reading_that_moves_against_every_wire_is_reversed():
    for sign, expected in ((-1.0, "reversed"), (1.0, "")):
        channel, found = counter(), []
        for k in range(60):
            channel.add(sign * k, [(k - 30.0, k + 30.0)], 1.0, ticks=1, changes=True)
            found.append(channel.fault)
        assert max(found) == expected


def test_a_reading_that_goes_on_for_a_moment_while_the_wire_turns_is_sound():
    """A slow sensor."""
    channel = counter()
    for k in range(60):
        wire = min(k, 60 - k)
        channel.add(min(k, 65 - k), [(wire - 30.0, wire + 30.0)], 2.0, ticks=1, changes=True)
        assert not channel.suspect


@pytest.mark.parametrize("factor", [0.91, 1.09])
@pytest.mark.parametrize("lag", [0.4, 2.5])
def test_a_wire_within_the_tolerance_lies_between_the_bounds(factor, lag):
    """Another heat, another time constant, reversals within a beat: the order of inputs is kept."""
    from smarig.preisach import Preisach, thesis_surface

    surface = thesis_surface("one_e")
    wire, bounds = Preisach(surface, "negative"), WireBounds(WIRE, PERIOD_S, 1.0, 0.1, 22.0)
    dice, input_K, current_A = random.Random(3), 0.0, 0.0
    decay = math.exp(-PERIOD_S / (lag * WIRE.tau_s))
    for k in range(3000):
        if k % 37 == 0:
            current_A = dice.uniform(0.0, 1.0)
        source_K = factor * WIRE.input_for(current_A)
        input_K = source_K + (input_K - source_K) * decay
        y = wire.step(input_K)
        bounds.step(current_A)
        if bounds.positions is not None:
            assert min(p[0] for p in bounds.positions) <= y <= max(p[1] for p in bounds.positions)


def test_the_tolerance_is_that_of_the_file_or_of_the_kind_of_rig():
    assert [tolerance_of(load_rig(n)) for n in ("one_wire_twin", "one_wire_serial", "bench_one_wire")] == [
        0.1,
        0.1,
        0.3,
    ]
    limits = FILE.limits.model_copy(update={"model_tolerance": 0.2})
    assert tolerance_of(FILE.model_copy(update={"limits": limits})) == 0.2


# --- a slice of the table ------------------------------------------------------------------------------------------

NOTICED = {  # channel, fault: seconds until it is marked at the latest, steps recorded as good with a false reading
    ("position", "stuck"): 40.0,
    ("position", "jumping by 50 counts"): 0.1,
    ("position", "wrong sign"): 15.0,
    ("position", "lost"): 1.0,
    ("position", "noisy"): 2.0,
    ("voltage", "lost"): 1.0,
    ("current", "wrong sign"): 1.0,
    ("thermometer", "stuck"): 70.0,
    ("thermometer", "lost"): 1.0,
}


@pytest.fixture(scope="module")
def warmed():
    """A guard before the second hold, and what follows."""
    guard, _ = guarded("one_wire_twin", TwinSettings(seed=1))
    levels = levels_A(WIRE, FILE)
    Runner(guard, 1.0, []).run(one_hold(levels[0], 150.0))
    return guard, levels[1:4]


@pytest.mark.parametrize(("channel", "fault"), NOTICED)
def test_a_fault_in_the_middle_of_a_motion_is_marked_in_time(warmed, channel, fault):
    guard, levels = warmed
    entry = channels(FILE, WIRE)[channel]
    cell = cell_of(copy.deepcopy(guard), levels, entry, entry.faults[fault])
    assert cell.caught_s <= NOTICED[channel, fault]
    if fault != "wrong sign":  # of the position: at the end of the hold
        assert cell.unseen <= (3 if (channel, fault) == ("thermometer", "stuck") else 1) * entry.tolerance
    assert cell.tripped_s < 250.0


@pytest.mark.long("takes three seconds")
def test_sound_wires_are_not_marked():
    found = healthy(("one_wire_twin",), 2, 1)
    assert (found["tripped"], found["marked"]) == ([], {})
    assert found["steps"] == 24


@pytest.mark.parametrize("rig", ["one_wire_twin", "two_wire_twin"])
def test_the_diodes_of_a_typical_source_are_no_fault(rig):
    """They take as much of the current as the read-back may differ, and the noise of a reading adds to it."""
    guard, _ = guarded(rig, TwinSettings(seed=1, effects=(dead_zone(),)))
    marked = 0
    for current_A in (0.06, 0.3, 0.9, 0.5, 0.04):
        for _ in range(300):
            marked += sum(bool(s.quality & Quality.SUSPECT) for s, _ in guard.step(current_A))
    assert (guard.tripped, marked) == ("", 0)

"""The contract of every rig: a suite over a function that makes rigs, ``make(seed)``."""

import math

import pytest

from smarig.core.errors import LeaseExpired, RigFault
from smarig.core.sample import Quality

BACKLOG = 50  # steps that may still contain earlier samples
TRAVEL = 300  # ticks: six time constants


def drive(rig, currents):
    """All samples of a sequence of currents."""
    return [sample for current in currents for sample in rig.step(current)]


def hold(rig, current, samples):
    """So many samples at a current."""
    found = []
    while len(found) < samples:
        found += rig.step(current)
    return found


def check_ticks_are_consecutive_integers(make):
    rig = make()
    samples = hold(rig, 0.3, 50)
    assert [s.tick for s in samples] == list(range(samples[0].tick, samples[0].tick + len(samples)))
    assert all(math.isclose(s.t_s, s.tick * rig.period_s) for s in samples)


def check_it_moves(make):
    rig = make()
    samples = hold(rig, 1.0, TRAVEL)
    travel = max(s.counts for s in samples) - min(s.counts for s in samples)
    assert travel > 80, "the excitation must move the wire"
    assert abs(samples[-1].position - samples[-1].counts * rig.position_per_count) < 1e-9


def check_what_was_set_is_what_flows(make):
    samples = drive(make(), [0.0] * 3 + [0.8] * 30 + [0.25] * 30)
    assert {s.current_command_A for s in samples} == {0.0, 0.8, 0.25}
    assert all(s.current_A == pytest.approx(s.current_command_A, abs=0.002) for s in samples)


def check_in_lock_step_ticks_begin_at_one_and_a_step_is_a_tick(make):
    asked = [0.0] * 3 + [0.8] * 3 + [0.25] * 3
    samples = drive(make(), asked)
    assert [s.tick for s in samples] == list(range(1, 10))
    for sample, current in zip(samples, asked, strict=True):  # it acts from the next tick on, and is measured
        assert sample.current_command_A == current
        assert sample.current_A == pytest.approx(current, abs=0.002)


def check_in_lock_step_the_same_seed_gives_the_same_samples(make):
    currents = [0.9] * 200 + [0.2] * 200
    first, again, other = (drive(make(seed), currents) for seed in (5, 5, 6))
    assert [s[:5] + s[6:] for s in first] == [s[:5] + s[6:] for s in again]  # no temperature: NaN is not NaN
    assert [s.counts for s in first] != [s.counts for s in other]


def check_safe_is_idempotent_and_zero_and_a_current_may_follow(make):
    rig = make()
    drive(rig, [0.8] * 10)
    rig.safe()
    rig.safe()
    assert drive(rig, [0.0])[-1].current_A == pytest.approx(0.0, abs=0.002)
    assert drive(rig, [0.4])[-1].current_A == pytest.approx(0.4, abs=0.002)


def check_silence_trips_the_lease_and_latches(make):
    rig = make()
    drive(rig, [0.8] * 10)
    rig.idle(rig.file.lease_s - 0.1)
    assert drive(rig, [0.8])[-1].current_A == pytest.approx(0.8, abs=0.002)
    rig.idle(rig.file.lease_s + 0.2)
    with pytest.raises(LeaseExpired, match=r"(?i)no (command|valid request) from the host"):
        drive(rig, [0.8] * BACKLOG)
    with pytest.raises(LeaseExpired):
        rig.step(0.8)
    rig.arm()
    observed = drive(rig, [0.1] * BACKLOG)[-1]
    assert observed.current_A == pytest.approx(0.1, abs=0.002)
    assert not observed.quality & Quality.TRIPPED


def check_zero_makes_here_the_origin(make):
    rig = make()
    hold(rig, 1.0, TRAVEL)
    rig.zero()
    assert abs(drive(rig, [1.0])[-1].counts) <= 3


def check_what_is_beyond_the_amplifier_is_refused_or_marked(make):
    rig = make()
    try:
        sample = drive(rig, [1.7])[0]
    except RigFault:
        sample = drive(rig, [0.0])[0]
        assert abs(sample.current_A) < 0.002
    else:
        assert sample.quality & Quality.SATURATED
        assert abs(sample.current_A) < 1.01


def check_alarms_are_reported_once_and_closing_is_harmless(make):
    rig = make()
    drive(rig, [0.5] * 20)
    rig.alarms()
    assert rig.alarms() == []
    rig.safe()
    rig.close()
    rig.close()


CHECKS = [value for name, value in sorted(globals().items()) if name.startswith("check_")]
IN_REAL_TIME = [check for check in CHECKS if not check.__name__.startswith("check_in_lock_step_")]

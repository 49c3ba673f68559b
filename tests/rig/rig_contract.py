"""What every rig must do, as a suite over a maker of rigs: today the twins, later the benches."""

import math

import pytest

from smarig.errors import LeaseExpired
from smarig.rig.twin import Twin

MAKERS = {
    "one_wire_twin": lambda seed=0: Twin.named("one_wire_twin", seed=seed),
    "two_wire_twin": lambda seed=0: Twin.named("two_wire_twin", seed=seed),
}


def drive(rig, currents):
    """All samples of a sequence of currents."""
    return [sample for current in currents for sample in rig.step(current)]


def check_ticks_are_consecutive_integers(make):
    samples = drive(make(), [0.3] * 50)
    assert [s.tick for s in samples] == list(range(1, 51))
    assert all(math.isclose(s.t_s, s.tick * 0.1) for s in samples)


def check_it_moves(make):
    rig = make()
    samples = drive(rig, [1.0] * 600)
    travel = max(s.counts for s in samples) - min(s.counts for s in samples)
    assert travel > 80, "the excitation must move the wire"


def check_same_seed_same_counts(make):
    currents = [0.9] * 200 + [0.2] * 200
    first, again, other = (drive(make(seed), currents) for seed in (5, 5, 6))
    assert first == again or [s[:5] + s[6:] for s in first] == [s[:5] + s[6:] for s in again]
    assert [s.counts for s in first] != [s.counts for s in other]


def check_safe_is_idempotent_and_zero(make):
    rig = make()
    drive(rig, [0.8] * 10)
    rig.safe()
    rig.safe()
    assert rig.output_A == 0.0


def check_silence_trips_the_lease_and_latches(make):
    rig = make()
    drive(rig, [0.8] * 10)
    rig.idle(rig.file.lease_s - 0.1)
    assert rig.output_A == 0.8
    rig.idle(rig.file.lease_s + 0.1)
    assert rig.output_A == 0.0
    with pytest.raises(LeaseExpired, match="nothing was heard"):
        rig.step(0.8)
    rig.arm()
    assert rig.step(0.1)[0].current_command_A == 0.1


def check_zero_makes_here_the_origin(make):
    rig = make()
    drive(rig, [1.0] * 600)
    rig.zero()
    assert abs(drive(rig, [1.0])[0].counts) <= 3


def check_saturation_is_marked(make):
    sample = drive(make(), [1.7])[0]
    assert sample.quality & 4
    assert abs(sample.current_A) < 1.01


CHECKS = [value for name, value in sorted(globals().items()) if name.startswith("check_")]

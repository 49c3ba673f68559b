"""Limits on the host: current, rate and predicted temperature are refused or trip, and the rig ends at zero."""

import math

import pytest

from smarig.core.command import Elapsed, Hold
from smarig.core.errors import LimitExceeded
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner


def guarded(**limits):
    twin = Twin.named("one_wire_twin", noise=False)
    return twin, Guard(twin, twin.file.limits.model_copy(update=limits), twin.actuator)


def generator(*commands):
    yield from commands


@pytest.mark.parametrize(
    ("limits", "current_A", "message"),
    [
        ({}, 1.2, r"outside the limits 0…1 A: it is above limits\.current_max_A\."),
        ({}, -0.1, r"it is below limits\.current_min_A\."),
        ({"current_rate_A_per_s": 1.0}, 0.5, "A/s"),
    ],
)
def test_a_forbidden_command_never_reaches_the_rig(limits, current_A, message):
    twin, guard = guarded(**limits)
    with pytest.raises(LimitExceeded, match=message):
        Runner(guard, 1.0, []).run(generator(Hold(current_A, Elapsed(1))))
    assert twin.tick == 0
    assert twin.output_A == 0.0


def test_a_source_without_a_measured_current_trips_and_is_told_what_to_do(monkeypatch):
    twin, guard = guarded()
    step = twin.step
    monkeypatch.setattr(twin, "step", lambda *given: [s._replace(current_A=math.nan) for s in step(*given)])
    with pytest.raises(LimitExceeded, match="reads nan A.*put a shunt into the circuit.*at zero"):
        Runner(guard, 1.0, []).run(generator(Hold(0.02, Elapsed(1))))
    assert twin.output_A == 0.0


def test_predicted_temperature_trips_to_zero_and_the_samples_that_show_it_are_kept():
    twin, guard = guarded(temperature_max_K=100.0)
    observed = []
    watch = CallbackListener(on_sample=lambda s, step, input_K: observed.append(input_K))
    with pytest.raises(LimitExceeded, match=r"temperature_max_K = 100"):
        Runner(guard, 1.0, [watch]).run(generator(Hold(1.0, Elapsed(60))))
    assert twin.output_A == 0.0
    assert observed[-1] > 100 > observed[-2]
    with pytest.raises(LimitExceeded):
        guard.step(0.0)


def test_a_guard_that_starts_hot_trips_when_a_hot_wire_would():
    """A cold start would let a current heat a wire of 95 K for four seconds more before it exceeds 100 K."""
    _, cold = guarded(temperature_max_K=100.0)
    _, hot = guarded(temperature_max_K=100.0)
    hot.start_hot((95.0, 0.0))
    for _ in range(5):
        for guard in (cold, hot):
            if not guard.tripped:
                guard.step(1.0)
    assert "exceeds the limit temperature_max_K = 100" in hot.tripped
    assert not cold.tripped


def test_a_start_above_the_limit_allows_the_zero_current_and_nothing_that_heats():
    for current_A, tripped in ((0.0, False), (0.5, False), (1.0, True)):
        _, guard = guarded(temperature_max_K=100.0)
        guard.start_hot((250.0, 0.0))
        guard.step(current_A)
        assert bool(guard.tripped) is tripped, current_A


def test_a_guard_that_has_stepped_knows_better_than_any_assumption():
    _, guard = guarded()
    guard.start_hot((50.0, 0.0))
    guard.start_hot((30.0, 0.0))
    assert guard.input_K == 50.0, "the hottest of what is known"
    guard.step(0.0)
    guard.start_hot((150.0, 0.0))
    assert guard.input_K < 50.0


def test_each_wire_of_the_differential_rig_is_watched():
    twin = Twin.named("two_wire_twin", noise=False)
    guard = Guard(twin, twin.file.limits.model_copy(update={"temperature_max_K": 100.0}), twin.actuator)
    with pytest.raises(LimitExceeded):
        Runner(guard, 1.0, []).run(generator(Hold(-1.0, Elapsed(60))))

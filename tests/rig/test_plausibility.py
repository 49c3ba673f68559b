"""Implausible readings trip; plausible readings of every twin and every protocol do not."""

import math
import re
from contextlib import nullcontext

import pytest

from rig.lying import TamperedRig
from smarig.config import load_rig
from smarig.core.errors import LimitExceeded
from smarig.core.sample import Quality
from smarig.plant import Actuator, JouleHeating
from smarig.rig.channel_checks import RigReadings
from smarig.rig.guard import Guard
from smarig.rig.plausibility import MAX_STALE_SAMPLES, REST_TAUS, Plausibility

TICKS_OF_HEATING = 500
TWINS = (
    "one_wire_twin",
    "two_wire_twin",
    "one_wire_thermomechanical",
    "two_wire_thermomechanical",
    "flexinol_031",
)


def guarded(change, rig="one_wire_twin"):
    lying = TamperedRig(rig, change)
    actuator = Actuator.named(lying.file.actuator)
    file = lying.file.model_copy(update={"kind": "bench"})  # with a bench's tolerance
    return Guard(lying, file.limits, actuator, Plausibility(file, actuator)), lying.twin


def heated(guard, ticks=TICKS_OF_HEATING, current_A=0.9):
    for _ in range(ticks):
        guard.step(current_A)


def from_tick(tick, **changes):
    return lambda s: s._replace(**{k: f(getattr(s, k)) for k, f in changes.items()}) if s.tick >= tick else s


LIES = [
    ("read_back", from_tick(50, current_A=lambda x: x * 0.8), "is set. Check amplifier and shunt"),
    ("voltage", from_tick(50, voltage_V=lambda x: 5 * x), "which no allowed current needs"),
    (
        "resistance",
        from_tick(50, voltage_V=lambda x: 1.2 * x),
        "ohm is outside .*, its limits at a predicted input of ",
    ),
    ("resistance", from_tick(50, voltage_V=lambda x: 0.1 * x), "correct the resistances in the"),
    ("jump", lambda s: s._replace(counts=s.counts + 120) if s.tick == 60 else s, "jumped by 1"),
    ("still", from_tick(0, counts=lambda _: 3), "fully heated and did not move"),
    ("voltage", from_tick(50, voltage_V=lambda _: float("nan")), "The voltage is not measured any more"),
]


@pytest.mark.parametrize(("kind", "lie", "words"), LIES, ids=[f"{k}{n}" for n, (k, *_) in enumerate(LIES)])
def test_what_cannot_be_trips_to_zero_with_its_cause(kind, lie, words):
    guard, twin = guarded(lie)
    with pytest.raises(LimitExceeded, match=words):
        heated(guard)
    assert twin.output_A == 0.0
    assert [a.kind for a in guard.alarms() if a.level == "error"] == [kind]


@pytest.mark.parametrize(("factor", "trips"), [(1.2, False), (1.6, True), (1000, True)])
def test_a_wire_of_unknown_temperature_moves_no_further_than_its_stroke(factor, trips):
    """Where the host makes the ticks, nobody knows how hot the wire was: in the first 12 time constants."""
    lying = TamperedRig("one_wire_twin", lambda s: s._replace(counts=round(factor * s.counts)))
    actuator, file = Actuator.named(lying.file.actuator), lying.file.model_copy(update={"kind": "bench"})
    checks = Plausibility(file, actuator, RigReadings(counter=False))
    guard = Guard(lying, file.limits, actuator, checks)
    with pytest.raises(LimitExceeded, match="the whole stroke of the wire is 2") if trips else nullcontext():
        heated(guard, round(REST_TAUS * actuator.tau_s / file.period_s) - 1, current_A=1.0)
    assert (lying.twin.output_A == 0.0) == trips
    assert [a.kind for a in guard.alarms() if a.level == "error"] == ["contradiction"] * trips


@pytest.mark.parametrize("rig", TWINS)
@pytest.mark.parametrize("current_A", [math.nan, math.inf, -math.inf, 1e200])
def test_a_late_current_that_is_no_number_trips_with_its_own_sentence(rig, current_A):
    """Seven ticks late, so that the bounds of the position are computed; the next sample of the block is right."""

    def late(s):
        return s._replace(tick=7 * s.tick, current_A=current_A if s.tick == 40 else s.current_A)

    guard, twin = guarded(late, rig)
    guard.rig.step = lambda command_A, _: (late(twin.step(command_A)[0]), late(twin.step(command_A)[0]))
    samples = [s for _ in range(20) for s, _ in guard.step(0.0)]
    assert [s.quality for s in samples if s.tick == 280] == [Quality.SUSPECT]
    with pytest.raises(
        LimitExceeded, match=f"^The measured current reads {re.escape(str(current_A))} A"
    ) as trip:
        guard.step(0.0)
    assert ("put a shunt into the circuit" in str(trip.value)) == math.isnan(current_A)


def test_a_source_that_never_measures_a_voltage_is_a_warning_once():
    guard, _ = guarded(from_tick(0, voltage_V=lambda _: float("nan")))
    heated(guard, 200)
    (warning,) = guard.alarms()
    assert (warning.level, warning.kind) == ("warning", "voltage")
    assert "an ohmmeter: 4.05 to 5.50 ohm" in warning.text


def test_a_hot_start_that_was_only_assumed_is_no_reason_to_trip():
    """The wire is cold and does not move while the prediction cools; once that is forgotten, a still encoder trips."""
    guard, _ = guarded(from_tick(1000, counts=lambda _: 3))
    guard.start_hot((174.0, 0.0))
    heated(guard, 999, 0.0)
    assert not guard.tripped
    assert guard.input_K < 1e-3
    with pytest.raises(LimitExceeded, match="stays the same to the last digit"):
        heated(guard)


def test_an_encoder_that_sticks_on_a_hot_wire_trips_as_it_cools():
    observed = []

    def sticking(s):
        observed.append(s.counts)
        return s._replace(counts=observed[1200]) if s.tick > 1200 else s

    guard, twin = guarded(sticking)
    heated(guard, 1300, 1.0)
    with pytest.raises(LimitExceeded, match="fully cooled and did not move"):
        heated(guard, 900, 0.0)
    assert twin.output_A == 0.0


def test_motion_without_heating_trips():
    guard, twin = guarded(lambda s: s._replace(counts=s.counts + max(0, s.tick - 1300) // 5))
    with pytest.raises(LimitExceeded, match="without heating"):
        heated(guard, 1900)
    assert twin.output_A == 0.0


@pytest.mark.parametrize("lie", [LIES[0][1], LIES[2][1], LIES[4][1]])
def test_one_or_two_samples_do_not_trip_and_stale_ones_do_not_count(lie):
    few = guarded(lambda s: lie(s) if 60 <= s.tick < 62 and lie is not LIES[4][1] else s)[0]
    stale = guarded(
        lambda s: lie(s)._replace(quality=int(Quality.STALE)) if s.tick % MAX_STALE_SAMPLES else s
    )[0]
    heated(few)
    heated(stale)


def test_an_amplifier_that_measures_nothing_trips():
    """Its last reading is repeated, so the actual current is unknown."""
    guard, twin = guarded(
        lambda s: s._replace(current_A=0.0, quality=int(Quality.STALE)) if s.tick > 50 else s
    )
    with pytest.raises(LimitExceeded, match="returned no current reading for 20 samples"):
        heated(guard)
    assert twin.output_A == 0.0
    assert twin.tick <= 50 + MAX_STALE_SAMPLES + 1


def test_a_current_that_is_not_measured_heats_as_it_was_set():
    blind, _ = guarded(lambda s: s._replace(current_A=0.0, quality=int(Quality.STALE)) if s.tick > 50 else s)
    seeing, _ = guarded(lambda s: s)
    for guard in (blind, seeing):
        for _ in range(50 + MAX_STALE_SAMPLES - 1):
            guard.step(0.5)
    assert blind.input_K == pytest.approx(seeing.input_K, rel=0.01)


def test_a_wire_that_was_hot_before_we_came_may_cool():
    """Devices live on when a host dies; the next one does not know how warm the wire is."""
    lying = TamperedRig("one_wire_twin", lambda s: s)
    for _ in range(400):
        lying.step(0.9)
    actuator = Actuator.named(lying.file.actuator)
    guard = Guard(lying, lying.file.limits, actuator, Plausibility(lying.file, actuator))
    heated(guard, 900, 0.0)
    assert guard.alarms() == []


def test_zeroing_the_encoder_is_no_jump():
    guard, _ = guarded(lambda s: s)
    heated(guard)
    guard.zero()
    heated(guard, 50, 0.0)


@pytest.mark.parametrize("rig", TWINS)
def test_a_wire_driven_to_its_limits_and_back_is_plausible(rig):
    limits = load_rig(rig).limits
    guard, _ = guarded(lambda s: s, rig)
    for current_A in (limits.current_max_A, 0.0, limits.current_min_A, 0.5 * limits.current_max_A, 0.0):
        heated(guard, 600, current_A)
    assert guard.alarms() == []


def test_lost_samples_have_heated_the_wire_all_the_same():
    whole, _ = guarded(lambda s: s)
    heated(whole, 30)

    class Loses(TamperedRig):
        def step(self, current_A, at_most=1):
            return [super(Loses, self).step(current_A, at_most) for _ in range(3)][-1]

    lying = Loses("one_wire_twin", lambda s: s)
    few = Guard(lying, lying.file.limits, Actuator.named(lying.file.actuator))
    heated(few, 10)
    assert few.input_K == pytest.approx(whole.input_K, rel=1e-3)


# --- samples that contradict themselves -------------------------------------------------------------------------


def marks_of(change, ticks, current_A=0.9):
    """The ticks whose samples the guard marks as suspect, until it trips."""
    guard, _ = guarded(change)
    found = []
    try:
        for _ in range(ticks):
            found += [s.tick for s, _ in guard.step(current_A) if s.quality & Quality.SUSPECT]
    except LimitExceeded:
        pass
    return found


@pytest.mark.parametrize(
    "lie", [LIES[0][1], LIES[1][1], LIES[2][1]], ids=["read_back", "voltage", "resistance"]
)
def test_implausible_samples_are_marked_from_the_first_on(lie):
    found = marks_of(lie, 200)
    assert found[0] == 50
    assert found in ([50, 51], [50, 51, 52])


def test_the_sample_of_a_jump_is_marked():
    assert marks_of(LIES[4][1], 100) == [60]


@pytest.mark.parametrize("gap", [5, 11, 40])
@pytest.mark.parametrize("first", range(10, 60, 5))
def test_motion_during_lost_samples_is_no_jump(first, gap):
    """A host that pauses while the wire heats at its fastest; the samples of that time are lost."""
    guard, twin = guarded(lambda s: s)
    heated(guard, first, 1.0)
    for _ in range(gap):
        twin.step(1.0)
    heated(guard, 60, 1.0)
    assert [a for a in guard.alarms() if a.kind == "jump"] == []


def test_a_jump_during_lost_samples_is_one():
    guard, twin = guarded(lambda s: s._replace(counts=s.counts + 200 * (s.tick > 60)))
    heated(guard, 60, 0.9)
    for _ in range(4):
        twin.step(0.9)
    with pytest.raises(LimitExceeded, match=r"jumped by 2\d\d counts in 5 ticks"):
        heated(guard, 2, 0.9)


@pytest.mark.parametrize("rig", TWINS)
def test_good_samples_are_not_marked(rig):
    limits = load_rig(rig).limits
    guard, _ = guarded(lambda s: s, rig)
    for current_A in (limits.current_max_A, 0.0, limits.current_min_A, 0.06, 0.0):
        for _ in range(400):
            assert not any(s.quality & Quality.SUSPECT for s, _ in guard.step(current_A))


@pytest.mark.parametrize(("factor", "trips"), [(0.7, False), (1.2, True), (-0.5, True)])
def test_saturation_explains_too_little_current_and_never_more(factor, trips):
    """The voltage follows the current, so that only the read-back can tell."""

    def change(s):
        flows = {"current_A": s.current_A * factor, "voltage_V": s.voltage_V * factor}
        return s._replace(**flows, quality=int(Quality.SATURATED)) if s.tick > 50 else s

    found = marks_of(change, 80)
    assert bool(found) == trips


# --- a thermometer on the wire ----------------------------------------------------------------------------------


def thermometer(temperature_of):
    """Samples with a measured wire temperature, from tick and heating model."""
    model = JouleHeating(Actuator.named("gorbet_one_wire"), 0.1)

    def change(s):
        return s._replace(temperature_degC=s.ambient_degC + temperature_of(s.tick, model.step(s.current_A)))

    return change


def test_a_thermometer_that_follows_is_plausible():
    guard, _ = guarded(thermometer(lambda _, predicted_K: 0.9 * predicted_K + 3.0))
    heated(guard, 800)
    assert guard.alarms() == []


def test_a_thermometer_that_does_not_rise_trips():
    guard, twin = guarded(thermometer(lambda _, __: 0.0))
    with pytest.raises(
        LimitExceeded, match="The thermometer (is .* K away from all that a wire|stays the same)"
    ):
        heated(guard, 800)
    assert twin.output_A == 0.0


def test_a_measured_temperature_above_the_limit_trips_at_once():
    guard, twin = guarded(thermometer(lambda tick, predicted_K: 185.5 if tick == 300 else predicted_K))
    with pytest.raises(LimitExceeded, match=r"207.5 °C is 185.5 K above ambient and exceeds the limit"):
        heated(guard, 302)
    assert (twin.tick, twin.output_A) == (300, 0.0)


@pytest.mark.parametrize(("factor", "samples"), [(1.2, 3), (1.9, 2)])
def test_a_gross_excess_trips_at_its_second_sample(factor, samples):
    assert len(marks_of(from_tick(500, voltage_V=lambda x: factor * x), 600)) == samples


def test_the_resistance_of_a_twin_may_be_changed_by_its_effects():
    lying = TamperedRig("one_wire_twin", from_tick(0, voltage_V=lambda x: 1.2 * x))
    actuator = Actuator.named(lying.file.actuator)
    guard = Guard(lying, lying.file.limits, actuator, Plausibility(lying.file, actuator))
    heated(guard, 300)
    assert guard.alarms() == []

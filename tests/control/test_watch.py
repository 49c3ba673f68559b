"""When a closed loop must end: it oscillates, cannot reach the reference, or has implausible readings; and
when not."""

import math

import numpy as np
import pytest

from smarig.control.divergence_monitor import DivergenceLimits, DivergenceMonitor
from smarig.control.regulation import SetpointPI, regulate
from smarig.control.regulation.sensor_plausibility import SensorPlausibility
from smarig.core.errors import LimitExceeded, UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.protocols._setup import Setup
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener as Listener
from smarig.runner.runner import Runner

SETUP, H = Setup.of("one_wire_twin"), thesis_surface("one_e")


def looked(errors, seconds=30.0):
    """The time at which a watch gives up, None where it does not; ten samples a second, a reach of 12.5."""
    divergence_monitor = DivergenceMonitor(DivergenceLimits(0.3, seconds), (0.0, 12.5))
    for tick, error in enumerate(errors):
        try:
            divergence_monitor.check(0.1 * tick, error)
        except LimitExceeded:
            return 0.1 * tick
    return None


TIMES = np.arange(0.0, 600.0, 0.1)


@pytest.mark.parametrize(
    "errors",
    [
        np.full(6000, 5.0),
        12.5 * np.sin(2 * np.pi * TIMES / 5.0),
        12.5 * np.sign(np.sin(2 * np.pi * TIMES / 0.4)),
        np.full(6000, np.nan),
        4.0 + 0.01 * TIMES,
    ],
    ids=["stands", "swings", "rattles", "no number", "leaves"],
)
def test_large_errors_that_do_not_shrink_end_a_loop(errors):
    assert looked(errors) == pytest.approx(30.0, abs=1.0)


@pytest.mark.parametrize(
    "errors",
    [
        np.full(6000, 3.7),
        12.5 * np.exp(-TIMES / 25.0),
        np.where(TIMES % 60.0 < 15.0, 10.0, 0.0),
        np.where(TIMES < 20.0, np.nan, 0.0),
    ],
    ids=["small", "comes", "steps", "was away"],
)
def test_a_loop_that_holds_or_comes_is_left_alone(errors):
    assert looked(errors) is None


def sensed(sources, position, *, rest=40.0, wanted=6.0):
    """Feed a monitor that starts on the rising branch at ``rest``; returns its message, or nothing."""
    operator = Preisach(H, "negative")
    operator.step(rest)
    sensor_plausibility = SensorPlausibility(SETUP, H, operator.state)
    wire = rest
    for source in sources:
        wire += (source - wire) * -math.expm1(-SETUP.period_s / SETUP.tau_s)
        operator.step(wire)
        read = position(operator.y)
        try:
            sensor_plausibility.check(source, read, wanted - read)
        except LimitExceeded as error:
            return str(error)
    return ""


def test_a_source_that_drifts_while_the_encoder_stands_is_detected():
    drifting = np.linspace(40.0, 100.0, 8000)
    assert "Check the encoder" in sensed(drifting, lambda _: 6.02)
    assert not sensed(drifting, lambda y: 0.5 * y), "a wire that moves half as far as the model says"


def test_a_room_that_warms_is_no_stuck_encoder():
    """The loop takes ten kelvin out of the source, and the position rightly stays."""
    assert not sensed(np.linspace(40.0, 30.0, 8000), lambda _: 6.0)


def test_a_set_point_out_of_reach_is_reported_when_the_source_has_been_at_its_limit():
    n = round(14 * SETUP.tau_s / SETUP.period_s)
    assert "set-point is unreachable" in sensed(np.full(n, SETUP.upper_K), lambda y: y)
    assert not sensed(np.full(n // 3, SETUP.upper_K), lambda y: y)
    top = H.y_upper - 0.2
    assert not sensed(np.full(n, SETUP.upper_K), lambda y: y, rest=140.0, wanted=top), (
        "at the limit, and there"
    )


class Frozen(Twin):
    """A twin whose encoder stands still, off by some counts, from a tick on."""

    frozen = 4500, 0

    def step(self, current_A, at_most=1):
        (sample,) = super().step(current_A, at_most)
        at, off = self.frozen
        if sample.tick == at:
            self.held = sample.counts + off
        if sample.tick < at:
            return (sample,)
        return (sample._replace(counts=self.held, position=self.held * self.position_per_count),)


@pytest.mark.long("takes a second")
def test_an_encoder_that_freezes_off_the_set_point_does_not_heat_without_end():
    plain = Twin.named("one_wire_twin", seed=2)
    twin = Frozen(plain.file, plain.actuator, plain.settings)
    twin.frozen = 4500, -6
    runner = Runner(Guard(twin, twin.file.limits, twin.actuator), twin.position_per_count, [])
    with pytest.raises(LimitExceeded, match="Check the encoder"):
        runner.run(regulate(SETUP, hysteresis=H, setpoint=6.0, hold_s=7200.0))
    assert twin.output_A == 0.0
    assert twin.specimen.plant.hysteresis_input_K < 100.0


def test_noise_about_a_set_point_is_not_summed_into_a_drift():
    """A gain at which every reading throws the source from end to end: the mean stays, and the wire with it."""
    rng, loop = np.random.default_rng(3), SetpointPI(3000.0, SETUP.tau_s, SETUP.period_s, 0.0, 174.0)
    loop.start(40.0)
    sources = [loop.step(0.05 * e) for e in rng.normal(size=20_000)]
    assert np.ptp(sources) == 174.0
    assert np.mean(sources) == pytest.approx(87.0, abs=3.0), "half of the time at either end"


@pytest.mark.parametrize("start", ["diagonal", "ascending", "descending"])
def test_limits_short_of_saturation_are_refused(start):
    setup = Setup.of("two_wire_twin")
    limits = setup.limits.model_copy(update={"current_min_A": -0.8, "current_max_A": 0.8})
    short = Setup(setup.actuator, limits, setup.period_s)
    with pytest.raises(
        UsageError, match=r"starts in negative saturation, at -185 K. This rig's limits reach"
    ):
        next(regulate(short, hysteresis=thesis_surface("two_e"), setpoint=1.0, start=start))


class Hot:
    """Asks for all there is."""

    def start(self, source_K):
        pass

    def step(self, error):
        return SETUP.upper_K


def test_the_current_ramps_to_zero_within_the_rate_limit():
    """The current at the end of a hold is the loop's, not the preview's: no step to zero may trip."""
    limits = SETUP.limits.model_copy(update={"current_rate_A_per_s": 6.0})
    slow, twin = Setup(SETUP.actuator, limits, SETUP.period_s), Twin.named("one_wire_twin", seed=2)
    flowed = []
    listener = Listener(on_sample=lambda s, *_: flowed.append(s.current_command_A))
    runner = Runner(Guard(twin, limits, twin.actuator), twin.position_per_count, [listener])
    runner.run(regulate(slow, hysteresis=H, setpoint=6.0, start="ascending", hold_s=1.0, loop=Hot()))
    assert max(flowed) == pytest.approx(1.0)
    assert twin.output_A == 0.0

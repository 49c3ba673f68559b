"""Closed loops on the twin: they track, keep the limits for any command, and end at zero current if they
diverge."""

import math

import numpy as np
import pytest

from benchmarks.tracking import controller_model, perturbed_surface, simulate_loop
from smarig.control.controller_settings import TRACKING_CONTROLLERS
from smarig.control.divergence_monitor import DivergenceLimits
from smarig.control.tracking import ControllerModel, Reference, reference, track
from smarig.control.tracking.heating_lag import current_towards, source_towards
from smarig.control.tracking.slope_observer import SlopeObserver
from smarig.control.tracking.tuning import controller_factory, default_settings, ranges, tuned_numbers
from smarig.core.catalogue import catalogue_names
from smarig.core.command import Drive, Mark
from smarig.core.errors import LimitExceeded
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin, TwinSettings
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

CONTROLLERS = catalogue_names(TRACKING_CONTROLLERS)
COUNT_mm = Actuator.named("gorbet_one_wire").position_per_count(2000)


def driven(protocol, limits=None, twin=None):
    """Currents that a protocol made flow on a twin, and the error that ended it."""
    twin = twin or Twin.named("one_wire_twin", seed=3)
    limits = twin.file.limits.model_copy(update=limits or {})
    flowed, ended = [], None
    guard = Guard(twin, limits, twin.actuator)
    try:
        Runner(
            guard, COUNT_mm, [CallbackListener(on_sample=lambda s, *_: flowed.append(s.current_command_A))]
        ).run(protocol)
    except LimitExceeded as error:
        ended = error
    assert twin.output_A == 0.0
    return np.array(flowed), ended


@pytest.mark.parametrize("name", CONTROLLERS)
def test_every_controller_follows_a_wire_its_model_is_wrong_about(name):
    follow = reference("ramps", 2.0, 8.0, seconds=90.0, seed=4)
    loop = simulate_loop(
        controller_model(), name, default_settings(name), perturbed_surface(4), follow, seed=4
    )
    assert not loop.fault
    assert np.ptp(follow.position) > 2.0, "the reference moves"
    assert loop.true.rms < 1.0 * COUNT_mm
    assert loop.peak_A <= 1.001  # a reading's noise


@pytest.mark.long("takes a second")
def test_the_inverse_halves_the_error_of_plain_feedback_or_nearly():
    """Means over wires: the whole comparison is ``smarig benchmark tracking``."""

    def error(name):
        follow = [reference("multisine", 2.0, 8.0, seconds=100.0, seed=seed) for seed in (1, 2, 3)]
        loops = [
            simulate_loop(controller_model(), name, default_settings(name), perturbed_surface(s), f, s)
            for s, f in zip((1, 2, 3), follow)
        ]
        return np.mean([loop.true.rms for loop in loops])

    inverse = error("inverse")
    assert error("pi") > 1.3 * inverse
    assert error("gain_scheduled") > 1.3 * inverse


@pytest.mark.parametrize(
    ("effect", "times"),
    [
        ("backlash", 1.0),
        ("latent_heat", 1.05),
        ("wire_lag", 1.1),
        ("convection", 1.2),
        ("amplifier_gain", 1.5),
        ("dead_zone", 4.0),
    ],
)
def test_a_modelled_effect_in_the_feed_forward_reduces_the_error(effect, times):
    """Whatever an effect changes: the output, the lag, the heat of a current, the current of a command."""
    planted = effects_from_pairs([effect])
    follow = reference("multisine", 2.0, 8.0, seconds=100.0, seed=2)
    plain, with_effects_model = controller_model(), controller_model().with_effects(planted)
    hidden, there = (
        simulate_loop(
            k, "inverse", default_settings("inverse"), plain.hysteresis, follow, 2, planted
        ).true.rms
        for k in (plain, with_effects_model)
    )
    assert hidden > times * there


def test_the_wire_it_is_tuned_on_and_the_one_it_meets_differ_by_a_tenth_of_the_range():
    nominal, other = controller_model().hysteresis, perturbed_surface(7)
    levels = np.linspace(0.0, nominal.upper, 25)
    alpha, beta = np.meshgrid(levels, levels, indexing="ij")
    inside = beta <= alpha
    off = other.y(alpha, beta) - nominal.y(alpha, beta)
    assert np.sqrt(np.mean(off[inside] ** 2)) / 12.54 == pytest.approx(0.10, rel=1e-6)


def test_feedback_with_preview_of_the_reference_lags_less():
    """With ``lead_s`` a loop reacts to what is wanted later: behind a ramp its mean error shrinks, or turns."""
    follow = Reference("up", (0.0, 60.0), (1.0, 8.0))
    behind = []
    for lead_s in (0.0, 0.5):
        given = track(
            controller_model(),
            controller_factory("pi", {**default_settings("pi"), "lead_s": lead_s}),
            follow,
            prepare=False,
        )
        twin, answer, errors = Twin.named("one_wire_twin", seed=1), None, []
        while True:
            try:
                command = given.send(answer)
            except StopIteration:
                break
            answer = twin.step(command.current_A)[0] if isinstance(command, Drive) else None
            if answer and 20.0 < answer.t_s < 60.0:
                errors.append(follow.at(answer.t_s) - answer.position)
        behind.append(np.mean(errors))
    assert behind[0] > behind[1] + 0.2 * 7.0 / 60.0


def within(rate_A_per_s, most_A):
    """What is known of the wire, on a rig with these limits."""
    plain = controller_model()
    limits = plain.setup.limits.model_copy(
        update={"current_rate_A_per_s": rate_A_per_s, "current_max_A": most_A}
    )
    setup = type(plain.setup)(plain.setup.actuator, limits, plain.setup.period_s)
    return ControllerModel(setup, plain.hysteresis, plain.position_per_count)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_limits_hold_whatever_a_controller_commands(name):
    rate_A_per_s, most_A = 1.0, 0.8
    tight = within(rate_A_per_s, most_A)
    follow = reference("steps", 1.0, 6.0, seconds=60.0, every_s=10.0, seed=1)
    flowed, ended = driven(
        track(tight, controller_factory(name, default_settings(name)), follow, prepare=False),
        {"current_rate_A_per_s": rate_A_per_s, "current_max_A": most_A},
    )
    assert ended is None
    assert flowed.max() == pytest.approx(most_A)
    assert np.abs(np.diff(flowed)).max() <= rate_A_per_s * 0.1 + 1e-9
    assert np.abs(np.diff(flowed)).max() > 0.9 * rate_A_per_s * 0.1, "the limit was met"


def greedy(_, __):
    while True:
        yield 99.0


def test_commands_beyond_the_limits_are_clipped_and_the_current_ramps_down_within_them():
    follow = reference("ramps", 2.0, 8.0, seconds=5.0, seed=1)
    flowed, ended = driven(
        track(within(1.0, 0.8), greedy, follow, prepare=False),
        {"current_rate_A_per_s": 1.0, "current_max_A": 0.8},
    )
    assert ended is None
    assert flowed.max() == pytest.approx(0.8)
    assert np.abs(np.diff(flowed)).max() <= 0.1 + 1e-9
    assert flowed[-1] == 0.0


def backwards(assumed_model, reference_at):
    """A loop with its sign wrong."""
    sample = yield 0.5
    while True:
        sample = yield 1.0 if reference_at(sample.t_s) < sample.position else 0.0


def broken(_, __):
    yield 0.5
    yield math.nan


def test_a_loop_that_diverges_trips_to_zero():
    follow = reference("steps", 6.0, 7.0, seconds=300.0, every_s=100.0, seed=1)
    flowed, ended = driven(
        track(
            controller_model(),
            backwards,
            follow,
            prepare=False,
            divergence_limits=DivergenceLimits(0.2, 10.0),
        )
    )
    assert "diverges" in str(ended)
    assert flowed.size < 1500


def test_what_is_no_number_trips_to_zero():
    follow = reference("ramps", 2.0, 8.0, seconds=60.0, seed=1)
    flowed, ended = driven(track(controller_model(), broken, follow, prepare=False))
    assert "commanded nan A" in str(ended)
    assert flowed.size == 2


def test_it_begins_and_ends_at_zero_and_records_the_reference():
    follow = reference("ramps", 2.0, 8.0, seconds=5.0, seed=1)
    twin, commands, answer = (
        Twin(nominal_rig_file(), controller_model().setup.actuator, TwinSettings()),
        [],
        None,
    )
    protocol = track(
        controller_model(), controller_factory("pi", default_settings("pi")), follow, name="pi", prepare=False
    )
    while True:
        try:
            commands.append(protocol.send(answer))
        except StopIteration:
            break
        answer = twin.step(commands[-1].current_A)[0] if isinstance(commands[-1], Drive) else None
    currents = [c.current_A for c in commands if isinstance(c, Drive)]
    assert currents[0] == currents[-1] == 0.0
    assert len(currents) >= 51
    mark = next(c for c in commands if isinstance(c, Mark))
    assert mark.data["reference"]["position"] == list(follow.position)


def nominal_rig_file():
    from smarig.config import load_rig

    return load_rig("one_wire_twin")


def test_through_the_lag_in_one_move():
    """Against (5.1) integrated by hand."""
    setup = controller_model().setup
    source = source_towards(setup, 40.0, 47.0, horizon_s=2.0)
    temperature, dt = 40.0, 1e-4
    for _ in range(20_000):
        temperature += dt * (source - temperature) / setup.tau_s
    assert temperature == pytest.approx(47.0, abs=1e-3)
    assert source_towards(setup, 40.0, 170.0, horizon_s=0.5) == setup.upper_K
    assert source_towards(setup, 40.0, 30.0, horizon_s=0.1) == setup.lower_K  # cooling is passive


@pytest.mark.parametrize(
    "effects", [["wire_lag=60"], ["amplifier_gain=8"], ["wire_lag=-30", "amplifier_gain=-8"]]
)
def test_through_the_lag_and_the_amplifier_of_a_model_with_effects(effects):
    """The model's own steps are the reference: the wire's position after this current."""
    with_effects_model = controller_model().with_effects(effects_from_pairs(effects))
    model = with_effects_model.plant()
    for _ in range(100):
        model.step(0.6)
    goal_K = model.heating.input_K + 4.0
    current = current_towards(with_effects_model.setup, model, goal_K, horizon_s=2.0)
    for _ in range(20):
        model.step(current)
    assert model.heating.input_K == pytest.approx(goal_K, abs=1e-6)


def test_the_observer_finds_offset_and_slope():
    rng, observer = np.random.default_rng(1), SlopeObserver.at(0.0, 10.0, 0.02, 0.001, 0.01)
    model = np.linspace(0.0, 8.0, 400)
    for y in model:
        observer = observer.updated(0.3 + 1.25 * y + 0.02 * rng.normal(), float(y), 0.1)
    assert observer.g == pytest.approx(0.25, abs=0.02)
    assert observer.model + observer.d == pytest.approx(0.3 + 1.25 * 8.0, abs=0.02)
    assert 0.3 + 1.25 * observer.model_for(9.0) == pytest.approx(9.0, abs=0.05)


def test_one_simplex_for_all_stays_within_ranges_and_budget():
    asked = []

    def cost(numbers):
        asked.append(dict(numbers))
        return (math.log(numbers["gain_share"]) - 12.0) ** 2 + (math.log(numbers["integral_s"]) - 1.0) ** 2

    found = tuned_numbers("pi", cost, 60)
    assert len(asked) == 60
    assert found["gain_share"] == pytest.approx(ranges("pi")["gain_share"][1], rel=1e-2)
    assert found["integral_s"] == pytest.approx(math.e, rel=0.2)
    assert all(
        0.999 * low <= n[key] <= 1.001 * high for n in asked for key, (low, high) in ranges("pi").items()
    )

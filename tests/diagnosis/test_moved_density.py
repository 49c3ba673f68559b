"""A density moved with the input: along the moved input it gives the outputs that it gave along the other."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.joint_density import (
    AS_GOOD,
    joint_density,
    joint_density_from_best_start,
    settled_rms,
    with_density_for_effects,
)
from smarig.diagnosis.refit.moved_density import rising_map, with_moved_density
from smarig.diagnosis.refit.refit import refit
from smarig.identification import Observations, surface_through_states
from smarig.plant import effects_from_pairs
from smarig.replay import build_timeline, predict


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    runs = session_runs(tmp_path_factory.mktemp("moved"), LONG, LISTED)
    return replace(build_timeline(runs, twin_plant_model()[0].actuator.tau_s), other_readings=())


@pytest.fixture(scope="module")
def plain(timeline):
    """The twin's wire with a density from its own readings, as a table."""
    wire, _ = twin_plant_model()
    fitted = refit(timeline, predict(timeline, wire), wire)
    return replace(wire, hysteresis=fitted.posterior.table())


def with_effects(plain, *pairs):
    return replace(plain, effects=effects_from_pairs(pairs))


def error(timeline, model, reference):
    """Largest difference of settled positions, in strokes."""
    there, here = (predict(timeline, m).values["settled"] for m in (reference, model))
    return float(np.abs(there - here).max() / reference.stroke)


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "amplifier_gain=-4",
        "amplifier_gain=2",
    ),
)
@pytest.mark.parametrize("pair", ["amplifier_gain=-4", "amplifier_gain=2", "dead_zone=0.02"])
def test_along_the_moved_input_the_outputs_are_the_same(timeline, plain, pair):
    extended = with_effects(plain, pair)
    left_in_place = error(timeline, extended, plain)
    moved = with_moved_density(timeline, extended, plain.hysteresis)
    assert moved.effects == extended.effects
    assert (moved.hysteresis.lower, moved.hysteresis.upper) == (
        plain.hysteresis.lower,
        plain.hysteresis.upper,
    )
    assert error(timeline, moved, plain) < 0.2 * left_in_place


@pytest.mark.long("takes five seconds")
def test_a_given_surface_is_refitted_along_the_inputs_with_effects(tmp_path):
    """Identified without the effect, the surface is wrong along the true input; moved, it is 11 nats less likely."""
    effect = "resistance_phase=10"
    runs = session_runs(
        tmp_path,
        ("first_order_descending", {"partition_K": (0.0, 40.0, 60.0, 80.0, 110.0, 156.7)}),
        LONG,
        effects=(effect,),
    )
    wire, _ = twin_plant_model()
    recorded = build_timeline(runs, wire.actuator.tau_s)
    without = predict(recorded, wire)
    n = len(recorded.settled)
    ends = wire.hysteresis.lower, wire.hysteresis.upper
    rows = Observations.of_states(without.states[:n], recorded.settled.value, recorded.block, ends)
    surface = surface_through_states(rows, wire.hysteresis)
    extended = with_effects(replace(wire, hysteresis=surface), effect)
    moved = joint_density(recorded, with_moved_density(recorded, extended, surface))
    found = joint_density_from_best_start(recorded, extended, surface)
    assert found.refitted.log_evidence > moved.refitted.log_evidence + 5


@pytest.mark.long("takes two seconds", cases=("pairs1",))
@pytest.mark.parametrize("pairs", [(), ("walking=0.5",)])
def test_a_density_stays_where_the_input_does(timeline, plain, pairs):
    assert (
        with_moved_density(timeline, with_effects(plain, *pairs), plain.hysteresis).hysteresis
        is plain.hysteresis
    )


def test_effects_that_only_another_channel_shows_leave_the_positions_as_they_were(timeline, plain):
    """The density fitted with the effects is worse here: it stayed where the input was."""
    extended = with_effects(plain, "amplifier_gain=-4")
    fitted = refit(timeline, predict(timeline, extended), extended)
    found = with_density_for_effects(timeline, extended, fitted, plain)
    assert settled_rms(timeline, found) < AS_GOOD * settled_rms(timeline, plain)


def test_the_ends_of_the_range_move_as_far_as_is_known():
    """Beyond saturation inputs are only known to be beyond: the nearest of them is the end."""
    before = np.array([0.0, 0.0, 20.0, 40.0, 100.0, 100.0])
    after = np.array([-3.0, 2.0, 21.0, 41.0, 93.0, 120.0])
    at, moved = rising_map(before, after, 0.0, 100.0)
    np.testing.assert_allclose(at, [0.0, 20.0, 40.0, 100.0])
    np.testing.assert_allclose(moved, [2.0, 21.0, 41.0, 93.0])


def test_without_readings_in_saturation_the_ends_move_like_their_neighbours():
    at, moved = rising_map(np.array([40.0, 20.0, 40.0]), np.array([30.0, 18.0, 32.0]), 0.0, 100.0)
    np.testing.assert_allclose(at, [0.0, 20.0, 40.0, 100.0])
    np.testing.assert_allclose(moved, [-2.0, 18.0, 31.0, 91.0])


def test_inputs_that_change_their_order_share_their_mean():
    _, moved = rising_map(np.array([10.0, 20.0, 30.0]), np.array([12.0, 25.0, 15.0]), 0.0, 40.0)
    np.testing.assert_allclose(moved, [2.0, 12.0, 20.0, 20.0, 30.0])

"""Boxes of worlds beyond the catalogue: the kinetic law against its closed form, the halves, what the mechanisms do."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.boxes import draw_world_box
from benchmarks.boxes.foreign_box import KINETIC, UNLISTED_CATEGORY
from benchmarks.boxes.hold_plan import duration_h
from benchmarks.boxes.kinetic_hysteresis import KineticHysteresis
from benchmarks.boxes.sealing import simulate_session
from benchmarks.boxes.unlisted_effects import UNLISTED
from smarig.plant import effect_types

EVERY = sorted(UNLISTED)


def wire(law, grains=1):
    one = np.ones(grains)
    return KineticHysteresis(60 * one, 80 * one, 50 * one, 30 * one, one / grains, law, stroke=10.0)


def test_liang_and_rogers_on_the_major_loop():
    state = wire("cosine").initial(two_wire=False)
    assert state.move(65.0) == pytest.approx(1 - 0.5 * (np.cos(np.pi * 0.25) + 1))
    assert state.move(90.0) == pytest.approx(1.0)
    assert state.move(40.0) == pytest.approx(0.5)
    assert state.move(20.0) == pytest.approx(0.0, abs=1e-12)


def test_tanaka_on_the_major_loop():
    state = wire("exponential").initial(two_wire=False)
    assert state.move(70.0) == pytest.approx(1 - 0.01**0.5)
    assert state.move(81.0) == pytest.approx(1.0)


@pytest.mark.parametrize("law", ["cosine", "exponential"])
def test_minor_loops_do_not_return_and_paths_between_turns_do_not_matter(law):
    state, stepwise = wire(law).initial(two_wire=False), wire(law).initial(two_wire=False)
    for u in np.linspace(0.0, 70.0, 29):
        stepwise.move(float(u))
    first = state.move(70.0)
    assert stepwise.share == pytest.approx(first)
    loops = [(state.move(42.0), state.move(70.0))[1] for _ in range(3)]
    assert abs(loops[0] - first) > 0.005  # a Preisach operator returns to it


def test_a_coupled_move_ends_where_temperature_and_fraction_agree():
    state = wire("cosine").initial(two_wire=False)
    share = state.move_coupled(lambda x: 75.0 - 10.0 * np.asarray(x))
    assert state.u == pytest.approx(75.0 - 10.0 * share, abs=1e-6)
    assert 0 < share < 1


@pytest.mark.long("takes a second")
def test_the_halves_share_no_mechanism_and_no_box():
    boxes = {
        part: [draw_world_box(3, k, part, "unlisted") for k in range(60)] for part in ("public", "sealed")
    }
    names = {part: {name for box in found for name in box.hidden} for part, found in boxes.items()}
    assert names["public"].isdisjoint(names["sealed"])
    assert names["public"] | names["sealed"] == set(UNLISTED)
    assert boxes["public"][0].wire != boxes["sealed"][0].wire
    assert not set(UNLISTED) & {kind.name for kind in effect_types()}


def test_the_mix_of_worlds():
    kinds = [draw_world_box(4, k).category for k in range(120)]
    foreign = sum(kind in (KINETIC, UNLISTED_CATEGORY) for kind in kinds)
    assert foreign >= 0.3 * len(kinds)
    assert KINETIC in kinds
    assert UNLISTED_CATEGORY in kinds


@pytest.mark.parametrize("name", EVERY)
def test_every_mechanism_changes_the_settled_outputs(name, first_box):
    session_h = duration_h(first_box.plan, first_box.wire)
    values = UNLISTED[name].random_values(np.random.default_rng(1), session_h)
    session = simulate_session(replace(first_box, hidden={name: values}))
    change = np.abs(session.with_effects - session.without).max()
    assert change > 0.0005 * first_box.hysteresis.stroke


@pytest.fixture(scope="module")
def first_box():
    """A box with few holds."""
    box = draw_world_box(3, 0, "public", "unlisted")
    plan = tuple(replace(run, holds=run.holds[:22]) for run in box.plan[:1])
    return replace(box, plan=plan)

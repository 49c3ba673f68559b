"""Flexible discrepancies on boxes of worlds that share no equation with the diagnosis: found where something is wrong,
quiet where nothing is.
"""

from dataclasses import replace

import numpy as np
import pytest
from smarig.diagnosis.explain.discrepancy import likeliest_discrepancy
from smarig.diagnosis.name_gates import DISCREPANCY_NATS, slow_room

from benchmarks.boxes import draw_box, draw_world_box, write_box
from benchmarks.boxes.unlisted_effects import UNLISTED
from smarig.diagnosis import joint_density_from_best_start
from smarig.identification import identify
from smarig.record import load_run
from smarig.replay import actuator_for_run, build_timeline, plant_model_of

SEED = 21
LONG = pytest.mark.long("takes six seconds")


def discrepancy_of(box, folder):
    """The likeliest discrepancy without effects, from the files of a box alone."""
    train = [load_run(path) for path in write_box(box, folder).train]
    model = identify(train, "positive").model
    timeline = build_timeline(train, actuator_for_run(model, train[0]).tau_s)
    plant_model = plant_model_of(model, timeline.runs[0])
    base, refitted = joint_density_from_best_start(timeline, plant_model, plant_model.hysteresis)
    return likeliest_discrepancy(timeline, base, refitted)


@pytest.mark.parametrize("number", [pytest.param(1, marks=LONG), 9])
def test_it_is_quiet_where_nothing_is_hidden(number, tmp_path):
    found = discrepancy_of(draw_box(77, number, hidden={}), tmp_path)
    assert found.gain < DISCREPANCY_NATS
    assert not slow_room(found)
    assert found.noise > 0


@pytest.mark.parametrize("number", [pytest.param(0, marks=LONG), 5])
def test_a_wire_with_kinetics_is_told_as_one_whose_minor_loops_do_not_return(number, tmp_path):
    found = discrepancy_of(draw_world_box(SEED, number, "public", "kinetic"), tmp_path)
    assert found.gain > 4 * DISCREPANCY_NATS
    assert found.not_preisach
    assert found.depends_on == "history"


@pytest.mark.parametrize("number", [pytest.param(7, marks=LONG), 11])
def test_a_mechanism_that_nobody_listed_shows_its_variable(number, tmp_path):
    box = draw_world_box(SEED, number, "public", "unlisted")
    (name,) = box.hidden
    found = discrepancy_of(box, tmp_path)
    assert found.gain > 4 * DISCREPANCY_NATS
    assert found.depends_on in UNLISTED[name].variables
    assert found.place == "output"


def test_a_room_that_swings_is_more_than_a_draught(tmp_path):
    box = draw_world_box(SEED, 3, "public", "unlisted")
    assert "thermostat" in box.hidden
    found = discrepancy_of(box, tmp_path)
    assert slow_room(found) or found.gain > DISCREPANCY_NATS


@LONG
def test_a_discrepancy_in_the_readings_is_what_was_put_there(tmp_path):
    """A quiet box with a slow wave added to its outputs."""
    box = draw_box(77, 9, hidden={})
    train = [load_run(path) for path in write_box(box, tmp_path).train]
    model = identify(train, "positive").model
    timeline = build_timeline(train, actuator_for_run(model, train[0]).tau_s)
    plant_model = plant_model_of(model, timeline.runs[0])
    t = timeline.settled.t_s
    wave = 0.01 * plant_model.stroke * np.sin(2 * np.pi * 3 * (t - t[0]) / np.ptp(t))
    moved = replace(timeline, settled=replace(timeline.settled, value=timeline.settled.value + wave))
    base, refitted = joint_density_from_best_start(moved, plant_model, plant_model.hysteresis)
    found = likeliest_discrepancy(moved, base, refitted)
    assert (found.variable, found.place) == ("time", "output")
    assert found.gain > 2 * DISCREPANCY_NATS

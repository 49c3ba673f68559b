"""Two ways through a story: along a path that is known beforehand, and tick by tick with the whole plant."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.model.planted import from_pairs, kinds
from smarig.story import life
from smarig.story.felt import felt
from smarig.story.told import Drive, Readings, told
from story.sittings import LISTED, LONG, believed, sitting

ASKING = {"accommodation", "fatigue", "latent_heat", "resistance_phase", "stress_coupling"}  # for the output


WIRES = {"one_wire": kinds("one_wire"), "two_wire": kinds("two_wire")}
CASES = [pytest.param(wire, kind, id=f"{wire}-{kind.name}") for wire in WIRES for kind in WIRES[wire]]


@pytest.fixture(scope="module")
def lives(tmp_path_factory):
    """(story, subject) of each wire."""
    found = {}
    for wire in WIRES:
        runs = sitting(tmp_path_factory.mktemp(wire), LONG, LISTED, rig=f"{wire}_twin")
        subject, _ = believed(wire=f"gorbet_{wire}")
        found[wire] = told(runs, subject.actuator.tau_s), subject
    return found


def both_ways(story, subject, effects):
    """The same life by parts of ticks and tick by tick."""
    way = felt(story, subject, effects)
    assert way is not None
    return life._by_parts(story, subject, effects, way), life._by_ticks(story, subject, effects)


def assert_the_same(a, b):
    assert np.array_equal(a.columns, b.columns)
    assert a.states == b.states
    assert np.array_equal(a.felt_K, b.felt_K)


@pytest.mark.parametrize(("wire", "kind"), CASES)
def test_both_ways_tell_the_same_to_the_last_bit(lives, wire, kind):
    story, subject = lives[wire]
    effects = (kind(),)
    assert (felt(story, subject, effects) is None) == (kind.name in ASKING)
    if kind.name not in ASKING:
        assert_the_same(*both_ways(story, subject, effects))


@pytest.mark.parametrize("heat", ["wire_lag", "convection"])
@pytest.mark.parametrize("wire", WIRES)
def test_a_late_sensor_is_late_by_whole_ticks_however_these_are_cut(lives, wire, heat):
    story, subject = lives[wire]
    cut = from_pairs([heat])
    way = felt(story, subject, cut)
    assert way is not None
    assert way["t_s"].size > 1.5 * story.ticks[0].size
    late, true = (both_ways(story, subject, e) for e in ((*cut, *from_pairs(["sensor_lag"])), cut))
    assert_the_same(*late)
    assert np.abs(late[0]["counts"] - true[0]["counts"]).max() > 10


def test_what_has_play_is_dragged_from_where_it_rested(lives):
    """A current from the first instant: in the first tick already the wire moves by more than the play."""
    story, subject = lives["two_wire"]
    at = np.array([0.1, 1.0, 5.0, 19.0])
    settled = Readings("settled", np.zeros(4), at, np.arange(4), story.unit)
    at_once = replace(story, drive=Drive(at[-1:], np.array([1.5])), settled=settled, others=())
    a, b = both_ways(at_once, subject, from_pairs(["backlash"]))
    assert_the_same(a, b)
    half = 0.0075 * subject.stroke
    assert a["output"][0] > 5 * half
    np.testing.assert_allclose(a["counts"] * subject.per_count, a["output"] - half, rtol=1e-12)

"""Two ways through a story: along a path that is known beforehand, and tick by tick with the whole plant."""

import numpy as np
import pytest

from smarig.model.planted import kinds
from smarig.story import life
from smarig.story.felt import felt
from smarig.story.told import told
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


@pytest.mark.parametrize(("wire", "kind"), CASES)
def test_both_ways_tell_the_same_to_the_last_bit(lives, wire, kind):
    story, subject = lives[wire]
    effects = (kind(),)
    way = felt(story, subject, effects)
    assert (way is None) == (kind.name in ASKING)
    if way is not None:
        a, b = life._by_parts(story, subject, effects, way), life._by_ticks(story, subject, effects)
        assert np.array_equal(a.columns, b.columns)
        assert a.states == b.states
        assert np.array_equal(a.felt_K, b.felt_K)

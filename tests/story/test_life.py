"""Two ways through a story: along a path that is known beforehand, and tick by tick with the whole plant."""

import numpy as np
import pytest

from smarig.model.planted import kinds
from smarig.story import life
from smarig.story.felt import felt
from smarig.story.told import told
from story.sittings import LISTED, LONG, believed, sitting

ASKING = {"accommodation", "fatigue", "latent_heat", "resistance_phase", "stress_coupling"}  # for the output


@pytest.fixture(scope="module", params=["one_wire", "two_wire"])
def story_and_subject(request, tmp_path_factory):
    runs = sitting(tmp_path_factory.mktemp(request.param), LONG, LISTED, rig=f"{request.param}_twin")
    subject, _ = believed(wire=f"gorbet_{request.param}")
    return told(runs, subject.actuator.tau_s), subject


@pytest.mark.parametrize("kind", kinds(), ids=lambda k: k.name)
def test_both_ways_tell_the_same_to_the_last_bit(story_and_subject, kind):
    story, subject = story_and_subject
    if kind.arrangement == "two_wire" and not subject.actuator.two_wire:
        pytest.skip("needs two wires")
    effects = (kind(),)
    way = felt(story, subject, effects)
    assert (way is None) == (kind.name in ASKING)
    if way is not None:
        a, b = life._by_parts(story, subject, effects, way), life._by_ticks(story, subject, effects)
        assert np.array_equal(a.columns, b.columns)
        assert a.states == b.states
        assert np.array_equal(a.felt_K, b.felt_K)

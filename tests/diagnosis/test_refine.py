"""An explanation at its best: where a fit ends, and how much farther one may go."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.diagnosis.refine import Refined, refined
from smarig.diagnosis.refit import refit
from smarig.model.effects.settling import settling
from smarig.model.effects.walking import walking
from smarig.story.retelling import retold
from smarig.story.told import told
from story.sittings import LISTED, LONG, believed, sitting

START = (walking(0.2), settling(2.0, time_constant_s=600.0))


def ended(*effects):
    return Refined(effects, {}, {}, np.zeros(1), believed()[0], 1.0)


def test_beyond_is_so_many_times_as_far_as_the_fit_went():
    found = ended(walking(0.5), settling(3.0, time_constant_s=500.0)).beyond(START, 2.0)
    assert [p.kind.name for p in found] == ["walking", "settling"]
    assert found[0].values == pytest.approx({"percent_per_cycle": 0.8})
    assert found[1].values == pytest.approx({"share_percent": 4.0, "time_constant_s": 400.0})


def test_once_as_far_is_where_the_fit_ended():
    end = (walking(-0.7), settling(1.0, time_constant_s=900.0))
    for p, q in zip(ended(*end).beyond(START, 1.0), end, strict=True):
        assert p.values == pytest.approx(q.values)


@pytest.mark.parametrize("strength", [-2.9, 2.9])
def test_beyond_ends_at_the_bounds(strength):
    end = ended(walking(strength), settling(0.1, time_constant_s=600.0))
    one, other = end.beyond(START, 50.0)
    assert one.strength == (walking.primary.upper if strength > 0 else walking.primary.lower)
    assert other.strength == settling.primary.lower
    assert other.values["time_constant_s"] == 600.0


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The story of a wire that walks, the subject that does not know, and its readings refitted."""
    runs = sitting(tmp_path_factory.mktemp("refine"), LISTED, LONG, LISTED, effects=("walking=0.8",))
    wire, per_count = believed()
    subject = replace(wire, per_count=per_count)
    story = told(runs, wire.actuator.tau_s)
    told_ = retold(story, subject)
    trace = retold(story, subject, [walking(0.1)]).stacked(story) - told_.stacked(story)
    return story, subject, refit(story, told_, subject, [trace[:, None]])


def fitted(walked, strength):
    story, subject, like = walked
    return refined([walking(strength)], story, subject, like, subject.hysteresis)


def test_a_fit_from_afar_moves_to_what_was_planted(walked):
    found = fitted(walked, 0.1)
    assert found.effects[0].strength == pytest.approx(0.8, rel=0.03)
    sd = found.spread["walking", "percent_per_cycle"]
    assert found.moved == pytest.approx((found.effects[0].strength - 0.1) / sd)
    assert found.moved > 10


def test_a_fit_from_its_own_end_moves_no_more(walked):
    again = fitted(walked, fitted(walked, 0.1).effects[0].strength)
    assert again.moved < 0.3

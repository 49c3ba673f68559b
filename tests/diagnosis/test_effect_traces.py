"""Traces of weak effects along a timeline: proportional to the strength, one for every combination worth trying."""

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.comparison.commanded.effect_traces import named
from smarig.plant.effects.backlash import backlash
from smarig.plant.effects.settling import settling
from smarig.plant.effects.walking import walking
from smarig.replay import build_timeline, predict


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A timeline of a session, its plant model, and the prediction."""
    runs = session_runs(tmp_path_factory.mktemp("traces"), LONG, LISTED)
    plant_model, _ = twin_plant_model()
    timeline = build_timeline(runs, plant_model.actuator.tau_s)
    return timeline, plant_model, predict(timeline, plant_model)


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "kind0-0.8",
        "kind1--0.3",
    ),
)
@pytest.mark.parametrize(("kind", "strength"), [(walking, 0.8), (walking, -0.3), (settling, 0.9)])
def test_a_trace_times_a_strength_is_what_the_effect_changes(recorded, kind, strength):
    timeline, plant_model, base = recorded
    change = predict(timeline, plant_model, [kind(strength)]).stacked(timeline) - base.stacked(timeline)
    (candidate,) = named(timeline, plant_model, base, [kind])
    strengths = np.array([v.strength for v in candidate.variants])
    left = np.linalg.norm(candidate.traces * strength / strengths - change[:, None], axis=0)
    assert left.min() < 0.15 * np.linalg.norm(change)


def test_an_effect_has_a_variant_for_every_combination_worth_trying(recorded):
    timeline, plant_model, base = recorded
    found = {c.name: c for c in named(timeline, plant_model, base, (walking, settling, backlash))}
    usual = walking.primary.typical
    assert [p.strength for p in found["walking"].variants] == [0.25 * usual, usual]
    assert {p.values["time_constant_s"] for p in found["settling"].variants} == set(
        settling.parameters[1].tries
    )
    expected = [*backlash.primary.tries, backlash.primary.typical]
    assert [p.strength for p in found["backlash"].variants] == expected
    for candidate in found.values():
        assert candidate.traces.shape == (base.stacked(timeline).size, len(candidate.variants))
        assert np.abs(candidate.traces).max(axis=0).min() > 0

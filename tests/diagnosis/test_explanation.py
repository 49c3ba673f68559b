"""Explanations at their maximum: strengths by the evidence, and the loss when one effect is removed."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.explain import explanation
from smarig.diagnosis.explain.explanation import (
    SD_INFLATION,
    Explanation,
    doubled_strength_start,
    evidence_without_one,
    fit_explanation,
    with_strengths_maximised,
)

from smarig.diagnosis.refit.parameter_fit import ParameterFit
from smarig.plant.effects.settling import settling
from smarig.plant.effects.slip import slip
from smarig.plant.effects.walking import walking
from smarig.replay import PlantModel

WIRE: Any = None
TIMELINE: Any = "a story"
ORIGINAL: Any = "the model's density"
WARM_START: Any = "another refit"


def plant_model(*effects):
    density: Any = "the density of all"
    return PlantModel(WIRE, density, "negative", effects)


def read(nats) -> Any:
    """Readings refitted, so likely."""
    return SimpleNamespace(log_evidence=nats)


def strengths(of):
    return {p.kind.name: p.strength for p in of.catalogue_effects}


@pytest.fixture
def likely(monkeypatch):
    """Sets the likelihood of all readings at each strength, with a separate density, and stores the
    requests."""
    asked = []

    def as_likely_as(evidence):
        def anew(timeline, plant_model, original, warm_start=None):
            assert (timeline, original) == (TIMELINE, ORIGINAL)
            asked.append(strengths(plant_model))
            return plant_model, read(evidence(**strengths(plant_model)))

        monkeypatch.setattr(explanation, "joint_density_from_best_start", anew)
        return asked

    return as_likely_as


@pytest.mark.parametrize(("top", "found"), [(0.8, 0.8), (0.1, 0.1), (0.25, 0.2), (5.0, 1.6)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_start_doubles_as_long_as_that_is_likelier_and_within_bounds(likely, top, found, sign):
    """The bounds of walking are ±3."""

    def evidence(walking):
        return -100 * (walking - sign * top) ** 2

    likely(evidence)
    start = plant_model(walking(sign * 0.1))
    end, refitted = doubled_strength_start(TIMELINE, start, read(evidence(sign * 0.1)), ORIGINAL, WARM_START)
    assert strengths(end) == pytest.approx({"walking": sign * found})
    assert refitted.log_evidence == evidence(**strengths(end))


def test_a_start_that_is_no_likelier_doubled_is_the_very_same(likely):
    likely(lambda walking: 7.0)
    start, refitted = plant_model(walking(0.1)), read(7.0)
    assert doubled_strength_start(TIMELINE, start, refitted, ORIGINAL, WARM_START) == (start, refitted)


def test_only_the_last_effect_of_a_start_is_doubled(likely):
    asked = likely(lambda settling, walking: walking)
    end, _ = doubled_strength_start(
        TIMELINE, plant_model(settling(2.0), walking(0.5)), read(0.5), ORIGINAL, WARM_START
    )
    assert strengths(end) == {"settling": 2.0, "walking": 2.0}
    assert {tried["settling"] for tried in asked} == {2.0}


def test_nothing_twice_as_strong_is_still_nothing(likely):
    asked = likely(lambda walking: 1.0)
    start = plant_model(walking(0.0))
    assert doubled_strength_start(TIMELINE, start, read(0.0), ORIGINAL, WARM_START)[0] is start
    assert not asked


SHARE, SECONDS = ("settling", "share_percent"), ("settling", "time_constant_s")
WALK = ("walking", "percent_per_cycle")
SPREAD = {SHARE: 0.04, SECONDS: 30.0, WALK: 0.005}  # standard deviations of a fit
ALONE = {SHARE: 0.02, SECONDS: 20.0, WALK: 0.004}  # and of one parameter if the others are known


@pytest.fixture
def fitted(monkeypatch):
    """A fit that stays where it is, and is surer than it should be."""

    def fit_parameters(start, timeline, plant_model, refitted, centre):
        return ParameterFit(tuple(start), SPREAD, ALONE, np.zeros(1), plant_model, 0.0)

    monkeypatch.setattr(explanation, "fit_parameters", fit_parameters)


def at_top(likely, evidence):
    """Settling and walking of 2 and 0.3 %, topped by their evidence."""
    likely(evidence)
    start = plant_model(settling(2.0), walking(0.3))
    best = Explanation(start.catalogue_effects, start, read(evidence(**strengths(start))))
    return with_strengths_maximised(TIMELINE, ORIGINAL, best)


def parabolas(share_sd, walk_sd):
    """Evidence with its top at 2.5 % and 0.4 %."""
    return lambda settling, walking: (
        100 - ((settling - 2.5) / share_sd) ** 2 / 2 - ((walking - 0.4) / walk_sd) ** 2 / 2
    )


@pytest.mark.usefixtures("fitted")
def test_every_strength_goes_to_the_top_of_the_evidence(likely):
    fine, best = at_top(likely, parabolas(0.2, 0.02))
    assert strengths(best.plant_model) == pytest.approx({"settling": 2.5, "walking": 0.4}, rel=0.03)
    assert best.evidence == pytest.approx(100, abs=0.1)
    assert fine.effects == best.effects == best.plant_model.catalogue_effects
    assert fine.plant_model is best.plant_model


@pytest.mark.usefixtures("fitted")
def test_a_standard_deviation_is_that_of_the_evidence_where_the_fit_gives_less(likely):
    """Ten times as wide for settling, with all its parameters; five times for walking."""
    fine, _ = at_top(likely, parabolas(0.2, 0.02))
    wider = {SHARE: 10, SECONDS: 10, WALK: 5}
    assert fine.spread == pytest.approx(
        {key: SD_INFLATION * wider[key] * SPREAD[key] for key in SPREAD}, rel=0.02
    )
    assert fine.spread[SHARE] > 0.2
    assert fine.spread[WALK] > 0.02


@pytest.mark.usefixtures("fitted")
def test_a_deviation_is_never_narrower_than_the_fits_own(likely):
    fine, _ = at_top(likely, parabolas(0.2, 0.001))
    assert fine.spread[WALK] == pytest.approx(SD_INFLATION * SPREAD[WALK])


@pytest.mark.usefixtures("fitted")
def test_a_strength_whose_evidence_has_no_top_has_no_deviation(likely):
    """The evidence grows with the strength without limit, so the strength is undetermined."""
    fine, best = at_top(likely, lambda settling, walking: walking**2 - 50 * (settling - 2) ** 2)
    assert strengths(best.plant_model)["walking"] > 0.6
    assert WALK not in fine.spread
    assert set(fine.spread) == {SHARE, SECONDS}
    assert np.isfinite(list(fine.spread.values())).all()


def test_one_effect_less_is_the_likeliest_of_all_that_are_left(monkeypatch):
    asked = []

    def beside(timeline, plant_model, warm_start):
        names = tuple(strengths(plant_model))
        asked.append((names, plant_model.hysteresis, warm_start))
        nats = {("slip", "walking"): 60.0, ("settling", "walking"): 80.0, ("settling", "slip"): 70.0}
        return plant_model, read(nats[names])

    monkeypatch.setattr(explanation, "joint_density", beside)
    best = plant_model(settling(2.0), slip(1.0), walking(0.3))
    assert (
        evidence_without_one(TIMELINE, Explanation(best.catalogue_effects, best, read(100.0)), WARM_START)
        == 80.0
    )
    assert sorted(names for names, _, _ in asked) == [
        ("settling", "slip"),
        ("settling", "walking"),
        ("slip", "walking"),
    ]
    assert {(density, warm_start) for _, density, warm_start in asked} == {("the density of all", WARM_START)}


def fit_moving_by(share, top=1.0):
    """Least squares from any start: this share of the way to the top, for a density has taken up the rest."""

    def fit_parameters(start, timeline, plant_model, refitted, centre):
        s = start[0].strength
        end = (start[0].at(s + share * (top - s)),)
        return ParameterFit(end, {}, {}, np.zeros(1), plant_model, abs(end[0].strength - s) / 0.001)

    return fit_parameters


@pytest.mark.parametrize("share", [1.0, 0.5, 0.2])
def test_rounds_end_nearer_to_the_maximum_than_each_fit_alone(likely, monkeypatch, share):
    monkeypatch.setattr(explanation, "fit_parameters", fit_moving_by(share))

    def evidence(walking):
        return -1e4 * (walking - 1.0) ** 2

    likely(evidence)
    found = fit_explanation(TIMELINE, plant_model(walking(0.1)), ORIGINAL, read(evidence(0.1)), 4)
    assert abs(found.effects[0].strength - 1.0) <= 0.9 * (1 - share) ** 4
    assert found.evidence == evidence(found.effects[0].strength)


def test_without_a_turn_an_explanation_is_its_start(likely):
    asked = likely(lambda walking: 1e9)
    start, refitted = plant_model(walking(0.1)), read(5.0)
    found = fit_explanation(TIMELINE, start, ORIGINAL, refitted, 0)
    assert (found.effects, found.plant_model, found.evidence) == (start.catalogue_effects, start, 5.0)
    assert not asked


@pytest.mark.usefixtures("fitted")
def test_a_fit_that_does_not_move_is_the_end(likely):
    asked = likely(lambda walking: 1e9)
    assert fit_explanation(TIMELINE, plant_model(walking(0.1)), ORIGINAL, read(5.0), 4).evidence == 5.0
    assert not asked


def test_a_turn_that_is_no_likelier_is_not_taken(likely, monkeypatch):
    monkeypatch.setattr(explanation, "fit_parameters", fit_moving_by(1.0))
    likely(lambda walking: 4.0)
    start = plant_model(walking(0.1))
    assert fit_explanation(TIMELINE, start, ORIGINAL, read(5.0), 4).plant_model is start


def test_names_are_in_order():
    both = plant_model(walking(0.3), settling(2.0))
    assert Explanation(both.catalogue_effects, both, read(1.0)).names == ("settling", "walking")

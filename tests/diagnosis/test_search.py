"""The search for explanations: its candidates, the required gain of an effect, and its end."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.explain import search
from smarig.diagnosis.explain.explanation import Explanation
from smarig.diagnosis.explain.search import BelowRivalEvidence, search_explanations

from smarig.plant.effects.fatigue import fatigue
from smarig.plant.effects.r_phase import r_phase
from smarig.plant.effects.settling import settling
from smarig.plant.effects.slip import slip
from smarig.plant.effects.walking import walking
from smarig.replay import PlantModel

WIRE: Any = None
ORIGINAL: Any = "the model's density"
KINDS = {kind.name: kind for kind in (walking, settling, slip, fatigue, r_phase)}
DATA = np.array([100.0, 100.0])  # 10 000 nats are in them


def test_nothing_is_searched_where_nothing_stands_out():
    silent: Any = SimpleNamespace(silent=True)

    def criticise(plant_model):
        pytest.fail("a silent critique was judged again")

    assert search_explanations(silent, ORIGINAL, criticise, 0.0).levels == []


class World:
    """How likely all readings are with each set of effects, and a search through it.

    ``worth``: nats by names, in order, with a blank between; what is not there is worth nothing. ``left``: nats of
    what is left of an explanation without one of its effects, beside the density of all; ``enough``: names beside
    which nothing stands out. ``of_channel``: strengths that a channel of its own shows. ``fits``: nats that
    fits with the present density gain, where they differ. Straight lines see just that, fits stay where they are.
    """

    def __init__(self, monkeypatch, worth, left=(), enough=(), starts=tuple(KINDS), of_channel=(), fits=()):
        self.worth, self.left, self.enough, self.starts = worth, dict(left), enough, starts
        self.of_channel, self.fits = dict(of_channel), dict(fits)
        self.judged = []
        for name in (
            "fit_parameters",
            "joint_density_from_best_start",
            "doubled_strength_start",
            "fit_explanation",
            "with_strengths_maximised",
            "evidence_without_one",
        ):
            monkeypatch.setattr(search, name, getattr(self, name))

    def nats(self, effects):
        return self.worth.get(" ".join(sorted(e.kind.name for e in effects)), 0.0)

    def fit_parameters(self, start, timeline, plant_model, refitted, centre, independent=False):
        if independent:
            start = [e.at(self.of_channel.get(e.kind.name, e.strength)) for e in start]
        extended = PlantModel(WIRE, ORIGINAL, "negative", tuple(start))
        data = DATA[refitted.coupled :] if independent else DATA
        names = " ".join(sorted(e.kind.name for e in start))
        gained = self.nats(start) if independent else self.fits.get(names, self.nats(start))
        misfit = float(data @ data) - 2 * gained
        return SimpleNamespace(effects=extended.catalogue_effects, extended=extended, misfit=misfit)

    def joint_density_from_best_start(self, timeline, plant_model, original, warm_start):
        return plant_model, SimpleNamespace(log_evidence=self.nats(plant_model.catalogue_effects))

    def doubled_strength_start(self, timeline, plant_model, refitted, original, warm_start):
        return plant_model, refitted

    def fit_explanation(self, timeline, plant_model, original, refitted, rounds):
        return Explanation(plant_model.catalogue_effects, plant_model, refitted)

    def with_strengths_maximised(self, timeline, original, found):
        return SimpleNamespace(effects=found.effects), found

    def evidence_without_one(self, timeline, best, warm_start):
        return self.left.get(" ".join(best.names), float("-inf"))

    def critique(self, plant_model) -> Any:
        self.judged.append(" ".join(sorted(e.kind.name for e in plant_model.catalogue_effects)))
        kinds = [KINDS[name] for name in self.starts]
        scores = [
            SimpleNamespace(
                candidate=SimpleNamespace(kind=kind, best=lambda data, kind=kind: (kind(), 1.0)),
            )
            for kind in kinds
        ]
        return SimpleNamespace(
            timeline=None,
            plant_model=plant_model,
            silent=self.judged[-1] in self.enough,
            refitted=SimpleNamespace(data=DATA, coupled=1 if self.of_channel else DATA.size),
            scores=scores,
            best=lambda count: scores[:count],
        )

    def search_explanations(self, evidence=0.0, known=(), **settings):
        """Names of the best of each level, with its gain."""
        first = self.critique(PlantModel(WIRE, ORIGINAL, "negative", known))
        levels = search_explanations(first, ORIGINAL, self.critique, evidence, **settings).levels
        return [(" ".join(level.explanations[0].names), level.gain) for level in levels]


@pytest.mark.parametrize(
    ("nats", "gate", "levels"), [(17.0, 18.0, 0), (19.0, 18.0, 1), (24.0, 25.0, 0), (26.0, 25.0, 1)]
)
def test_the_first_effect_is_worth_its_name_from_the_gate_on(monkeypatch, nats, gate, levels):
    world = World(monkeypatch, {"walking": 500 + nats})
    assert world.search_explanations(500.0, gate=gate) == [("walking", nats)][:levels]


@pytest.mark.parametrize(
    ("first", "more", "levels"),
    [(100, 20, 1), (100, 24, 1), (100, 26, 2), (800, 38, 1), (800, 42, 2), (5000, 58, 1), (5000, 62, 2)],
)
def test_a_further_effect_must_be_worth_more_than_the_first_and_more_the_larger_that_is(
    monkeypatch, first, more, levels
):
    """25 nats at least, a twentieth of the first one's where that is more, never more than 60."""
    world = World(monkeypatch, {"walking": first, "settling walking": first + more})
    assert world.search_explanations() == [("walking", first), ("settling walking", more)][:levels]


@pytest.mark.parametrize(
    ("fit", "gate", "levels"), [(3.4, 18.0, 0), (3.8, 18.0, 1), (4.8, 25.0, 0), (5.2, 25.0, 1)]
)
def test_a_fit_that_gains_less_than_a_fifth_of_the_gate_ends_the_search(monkeypatch, fit, gate, levels):
    world = World(monkeypatch, {"walking": 40.0}, fits={"walking": fit})
    assert world.search_explanations(gate=gate) == [("walking", 40.0)][:levels]


def test_a_channel_that_shows_an_effect_keeps_the_search_going(monkeypatch):
    world = World(monkeypatch, {"walking": 40.0}, fits={"walking": 3.4}, of_channel={"walking": 0.2})
    found = world.search_explanations()
    assert [names for names, _ in found] == ["walking"]


def test_an_effect_that_is_a_part_of_a_density_is_not_tried(monkeypatch):
    """However much it gains: r_phase, between effects that are tried."""
    world = World(monkeypatch, {"r_phase": 900.0, "walking": 100.0}, starts=("r_phase", "walking"))
    assert world.search_explanations() == [("walking", 100.0)]
    assert not any("r_phase" in names for names in world.judged)


def test_what_the_density_of_all_explains_without_an_effect_is_not_the_effects(monkeypatch):
    """40 nats likelier than before; 30 of them are there without walking."""
    worth = {"walking": 40.0}
    assert World(monkeypatch, worth, {"walking": 30.0}).search_explanations() == []
    assert World(monkeypatch, worth, {"walking": 20.0}).search_explanations() == [("walking", 20.0)]


def test_nor_is_it_a_further_effects(monkeypatch):
    worth = {"walking": 100.0, "settling walking": 160.0}
    assert World(monkeypatch, worth, {"settling walking": 150.0}).search_explanations() == [
        ("walking", 100.0)
    ]
    both = World(monkeypatch, worth, {"settling walking": 130.0}).search_explanations()
    assert both == [("walking", 100.0), ("settling walking", 30.0)]


def test_a_density_that_goes_with_an_effect_only_makes_it_no_dearer(monkeypatch):
    """Without the effect that density explains less than another would."""
    assert World(monkeypatch, {"walking": 40.0}, {"walking": -500.0}).search_explanations() == [
        ("walking", 40.0)
    ]


def test_the_search_ends_where_nothing_stands_out_any_more(monkeypatch):
    worth = {"walking": 100.0, "settling walking": 300.0}
    assert len(World(monkeypatch, worth).search_explanations()) == 2
    assert World(monkeypatch, worth, enough=("walking",)).search_explanations() == [("walking", 100.0)]


@pytest.mark.parametrize("most", [1, 2, 3])
def test_there_are_no_more_effects_than_may_be(monkeypatch, most):
    worth = {"walking": 100.0, "settling walking": 200.0, "settling slip walking": 300.0}
    worth["fatigue settling slip walking"] = 400.0
    assert len(World(monkeypatch, worth).search_explanations(most=most)) == most


@pytest.mark.parametrize(("rival", "outdone"), [(117.0, False), (119.0, True)])
def test_a_much_likelier_rival_ends_the_search(monkeypatch, rival, outdone):
    """The rival is more than 18 nats ahead, so nothing is evaluated again."""
    world = World(monkeypatch, {"walking": 100.0})
    if outdone:
        with pytest.raises(BelowRivalEvidence):
            world.search_explanations(rival=rival)
        assert world.judged == [""]
    else:
        assert world.search_explanations(rival=rival) == [("walking", 100.0)]


def test_explanations_are_sorted_by_evidence_and_the_linear_gain_is_kept(monkeypatch):
    world = World(monkeypatch, {"walking": 60.0, "slip": 90.0, "settling": 75.0})
    first = world.critique(PlantModel(WIRE, ORIGINAL, "negative"))
    (level,) = search_explanations(first, ORIGINAL, world.critique, 10.0, tried=3).levels
    assert [e.names for e in level.explanations] == [("slip",), ("settling",), ("walking",)]
    assert [level.lead(k) for k in range(3)] == [0.0, 15.0, 30.0]
    assert (level.gain, level.linear_gain) == (80.0, 90.0)


def test_no_more_effects_are_tried_than_requested(monkeypatch):
    world = World(monkeypatch, {"walking": 60.0, "fatigue": 90.0})
    assert world.search_explanations(tried=4) == [("fatigue", 90.0)]
    assert world.search_explanations(tried=3) == [("walking", 60.0)]


def test_a_candidate_that_stood_out_is_tried_together_with_an_effect_that_hides_it(monkeypatch):
    """Beside walking nothing but slip stands out."""
    world = World(monkeypatch, {"walking": 100.0, "settling walking": 200.0}, enough=("settling walking",))
    first = world.critique(PlantModel(WIRE, ORIGINAL, "negative"))
    world.starts = ("slip",)
    levels = search_explanations(first, ORIGINAL, world.critique, 0.0).levels
    assert [level.explanations[0].names for level in levels] == [("walking",), ("settling", "walking")]


def test_effects_that_are_known_are_part_of_every_start(monkeypatch):
    world = World(monkeypatch, {"fatigue walking": 50.0, "walking": 500.0}, starts=("walking", "slip"))
    assert world.search_explanations(known=(fatigue(),)) == [("fatigue walking", 50.0)]


class OneStrength(World):
    """Only the true strength, 0.5, explains anything; a fit to all readings does not reach it."""

    def nats(self, effects):
        return 400.0 if any(e.strength == 0.5 for e in effects) else 3.0 * bool(effects)


def test_a_strength_that_a_channel_shows_by_itself_is_a_start(monkeypatch):
    """A density that was identified without the effect keeps the positions from showing it."""
    found = OneStrength(monkeypatch, {}, of_channel={"walking": 0.5}).search_explanations()
    assert found[0] == ("walking", 400.0)
    assert OneStrength(monkeypatch, {}).search_explanations() == []


def test_of_several_fits_of_the_same_effects_the_likeliest_stays(monkeypatch):
    world = OneStrength(monkeypatch, {}, of_channel={"walking": 0.5, "slip": 0.5}, starts=("walking", "slip"))
    first = world.critique(PlantModel(WIRE, ORIGINAL, "negative"))
    (level, *_) = search_explanations(first, ORIGINAL, world.critique, 0.0, most=1).levels
    assert sorted(e.names for e in level.explanations) == [("slip",), ("walking",)]
    assert {e.evidence for e in level.explanations} == {400.0}


@pytest.mark.parametrize(("first", "more", "levels"), [(1e7, 90.0, 1), (1e7, 110.0, 2)])
def test_beside_a_huge_gain_a_further_effect_must_exceed_its_numerics(monkeypatch, first, more, levels):
    """A hundred-thousandth of the first one's gain."""
    world = World(monkeypatch, {"walking": first, "settling walking": first + more})
    assert len(world.search_explanations()) == levels


@pytest.mark.parametrize(("more", "levels"), [(5.0, 1), (7.0, 2)])
def test_a_further_effect_that_fits_hardly_better_is_not_evaluated(monkeypatch, more, levels):
    worth, fits = {"walking": 100.0, "settling walking": 160.0}, {"settling walking": 100.0 + more}
    assert len(World(monkeypatch, worth, fits=fits).search_explanations()) == levels


@pytest.mark.parametrize(
    ("worth", "is_clear"),
    [
        ({"walking": 17.0, "slip": 3.0}, True),
        ({"walking": 17.0, "slip": 8.0}, False),  # another does as well
        ({"walking": 9.0, "slip": 0.0}, False),  # hardly better than none
    ],
)
def test_an_effect_short_of_a_name_is_told_as_the_nearest(monkeypatch, worth, is_clear):
    world = World(monkeypatch, worth)
    first = world.critique(PlantModel(WIRE, ORIGINAL, "negative", ()))
    found = search_explanations(first, ORIGINAL, world.critique, 0.0)
    assert found.levels == []
    assert found.nearest is not None
    assert found.nearest.effect.kind is walking
    assert (found.nearest.gain, found.nearest.required) == (worth["walking"], 18.0)
    assert found.nearest.lead == worth["walking"] - worth["slip"]
    assert found.nearest.is_clear == is_clear


def test_the_nearest_effect_is_none_of_those_that_the_given_model_has(monkeypatch):
    world = World(monkeypatch, {"fatigue walking": 17.0})
    first = world.critique(PlantModel(WIRE, ORIGINAL, "negative", (fatigue(),)))
    found = search_explanations(first, ORIGINAL, world.critique, 0.0)
    assert found.nearest is not None
    assert found.nearest.effect.kind is walking

"""The choice of the density: positive, unless a signed density is likelier than all explanations."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from smarig.diagnosis.explain import signed_density
from smarig.diagnosis.explain.search import (
    MIN_GAIN_NATS,
    MIN_GAIN_SILENT_NATS,
    SINGLE_TRIED,
    SINGLE_TRIED_IF_SILENT,
    BelowRivalEvidence,
    SearchResult,
)
from smarig.diagnosis.explain.signed_density import find_explanations

from smarig.plant.effects.walking import walking
from smarig.replay import PlantModel

WIRE: Any = None
ORIGINAL: Any = "the model's"
PLAIN = 1000.0  # nats of the positive density without effects
NEVER = float("-inf")


class World:
    """Likelihoods of the densities, and the results of a search with each."""

    def __init__(
        self,
        monkeypatch,
        signed,
        single=NEVER,
        several=None,
        beside=NEVER,
        silent=False,
        loud=False,
    ):
        self.signed, self.single, self.several, self.beside = signed, single, several or single, beside
        self.silent, self.loud = silent, loud
        self.timeline: Any = SimpleNamespace(drive=None)
        self.searches, self.densities, self.critiques, self.said = [], [], [], []
        monkeypatch.setattr(
            signed_density, "joint_density_from_best_start", self.joint_density_from_best_start
        )
        monkeypatch.setattr(signed_density, "search_explanations", self.search_explanations)

    def joint_density_from_best_start(self, timeline, plant_model, original):
        assert (timeline, original) == (self.timeline, ORIGINAL)
        self.densities.append("signed" if plant_model.signed else "positive")
        density = replace(plant_model, hysteresis=self.densities[-1])
        return density, SimpleNamespace(log_evidence=self.signed if plant_model.signed else PLAIN)

    def criticise(self, plant_model, warm_start=None, all_nuisances=False, noise_of=None) -> Any:
        quiet = self.silent and not all_nuisances and not (noise_of and self.loud)
        made = SimpleNamespace(
            silent=quiet,
            plant_model=plant_model,
            warm_start=warm_start,
            all_nuisances=all_nuisances,
            noise_of=noise_of,
        )
        self.critiques.append(made)
        return made

    def search_explanations(
        self, first, original, criticise, evidence, gate=MIN_GAIN_NATS, tried=SINGLE_TRIED, rival=NEVER
    ):
        plant_model = first.plant_model
        assert original == ORIGINAL
        assert evidence == (self.signed if plant_model.signed else PLAIN)
        self.searches.append((plant_model.hysteresis, gate, tried, rival))
        single, best = (self.beside, self.beside) if plant_model.signed else (self.single, self.several)
        if first.silent or single - evidence < gate:
            return SearchResult([])
        if single < rival - MIN_GAIN_NATS:
            raise BelowRivalEvidence
        after = criticise(replace(plant_model, effects=(walking(0.3),)))
        level: Any = SimpleNamespace(critique=after, explanations=(SimpleNamespace(evidence=best),))
        return SearchResult([level])

    def find_explanations(self) -> Any:
        """The result, and the densities that were searched, in order."""
        plant_model = PlantModel(WIRE, ORIGINAL, "negative")
        seen = find_explanations(self.timeline, plant_model, self.criticise, self.said.append)
        assert seen.base.signed == (seen.base.hysteresis == "signed")
        assert seen.first.plant_model is seen.base
        assert seen.plain.log_evidence == (self.signed if seen.base.signed else PLAIN)
        return seen, [search[0] for search in self.searches]


def best_evidence(seen):
    """Nats of the best explanation, None where nothing is found."""
    return seen.levels[-1].explanations[0].evidence if seen.levels else None


@pytest.mark.parametrize("signed", [900.0, 1100.0])
def test_the_positive_density_is_kept_where_its_explanation_is_as_likely(monkeypatch, signed):
    seen, searches = World(monkeypatch, signed, single=1100.0).find_explanations()
    assert (seen.base.hysteresis, best_evidence(seen)) == ("positive", 1100.0)
    assert searches == ["positive"]


@pytest.mark.parametrize("more", [-20.0, 17.0, 18.0])
def test_it_is_kept_alone_if_the_signed_density_gains_too_little(monkeypatch, more):
    """That takes more than 18 nats."""
    seen, searches = World(monkeypatch, PLAIN + more, single=PLAIN + 5.0).find_explanations()
    assert (seen.base.hysteresis, seen.levels) == ("positive", [])
    assert searches == ["positive"]


@pytest.mark.parametrize(("beside", "best"), [(1115.0, None), (1200.0, 1200.0)])
def test_the_signed_density_is_chosen_where_it_is_likelier_than_all_explanations(monkeypatch, beside, best):
    world = World(monkeypatch, 1110.0, single=1100.0, beside=beside)
    seen, searches = world.find_explanations()
    assert (seen.base.hysteresis, best_evidence(seen)) == ("signed", best)
    assert searches == ["positive", "signed"]
    assert world.said.count("Comparing with densities that may be negative") == 1


def test_it_is_chosen_where_no_effect_explains_anything_with_the_other(monkeypatch):
    seen, searches = World(monkeypatch, PLAIN + 19.0, single=PLAIN + 5.0).find_explanations()
    assert (seen.base.hysteresis, seen.levels) == ("signed", [])
    assert searches == ["positive", "signed"]


def test_a_search_with_the_positive_density_gets_the_rival_evidence_and_the_other_none(monkeypatch):
    world = World(monkeypatch, 1110.0, single=1100.0, beside=1200.0)
    world.find_explanations()
    assert [rival for *_, rival in world.searches] == [1110.0, NEVER]
    assert {(gate, tried) for _, gate, tried, _ in world.searches} == {(MIN_GAIN_NATS, SINGLE_TRIED)}


def test_with_a_density_below_its_rival_no_more_is_searched_where_the_other_leaves_nothing(monkeypatch):
    seen, searches = World(monkeypatch, 1500.0, single=1100.0, several=9999.0).find_explanations()
    assert (seen.base.hysteresis, seen.levels) == ("signed", [])
    assert searches == ["positive", "signed"]


@pytest.mark.parametrize(
    ("several", "density"), [(1499.0, "signed"), (1500.0, "positive"), (1700.0, "positive")]
)
def test_a_density_below_its_rival_is_searched_in_full_where_something_is_left_with_the_other(
    monkeypatch, several, density
):
    """The likelier one wins: several effects with one density, or the other density alone."""
    world = World(monkeypatch, 1500.0, single=1100.0, several=several, beside=1600.0)
    seen, searches = world.find_explanations()
    assert seen.base.hysteresis == density
    assert best_evidence(seen) == (1600.0 if density == "signed" else several)
    assert searches == ["positive", "signed", "positive"]
    assert [rival for *_, rival in world.searches] == [1500.0, NEVER, NEVER]


@pytest.mark.parametrize(
    ("single", "loud"),
    [(1024.0, True), (1100.0, False)],
    ids=["nothing is found", "what is found is not loud"],
)
def test_a_verdict_without_finding_stays_so_for_any_gain_of_the_signed_density(monkeypatch, single, loud):
    """Unless wary eyes find something beyond doubt, which stands out of the noise that it leaves."""
    world = World(monkeypatch, 9999.0, single, silent=True, loud=loud)
    seen, searches = world.find_explanations()
    assert (seen.base.hysteresis, seen.levels) == ("positive", [])
    assert seen.first is world.critiques[0]
    assert seen.first.silent
    assert searches == world.densities == ["positive"]
    assert world.searches == [("positive", MIN_GAIN_SILENT_NATS, SINGLE_TRIED_IF_SILENT, NEVER)]


@pytest.mark.parametrize(
    ("signed", "density", "best"), [(1100.0, "positive", 1100.0), (1101.0, "signed", 1200.0)]
)
def test_a_large_effect_that_passed_for_noise_is_found_and_must_beat_the_signed_density_too(
    monkeypatch, signed, density, best
):
    world = World(monkeypatch, signed, single=1100.0, beside=1200.0, silent=True, loud=True)
    seen, searches = world.find_explanations()
    assert (seen.base.hysteresis, best_evidence(seen)) == (density, best)
    assert not seen.first.silent
    assert seen.first.noise_of is seen.levels[0].critique
    assert searches == ["positive", "signed"][: 1 + (density == "signed")]
    assert {(gate, tried) for _, gate, tried, _ in world.searches} == {
        (MIN_GAIN_SILENT_NATS, SINGLE_TRIED_IF_SILENT)
    }


def test_a_critique_in_a_search_starts_from_the_first_noise_and_is_reported(monkeypatch):
    world = World(monkeypatch, 900.0, single=1100.0)
    world.find_explanations()
    first, after = world.critiques
    assert after.warm_start is first
    assert world.said == ["with walking"]

"""Which density is believed: a positive one, unless one that is negative somewhere is likelier than all it explains."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from smarig.diagnosis import either_density
from smarig.diagnosis.either_density import found
from smarig.diagnosis.search import DOUBTED, GATE, GATE_SILENT, TRIED, Outdone
from smarig.model.effects.walking import walking
from smarig.story.subject import Subject

WIRE: Any = None
GIVEN: Any = "the model's"
PLAIN = 1000.0  # nats of the positive density without effects
NEVER = float("-inf")


class World:
    """How likely the densities are, and what a search finds beside each.

    ``signed``: nats of the density that may be negative. ``single`` and ``several``: those that one effect and that
    more of them reach beside the positive density, ``beside`` beside the signed one. ``silent``: nothing stands out,
    unless noise is as little as may be, and what is found then is ``loud`` or not in the noise that it leaves.
    Searches, densities, critiques and what is said are kept.
    """

    def __init__(
        self,
        monkeypatch,
        signed,
        single=NEVER,
        several=None,
        beside=NEVER,
        given="",
        silent=False,
        loud=False,
    ):
        self.signed, self.single, self.several, self.beside = signed, single, several or single, beside
        self.silent, self.loud = silent, loud
        self.story: Any = SimpleNamespace(given=given)
        self.searches, self.densities, self.critiques, self.said = [], [], [], []
        monkeypatch.setattr(either_density, "density_anew", self.density_anew)
        monkeypatch.setattr(either_density, "searched", self.searched)

    def density_anew(self, story, subject, given):
        assert (story, given) == (self.story, GIVEN)
        self.densities.append("signed" if subject.signed else "positive")
        density = replace(subject, hysteresis=self.densities[-1])
        return density, SimpleNamespace(log_evidence=self.signed if subject.signed else PLAIN)

    def judge(self, subject, like=None, wary=False, noise_of=None) -> Any:
        quiet = self.silent and not wary and not (noise_of and self.loud)
        made = SimpleNamespace(silent=quiet, subject=subject, like=like, wary=wary, noise_of=noise_of)
        self.critiques.append(made)
        return made

    def searched(self, first, given, judge, evidence, gate=GATE, tried=TRIED, rival=NEVER):
        subject = first.subject
        assert given == GIVEN
        assert evidence == (self.signed if subject.signed else PLAIN)
        self.searches.append((subject.hysteresis, gate, tried, rival))
        single, best = (self.beside, self.beside) if subject.signed else (self.single, self.several)
        if first.silent or single - evidence < gate:
            return []
        if single < rival - GATE:
            raise Outdone
        after = judge(replace(subject, effects=(walking(0.3),)))
        return [SimpleNamespace(critique=after, explanations=(SimpleNamespace(evidence=best),))]

    def found(self) -> Any:
        """What is found, and the densities beside which was searched, in turn."""
        subject = Subject(WIRE, GIVEN, "negative")
        seen = found(self.story, subject, self.judge, self.said.append)
        assert seen.base.signed == (seen.base.hysteresis == "signed")
        assert seen.first.subject is seen.base
        assert seen.plain.log_evidence == (self.signed if seen.base.signed else PLAIN)
        return seen, [search[0] for search in self.searches]


def explained(seen):
    """Nats of the best explanation, None where nothing is found."""
    return seen.levels[-1].explanations[0].evidence if seen.levels else None


@pytest.mark.parametrize("signed", [900.0, 1100.0])
def test_the_positive_density_is_kept_where_its_explanation_is_as_likely(monkeypatch, signed):
    seen, searches = World(monkeypatch, signed, single=1100.0).found()
    assert (seen.base.hysteresis, explained(seen)) == ("positive", 1100.0)
    assert searches == ["positive"]


@pytest.mark.parametrize("more", [-20.0, 17.0, 18.0])
def test_it_is_kept_with_nothing_beside_it_where_the_signed_one_is_worth_no_name(monkeypatch, more):
    """That takes more than 18 nats."""
    seen, searches = World(monkeypatch, PLAIN + more, single=PLAIN + 5.0).found()
    assert (seen.base.hysteresis, seen.levels) == ("positive", [])
    assert searches == ["positive"]


@pytest.mark.parametrize(("beside", "best"), [(1115.0, None), (1200.0, 1200.0)])
def test_the_signed_density_is_believed_where_it_is_likelier_than_all_that_explains(
    monkeypatch, beside, best
):
    world = World(monkeypatch, 1110.0, single=1100.0, beside=beside)
    seen, searches = world.found()
    assert (seen.base.hysteresis, explained(seen)) == ("signed", best)
    assert searches == ["positive", "signed"]
    assert world.said.count("with a density that is negative somewhere") == 1


def test_it_is_believed_where_nothing_explains_anything_beside_the_other(monkeypatch):
    seen, searches = World(monkeypatch, PLAIN + 19.0, single=PLAIN + 5.0).found()
    assert (seen.base.hysteresis, seen.levels) == ("signed", [])
    assert searches == ["positive", "signed"]


def test_a_search_beside_the_positive_density_knows_its_rival_and_the_other_has_none(monkeypatch):
    world = World(monkeypatch, 1110.0, single=1100.0, beside=1200.0)
    world.found()
    assert [rival for *_, rival in world.searches] == [1110.0, NEVER]
    assert {(gate, tried) for _, gate, tried, _ in world.searches} == {(GATE, TRIED)}


def test_beside_an_outdone_density_nothing_more_is_searched_where_the_other_leaves_nothing(monkeypatch):
    seen, searches = World(monkeypatch, 1500.0, single=1100.0, several=9999.0).found()
    assert (seen.base.hysteresis, seen.levels) == ("signed", [])
    assert searches == ["positive", "signed"]


@pytest.mark.parametrize(
    ("several", "density"), [(1499.0, "signed"), (1500.0, "positive"), (1700.0, "positive")]
)
def test_an_outdone_density_is_searched_in_full_where_something_is_left_beside_the_other(
    monkeypatch, several, density
):
    """And then the likelier wins: several effects beside the one, or the other by itself."""
    world = World(monkeypatch, 1500.0, single=1100.0, several=several, beside=1600.0)
    seen, searches = world.found()
    assert seen.base.hysteresis == density
    assert explained(seen) == (1600.0 if density == "signed" else several)
    assert searches == ["positive", "signed", "positive"]
    assert [rival for *_, rival in world.searches] == [1500.0, NEVER, NEVER]


@pytest.mark.parametrize(
    ("single", "loud"),
    [(1024.0, True), (1100.0, False)],
    ids=["nothing is found", "what is found is not loud"],
)
def test_what_is_silent_stays_so_whatever_the_signed_density_is_worth(monkeypatch, single, loud):
    """Unless wary eyes find something beyond doubt, which stands out of the noise that it leaves."""
    world = World(monkeypatch, 9999.0, single, silent=True, loud=loud)
    seen, searches = world.found()
    assert (seen.base.hysteresis, seen.levels) == ("positive", [])
    assert seen.first is world.critiques[0]
    assert seen.first.silent
    assert searches == world.densities == ["positive"]
    assert world.searches == [("positive", GATE_SILENT, DOUBTED, NEVER)]


@pytest.mark.parametrize(
    ("signed", "density", "best"), [(1100.0, "positive", 1100.0), (1101.0, "signed", 1200.0)]
)
def test_a_large_effect_that_passed_for_noise_is_found_and_must_beat_the_signed_density_too(
    monkeypatch, signed, density, best
):
    world = World(monkeypatch, signed, single=1100.0, beside=1200.0, silent=True, loud=True)
    seen, searches = world.found()
    assert (seen.base.hysteresis, explained(seen)) == (density, best)
    assert not seen.first.silent
    assert seen.first.noise_of is seen.levels[0].critique
    assert searches == ["positive", "signed"][: 1 + (density == "signed")]
    assert {(gate, tried) for _, gate, tried, _ in world.searches} == {(GATE_SILENT, DOUBTED)}


@pytest.mark.parametrize(("silent", "loud"), [(False, False), (True, False), (True, True)])
def test_where_the_input_was_measured_no_signed_density_is_tried(monkeypatch, silent, loud):
    world = World(monkeypatch, 9999.0, single=1100.0, given="clock", silent=silent, loud=loud)
    seen, searches = world.found()
    assert explained(seen) == (None if silent and not loud else 1100.0)
    assert searches == world.densities == ["positive"]
    assert world.searches[0][-1] == NEVER


def test_what_a_search_judges_has_noise_like_the_first_critiques_and_is_said(monkeypatch):
    world = World(monkeypatch, 900.0, single=1100.0)
    world.found()
    first, after = world.critiques
    assert after.like is first
    assert world.said == ["with walking"]

"""Verdicts on findings made by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from smarig.diagnosis.critique.candidates import Candidate
from smarig.diagnosis.critique.critique import CandidateScore, Critique
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict, decide_verdict

from smarig.plant.effects.settling import settling
from smarig.plant.effects.walking import walking

THRESHOLD = 3.0
DATA = np.array([10.0, 0.0, 0.0, 0.0])  # 50 nats are in them


def score(candidate, nats, spread=2.0):
    """A score that gains so many nats beyond chance; its null's 95 % point is ``spread`` above the median."""
    return CandidateScore(candidate, nats + 1.0, 1.0, 1.0 + spread)


def name(kind, nats, *, seen=True):
    """A named candidate that gains so much; its trace has nothing to do with the data."""
    traces = np.eye(4)[:, 1:2] if seen else np.empty((4, 0))
    return score(Candidate(kind.name, traces, kind, (kind(),) if seen else ()), nats)


def variable(depends_on, nats, share=0.0):
    """A variable that gains so much and takes up this share of the data."""
    trace = np.array([[np.sqrt(share)], [0.0], [np.sqrt(1 - share)], [0.0]])
    return score(Candidate(f"?{depends_on}", trace, depends_on=depends_on), nats)


def critique(*scores):
    refitted = SimpleNamespace(data=DATA)
    return Critique(None, None, None, refitted, scores, (), THRESHOLD, 0.01, 0.01, THRESHOLD)


QUIET = critique(name(walking, 0.5), variable("time", 1.0))


def level(*explanations, after=QUIET, gain=40.0):
    """Explanations as (names, nats behind the best), best first; what the best gains, straight lines see too."""
    found = tuple(SimpleNamespace(names=names) for names, _ in explanations)
    leads = [lead for _, lead in explanations]
    return SimpleNamespace(
        critique=after, explanations=found, lead=leads.__getitem__, gain=gain, linear_gain=gain
    )


def loud(*variables):
    return critique(name(walking, 30.0), *variables)


def test_nothing_stands_out():
    assert decide_verdict(QUIET, []) == DiagnosisVerdict("silent")


def test_nothing_could_have_stood_out():
    blind = critique(name(walking, 0.0, seen=False), name(settling, 0.0, seen=False), variable("time", 1.0))
    assert decide_verdict(blind, []) == DiagnosisVerdict("not_identifiable")


def test_one_explanation_far_ahead_is_a_name():
    found = decide_verdict(loud(), [level((("walking",), 0.0), (("slip",), 40.0))])
    assert (found.word, found.names, found.depends_on) == ("named", ("walking",), None)
    assert found.probability("walking") > 0.99


def test_two_effects_together_are_named_together():
    found = decide_verdict(
        loud(), [level((("walking",), 0.0)), level((("settling", "walking"), 0.0), (("walking",), 60.0))]
    )
    assert (found.word, set(found.names)) == ("named", {"settling", "walking"})


def test_rivals_close_behind_are_a_set():
    found = decide_verdict(loud(), [level((("walking",), 0.0), (("slip",), 1.0), (("fatigue",), 50.0))])
    assert found.word == "ambiguous"
    assert found.names == ("walking", "slip")


def test_only_the_last_level_decides():
    first = level((("walking",), 0.0), (("slip",), 0.5))
    last = level((("settling", "walking"), 0.0), (("creep", "walking"), 80.0))
    assert decide_verdict(loud(), [first, last]).word == "named"


def test_something_stands_out_that_no_name_explains():
    found = decide_verdict(loud(variable("time", 35.0), variable("hold", 40.0)), [])
    assert found == DiagnosisVerdict("unknown", depends_on="hold")


def test_a_small_unnamed_deviation_is_not_reported():
    """Neither names nor variables gain enough."""
    assert decide_verdict(loud(variable("time", 11.0)), []) == DiagnosisVerdict("silent")


def test_a_variable_must_stand_out_as_well_as_gain():
    wide = score(Candidate("?time", np.eye(4)[:, 2:3], depends_on="time"), 20.0, spread=10.0)
    assert decide_verdict(loud(wide), []) == DiagnosisVerdict("silent")


@pytest.mark.parametrize(("share", "word"), [(0.9, "unknown"), (0.1, "named")])
def test_a_variable_that_explains_much_more_than_any_name_is_no_names(share, word):
    """45 or 5 nats of 50, less 1 by chance, against 20 by the best name."""
    found = decide_verdict(loud(variable("hold", 35.0, share)), [level((("walking",), 0.0), gain=20.0)])
    assert found.word == word
    assert found.depends_on == ("hold" if word == "unknown" else None)
    assert found.explanations[0][0] == ("walking",)  # the nearest there is


@pytest.mark.parametrize(
    ("left", "other", "word"), [(55.0, 0.5, "unknown"), (55.0, 50.0, "named"), (35.0, 0.5, "named")]
)
def test_much_that_is_left_when_all_names_are_in_is_no_names(left, other, word):
    """Unless another name would explain nearly as much of it; and a little is nothing."""
    still = score(Candidate("?hold", np.eye(4)[:, 2:3], depends_on="hold"), left)
    after = critique(name(settling, other), still)
    found = decide_verdict(
        loud(variable("time", 35.0)), [level((("walking",), 0.0), after=after, gain=400.0)]
    )
    assert (found.word, found.depends_on) == (word, "time" if word == "unknown" else None)


def test_the_remainder_names_its_variable_where_the_first_critique_had_none():
    """An amplifier's dead zone hides behind a gain: straight lines see no variable until that is in."""
    still = score(Candidate("?level", np.eye(4)[:, 2:3], depends_on="level"), 55.0)
    found = decide_verdict(loud(), [level((("walking",), 0.0), after=critique(name(settling, 0.5), still))])
    assert (found.word, found.depends_on) == ("unknown", "level")


LEADS = (
    (("walking",), 0.0),
    (("slip",), 3.0),
    (("fatigue",), 5.0),
    (("ambient_drift",), 12.0),
    (("creep",), 30.0),
)


def test_probabilities_sum_to_one_in_the_order_of_their_leads():
    found = decide_verdict(loud(), [level(*LEADS)])
    p = [probability for _, probability in found.explanations]
    assert [names for names, _ in found.explanations] == [names for names, _ in LEADS]
    assert sum(p) == pytest.approx(1.0)
    assert np.all(np.diff(p) < 0)
    nats = np.diff(np.log(p)) / np.diff([lead for _, lead in LEADS])
    np.testing.assert_allclose(nats, nats[0])  # one temperature for all
    assert -1 < nats[0] < 0  # and none is surer than its likelihood


def test_the_set_is_the_least_that_holds_nine_tenths():
    found = decide_verdict(loud(), [level(*LEADS)])
    p = dict(found.explanations)
    inside = [p[(n,)] for n in found.names]
    assert sum(inside) >= 0.9 > sum(inside[:-1])


def test_the_same_effects_found_twice_count_once_at_their_best():
    twice = decide_verdict(loud(), [level((("walking",), 0.0), (("slip",), 4.0), (("walking",), 1.0))])
    once = decide_verdict(loud(), [level((("walking",), 0.0), (("slip",), 4.0))])
    assert twice.explanations == once.explanations


def test_an_effects_probability_is_the_sum_over_the_explanations_it_is_part_of():
    found = DiagnosisVerdict("ambiguous", ((("a", "b"), 0.5), (("a", "c"), 0.3), (("c",), 0.2)))
    assert found.probability("a") == pytest.approx(0.8)
    assert found.probability("c") == pytest.approx(0.5)
    assert found.probability("d") == 0
    assert set(found.names) == {"a", "b", "c"}


@pytest.mark.parametrize(
    ("lead", "gain", "word"),
    [
        (12.0, 40.0, "named"),
        (12.0, 300.0, "named"),
        (12.0, 1400.0, "ambiguous"),
        (20.0, 1e7, "ambiguous"),
        (30.0, 1e7, "named"),
    ],
)
def test_of_a_large_gain_a_few_nats_decide_nothing(lead, gain, word):
    """Twelve nats are much by chance, and little for equations that are approximations; thirty always decide."""
    found = decide_verdict(loud(), [level((("latent_heat",), 0.0), (("resistance_phase",), lead), gain=gain)])
    assert found.word == word

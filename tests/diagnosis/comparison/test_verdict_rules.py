"""The verdict on probabilities: each rule decides, and alone."""

import pytest

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.verdict_rules import RULES, SENTENCES, VerdictEvidence, decide

LAG, DRIFT = Part("effect", "input_lag"), Part("effect", "output_drift")
RATE, TIME = Part("variable", "rate"), Part("variable", "time")


def verdict(causes=None, nothing=0.0, **changes):
    causes = causes or {LAG: 0.97}
    given = {
        "causes": causes,
        "nothing": nothing,
        "size": dict.fromkeys(causes, 0.1),
        "span": 1.0,
        "error": 0.1,
        "noise": 0.01,
        "remains": dict.fromkeys(causes, 0.01),
        "blocks": 20,
        "acts_through": {LAG: (RATE,), DRIFT: (TIME,)},
    }
    found = decide(VerdictEvidence(**(given | changes)))
    assert found.reason in SENTENCES
    return found


def test_a_likely_cause_is_named():
    assert (verdict().word, verdict().names) == ("named", ("input_lag",))


def test_nothing_is_silent_if_the_model_is_adequate_and_unknown_if_not():
    assert verdict({LAG: 0.2}, 0.8, error=0.02).word == "silent"
    assert verdict({LAG: 0.2}, 0.8, error=0.2).reason == "inadequate"


def test_an_adequate_model_is_called_wrong_only_with_the_certainty_of_a_name():
    assert verdict({LAG: 0.7}, 0.3, error=0.02).word == "silent"
    assert verdict({LAG: 0.7}, 0.3, error=0.2).word == "unknown"
    assert verdict({LAG: 0.95}, 0.05, error=0.02).word == "named"


def test_held_out_runs_beyond_the_limit_of_prediction_end_silence():
    least = RULES["adequate"].value
    assert verdict({LAG: 0.2}, 0.8, error=0.02, beyond_limit=0.9 * least).word == "silent"
    found = verdict({LAG: 0.2}, 0.8, error=0.02, beyond_limit=1.1 * least)
    assert (found.word, found.reason) == ("unknown", "unseen")


def test_what_changes_too_little_is_not_told():
    assert verdict(size={LAG: 0.001}, error=0.02).reason == "too_small"


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"blocks": 4}, "few_blocks"),
        ({"confounded": {LAG: (DRIFT,)}}, "confounded"),
        ({"held_out": {LAG: 1.2}}, "worse"),
        ({"not_borne_out": frozenset({LAG})}, "not_borne_out"),
        ({"remains": {LAG: 0.3}}, "beside"),
        ({"effects_alone": 0.05}, "left_over"),
        ({"effects_alone": 0.3, "least_alone": 0.5}, "left_over"),
        ({"causes": {LAG: 0.97, RATE: 0.95}, "size": {LAG: 0.1, RATE: 0.1}}, "incomplete"),
    ],
)
def test_each_doubt_takes_the_name_away(changes, reason):
    found = verdict(**changes)
    assert found.word != "named"
    assert found.reason == reason


@pytest.mark.parametrize(
    ("beside", "size", "word"),
    [(0.05, 0.1, "named"), (0.6, 0.1, "named"), (0.97, 0.1, "unknown"), (0.97, 0.001, "named")],
)
@pytest.mark.parametrize("least_alone", [0.1, 0.9])  # of data of others, and of commanded runs
def test_a_name_does_not_stand_on_effects_that_remove_too_little_to_be_told(beside, size, word, least_alone):
    found = verdict(
        least_alone=least_alone,
        causes={LAG: 0.97, DRIFT: beside},
        together={frozenset({LAG}): 0.97 - beside, frozenset({LAG, DRIFT}): beside},
        size={LAG: 0.1, DRIFT: size},
        remains={LAG: 0.01, DRIFT: 0.2},
        held_out={LAG: 0.2},
    )
    assert (found.word, found.reason) == (word, "likely" if word == "named" else "with_others")


def test_runs_that_no_fit_has_seen_replace_excursions():
    better = 0.9 * RULES["replaces_blocks"].value
    assert verdict(blocks=3, held_out={LAG: better}).word == "named"
    assert verdict(effects_alone=0.05, held_out={LAG: better}).word == "named"
    assert verdict(blocks=3, held_out={LAG: 1.1 * RULES["replaces_blocks"].value}).word != "named"


def test_one_candidate_is_no_set_but_the_variable_that_it_acts_through():
    found = verdict(blocks=4)
    assert (found.word, found.names, found.depends_on) == ("unknown", ("input_lag",), "rate")


def test_of_several_ways_of_a_candidate_the_likeliest_is_told():
    ways = {LAG: (RATE, TIME)}
    beside = {"size": {LAG: 0.1, TIME: 0.1}, "remains": {LAG: 0.01, TIME: 0.2}}
    found = verdict({LAG: 0.97, TIME: 0.3}, blocks=4, acts_through=ways, **beside)
    assert (found.names, found.depends_on) == (("input_lag",), "time")


def test_effects_that_share_the_weight_are_a_set():
    found = verdict({LAG: 0.55, DRIFT: 0.45})
    assert (found.word, set(found.names)) == ("ambiguous", {"input_lag", "output_drift"})


def test_an_effect_must_remove_more_than_it_leaves_and_a_variable_need_not():
    both = {LAG: 0.55, DRIFT: 0.45}
    found = verdict(both, size=dict.fromkeys(both, 0.1), remains=dict.fromkeys(both, 0.2))
    assert (found.word, found.names, found.reason) == ("unknown", (), "beside")
    assert verdict({TIME: 0.97}, remains={TIME: 0.2}).depends_on == "time"


def test_a_dependence_that_changes_too_little_takes_no_name_away():
    found = verdict({LAG: 0.97, RATE: 0.95}, size={LAG: 0.1, RATE: 0.001})
    assert (found.word, found.names) == ("named", ("input_lag",))


def test_a_set_that_holds_the_truth_less_than_nine_times_of_ten_is_none():
    beside = {"size": {LAG: 0.1, DRIFT: 0.1, TIME: 0.1}, "remains": {LAG: 0.01, DRIFT: 0.01, TIME: 0.2}}
    found = verdict({LAG: 0.4, DRIFT: 0.3, TIME: 0.3}, **beside)
    assert (found.word, set(found.names)) == ("unknown", {"input_lag", "output_drift"})
    assert verdict({LAG: 0.5, DRIFT: 0.45, TIME: 0.05}, **beside).word == "ambiguous"


def test_parts_that_act_together_hold_the_truth_once():
    pair, other = {LAG: 0.5, DRIFT: 0.5}, {TIME: 0.44}
    found = verdict(
        pair | other, 0.06, together={frozenset(pair): 0.5, frozenset(other): 0.44}, acts_through={}
    )
    assert (found.word, found.depends_on) == ("unknown", "time")
    assert verdict(pair, 0.05, together={frozenset({LAG}): 0.45, frozenset({DRIFT}): 0.5}).word == "ambiguous"


@pytest.mark.parametrize(
    ("refuted", "reason"),
    [({"held_out": {LAG: 1.2}}, "worse"), ({"not_borne_out": frozenset({LAG})}, "not_borne_out")],
)
def test_what_held_out_runs_refute_is_no_candidate_of_a_set(refuted, reason):
    found = verdict({LAG: 0.55, DRIFT: 0.45}, **refuted)
    assert (found.word, found.reason) == ("unknown", reason)


def test_a_variable_among_the_likely_causes_makes_the_cause_unknown():
    found = verdict({TIME: 0.6, DRIFT: 0.4})
    assert (found.word, found.depends_on) == ("unknown", "time")


def test_at_most_fifteen_numbers_decide():
    assert len(RULES) <= 15

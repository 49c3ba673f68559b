"""Probabilities of causes from the scores of hypotheses on blocks."""

import numpy as np
import pytest

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.intervals import interval
from smarig.diagnosis.comparison.measured.hypothesis_search import vertex
from smarig.diagnosis.comparison.weights import weigh

LAG, DRIFT, TIME = Part("effect", "input_lag"), Part("effect", "output_drift"), Part("variable", "time")


def hypothesis(parts, scores, **parameters):
    scores = np.asarray(scores, dtype=float)
    return ComparedHypothesis(tuple(parts), (Trial(parameters, scores, np.zeros(scores.size)),))


NOTHING = hypothesis((), np.zeros(20))


def test_equal_scores_leave_the_prior():
    found = weigh([NOTHING, hypothesis([LAG], np.zeros(20)), hypothesis([DRIFT], np.zeros(20))])
    assert found.nothing == pytest.approx(0.5 / 0.9)
    assert found.causes[LAG] == pytest.approx(found.causes[DRIFT])


def test_a_gain_in_all_blocks_is_certain_and_one_in_a_single_block_is_not():
    everywhere, once = np.full(20, 2.0), np.r_[40.0, np.full(19, -0.1)]
    assert weigh([NOTHING, hypothesis([LAG], everywhere)]).causes[LAG] > 0.99
    assert weigh([NOTHING, hypothesis([LAG], once)]).causes[LAG] < 0.99


def test_a_cause_sums_over_the_hypotheses_that_hold_it():
    scores = np.full(20, 2.0)
    found = weigh([NOTHING, hypothesis([LAG], scores), hypothesis([LAG, DRIFT], scores)])
    assert found.causes[LAG] == pytest.approx(1 - found.nothing)
    assert found.causes[DRIFT] < found.causes[LAG]


def test_what_an_effect_explains_as_well_is_the_effects_and_not_the_variables():
    scores = np.full(20, 2.0)
    found = weigh([NOTHING, hypothesis([DRIFT], scores), hypothesis([TIME], scores)])
    assert found.causes[DRIFT] > 0.9 > 0.1 > found.causes[TIME]
    found = weigh([NOTHING, hypothesis([DRIFT], scores), hypothesis([TIME], scores + 1.0)])
    assert found.causes[TIME] > found.causes[DRIFT]


def test_parameters_are_chosen_without_the_block_that_they_are_scored_on():
    a = Trial({"lag_s": 1.0}, np.array([9.0, 0.0, 0.0]), np.zeros(3))
    b = Trial({"lag_s": 2.0}, np.array([0.0, 1.0, 1.0]), np.zeros(3))
    assert ComparedHypothesis((LAG,), (a, b)).log_scores.tolist() == [0.0, 0.0, 0.0]


def test_an_interval_holds_the_top_between_two_coarse_trials():
    lags = np.geomspace(1.0, 16.0, 5)
    trials = [Trial({"lag_s": v}, np.full(20, -5 * np.log(v / 5.2) ** 2), np.zeros(20)) for v in lags]
    lag = ComparedHypothesis((LAG,), tuple(trials))
    low, high = interval(lag, "lag_s", weigh([hypothesis((), np.zeros(20)), lag]))
    assert 4.0 < low < 5.2 < high < 6.8
    assert vertex({t.parameters["lag_s"]: t.score for t in trials}) == pytest.approx(5.2)


def test_an_interval_narrows_with_the_number_of_blocks():
    lags = np.geomspace(1.0, 16.0, 9)

    def width(blocks):
        per_block = -2 * np.log(lags / 4.0) ** 2
        trials = [Trial({"lag_s": v}, np.full(blocks, s), np.zeros(blocks)) for v, s in zip(lags, per_block)]
        lag = ComparedHypothesis((LAG,), tuple(trials))
        low, high = interval(lag, "lag_s", weigh([hypothesis((), np.zeros(blocks)), lag]))
        assert low < 4.0 < high
        return np.log(high / low)

    assert width(50) < 0.5 * width(5)

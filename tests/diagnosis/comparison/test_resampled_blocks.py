"""How far the choice of blocks decides: weights and intervals of resampled blocks against integrals and closed forms.

The weights of blocks are B times a uniform draw from the simplex, so that of one block is B·Beta(1, B − 1), and the
mean of values that the blocks disagree on has the standard deviation of the values over √(B + 1).
"""

import numpy as np
import pytest
from scipy.integrate import quad

from smarig.diagnosis.comparison.commanded.drawn_values import drawn_values
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.intervals import interval
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import PRIOR_NOTHING, PRIOR_SINGLE, TEMPERATURE, weigh

LAG = Part("effect", "input_lag")
DRAWN = 0.04  # two and a half standard deviations of a mean of 1,000 draws between 0 and 1


def weighed(gains):
    """The weights of nothing and of a lag that gains these nats (blocks,) on each block."""
    gains = np.asarray(gains, dtype=float)
    parts = [((), np.zeros(gains.size)), ((LAG,), gains)]
    return weigh([ComparedHypothesis(p, (Trial({}, s, np.zeros(s.size)),)) for p, s in parts])


def probability(nats):
    """Of the lag, from its gain over nothing with all blocks as they are weighed."""
    odds = PRIOR_SINGLE / PRIOR_NOTHING * np.exp(np.clip(nats / TEMPERATURE, -300, 300))
    return odds / (1 + odds)


@pytest.mark.parametrize("gains", [(30, -20), (30, -28), (60, -20), (12, -6), (-40, 60)])
def test_two_blocks_that_disagree_leave_what_their_integral_says(gains):
    one, other = gains
    expected, _ = quad(lambda u: probability(2 * u * one + 2 * (1 - u) * other), 0, 1, limit=200)
    assert weighed(gains).causes[LAG] == pytest.approx(expected, abs=DRAWN)
    assert abs(probability(one + other) - expected) > 2 * DRAWN  # what the blocks as they are would say


@pytest.mark.parametrize("blocks", [5, 10, 20, 40])
def test_a_gain_in_one_block_is_as_likely_as_that_block_is_to_be_drawn(blocks):
    from scipy.stats import beta

    gains = np.r_[40.0, np.full(blocks - 1, -10.0 / (blocks - 1))]
    share = beta(1, blocks - 1)

    def of_share(v):
        return share.pdf(v) * probability(blocks * v * 40.0 - 10.0 * (1 - v) * blocks / (blocks - 1))

    expected = quad(of_share, 0, 0.2)[0] + quad(of_share, 0.2, 1)[0]
    assert weighed(gains).causes[LAG] == pytest.approx(expected, abs=DRAWN)
    assert probability(gains.sum()) > 0.99 > expected + DRAWN


def disagreeing(blocks):
    """A lag whose blocks, sure of it each, disagree; and the standard deviation of its mean."""
    values = 5.0 + np.resize([-1.0, 1.0], blocks)
    tried = np.linspace(3.0, 7.0, 33)
    trials = [Trial({"lag_s": v}, -40.0 * (v - values) ** 2, np.zeros(blocks)) for v in tried.tolist()]
    return ComparedHypothesis((LAG,), tuple(trials)), float(np.std(values) / np.sqrt(blocks + 1))


@pytest.mark.parametrize("blocks", [6, 12, 24])
def test_an_interval_is_as_wide_as_the_blocks_disagree(blocks):
    lag, sd = disagreeing(blocks)
    nothing = ComparedHypothesis((), (Trial({}, np.full(blocks, -1e3), np.zeros(blocks)),))
    low, high = interval(lag, "lag_s", weigh([nothing, lag]))
    assert high - low == pytest.approx(2 * 1.96 * sd, rel=0.25)


@pytest.mark.parametrize("blocks", [6, 12, 24])
def test_drawn_values_scatter_as_the_blocks_disagree(blocks):
    lag, sd = disagreeing(blocks)
    nothing = ComparedHypothesis((), (Trial({}, np.full(blocks, -1e3), np.zeros(blocks)),))
    drawn = drawn_values(lag, "lag_s", weigh([nothing, lag]).shares)
    assert np.std(drawn) == pytest.approx(sd, rel=0.25)


@pytest.mark.parametrize("blocks", [11, 24])
def test_what_one_excursion_says_is_no_name(blocks):
    def word(gains):
        found = weighed(gains)
        evidence = VerdictEvidence(
            causes=found.causes,
            nothing=found.nothing,
            size={LAG: 0.5},
            span=1.0,
            error=0.5,
            noise=0.01,
            blocks=blocks,
            remains={LAG: 0.01},
        )
        return decide(evidence).word

    assert word(np.full(blocks, 20.0 / blocks)) == "named"
    assert word(np.r_[24.0, np.full(blocks - 1, -4.0 / (blocks - 1))]) != "named"

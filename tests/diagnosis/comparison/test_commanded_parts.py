"""Parts of the comparison on commanded runs, by small Gaussian problems with known answers."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.diagnosis.comparison.block_predictions import inverse
from smarig.diagnosis.comparison.commanded.block_scores import Problem
from smarig.diagnosis.comparison.commanded.channel_model import ChannelModel, _basis
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses, _joined
from smarig.diagnosis.comparison.commanded.drawn_values import drawn_values
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import TEMPERATURE, weigh

BLOCK = np.repeat(np.arange(6), 5)
T = np.arange(30.0)
K = 4.0 * np.exp(-np.abs(T[:, None] - T) / 8.0) + 0.1 * np.eye(30)


def problem(scale: float = 1.0) -> tuple[Problem, np.ndarray]:
    y = np.linalg.cholesky(K) @ np.random.default_rng(1).standard_normal(30)
    return Problem(("settled",), y, np.full(30, scale), inverse(K)[0], BLOCK, 1.0), y


@pytest.mark.parametrize("block", range(6))
def test_block_is_predicted_without_itself(block: int) -> None:
    found, y = problem()
    changed = y + np.where(np.equal(BLOCK, block), np.linspace(1, 3, 30), 0.0)
    own = np.equal(BLOCK, block)
    predicted = [(v - found.scores(v, 6)[0])[own] for v in (y, changed)]
    np.testing.assert_allclose(predicted[0], predicted[1], atol=1e-9)
    expected = K[np.ix_(own, ~own)] @ np.linalg.solve(K[np.ix_(~own, ~own)], y[~own])
    np.testing.assert_allclose(predicted[0], expected, atol=1e-9)


def test_scores_are_in_the_unit_of_the_readings() -> None:
    (one, y), (other, _) = problem(), problem(scale=10.0)
    assert one.scores(y, 6)[1].sum() - other.scores(y, 6)[1].sum() == pytest.approx(30 * np.log(10))


def test_hypotheses_under_two_priors_keep_all_trials_and_the_better_model() -> None:
    walking = (Part("effect", "walking"),)

    def searched(nothing: float, own: float, model: str) -> SearchedHypotheses:
        scores = {(): nothing, walking: own}
        trials = {k: Trial({}, np.full(5, v), np.zeros(5)) for k, v in scores.items()}
        hypotheses = tuple(ComparedHypothesis(k, (t,)) for k, t in trials.items())
        return SearchedHypotheses(hypotheses, {walking: model}, ())

    both = _joined(searched(5.0, 1.0, "about base"), searched(2.0, 9.0, "about its own"))
    assert {h.parts: h.score for h in both.hypotheses} == {(): 25.0, walking: 45.0}
    assert both.models == {walking: "about its own"}
    turned = _joined(searched(2.0, 9.0, "about its own"), searched(5.0, 1.0, "about base"))
    assert turned.models == {walking: "about its own"}


def channel(same: np.ndarray) -> ChannelModel:
    free = np.eye(30) - same / same.sum(axis=1)
    return ChannelModel("room", BLOCK, (_basis(same * np.exp(-np.abs(T[:, None] - T) / 3), free),), 1.0)


def test_channel_has_a_free_constant_of_each_session() -> None:
    session = (T >= 15).astype(float)
    same = np.equal.outer(session, session).astype(float)
    y = np.random.default_rng(2).standard_normal(30)
    model = channel(same)
    P, shifted = model.precision(y), model.precision(y + 50 * session)
    np.testing.assert_allclose(P, shifted, atol=1e-9)
    np.testing.assert_allclose(P @ session, 0, atol=1e-9)


def test_channel_that_fluctuates_expects_it() -> None:
    rng, model = np.random.default_rng(3), channel(np.ones((30, 30)))
    kernel = np.exp(-np.abs(T[:, None] - T) / 3)
    y = np.linalg.cholesky(kernel + 1e-4 * np.eye(30)) @ rng.standard_normal(30)
    white = rng.permutation(y)
    steps = np.eye(30)[1:] - np.eye(30)[:-1]

    def expects(
        values: np.ndarray,
    ) -> float:  # variance of a step between neighbours, in shares of the spread
        covariance = np.linalg.pinv(model.precision(values))
        return float(np.trace(steps @ covariance @ steps.T) / 29 / np.var(values))

    assert expects(y) < 0.7 * expects(white)


def parabola(top: np.ndarray, x: np.ndarray) -> ComparedHypothesis:
    trials = tuple(Trial({"a.x": float(v)}, -((v - top) ** 2), np.zeros(top.size)) for v in x)
    return ComparedHypothesis((Part("effect", "a"),), trials)


def test_values_of_a_parameter_lie_about_the_top_of_resampled_blocks() -> None:
    top = np.random.default_rng(4).normal(3.0, 1.0, 20)
    shares = np.random.default_rng(5).dirichlet(np.ones(20), 4000) * 20
    found = drawn_values(parabola(top, np.array([2.2, 2.8, 3.6])), "a.x", shares) - shares @ top / 20
    assert abs(found.mean()) < 0.02
    assert found.std() == pytest.approx(
        np.sqrt(TEMPERATURE / (2 * 20)), rel=0.05
    )  # scores are -20 (x - top)^2


def test_parameter_of_two_trials_is_one_of_them() -> None:
    found = drawn_values(parabola(np.full(5, 3.0), np.array([1.0, 2.5])), "a.x", np.ones((3, 5)))
    np.testing.assert_array_equal(found, 2.5)


def hypothesis(*names: str, score: float) -> ComparedHypothesis:
    return ComparedHypothesis(
        tuple(Part("effect", n) for n in names), (Trial({}, np.full(12, score / 12), np.zeros(12)),)
    )


def test_few_pairs_tried_share_the_prior_of_all() -> None:
    singles = [hypothesis(n, score=0.0) for n in "abcdefgh"]
    weights = weigh([hypothesis(score=0.0), *singles, hypothesis("a", "b", score=0.0)])
    pair, single = weights.weight[-1], weights.weight[1]
    assert pair < single / 4


def evidence(size: float, p: float, repeatability: float = np.inf) -> VerdictEvidence:
    part = Part("effect", "slip")
    return VerdictEvidence({part: p}, 1 - p, {part: size}, 10.0, 0.03, 0.03, 20, repeatability=repeatability)


def test_size_that_a_precise_encoder_shows_is_told() -> None:
    assert decide(evidence(0.02, 0.99)).word == "silent"
    assert decide(evidence(0.02, 0.99, repeatability=0.02)).word == "named"
    assert (
        decide(replace(evidence(0.02, 0.99, repeatability=0.02), size={Part("effect", "slip"): 0.005})).word
        == "silent"
    )

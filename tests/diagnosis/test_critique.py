"""The rate of false alarms is as stated for any number of candidates, each with gains of its own size."""

import sys
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.critique.critique import MIN_SPREAD_NATS, CandidateScore, Critique, critique

from smarig.plant.effects.settling import settling
from smarig.plant.effects.walking import walking
from smarig.replay import PlantModel

module = sys.modules[critique.__module__]  # the function has the name of its module

NAMES = "abcdefgh"
TIMELINE: Any = "a story"
NOTHING: Any = None


@dataclass(frozen=True, eq=False)
class Gains:
    """A candidate whose gains on data and on each null are known."""

    name: str
    data: float
    nulls: np.ndarray
    generic: bool = False
    typical: tuple = ()
    kind: Any = walking

    def gain(self, data):
        return self.nulls if data == "null_data" else np.array([self.data])


@pytest.fixture
def critique_of(monkeypatch):
    """A critique of candidates by their gains, (candidates,) on the data and (candidates, count) on nulls."""
    prediction = SimpleNamespace(states=(), output_slope=np.empty(0))

    def refit(timeline, prediction, plant_model, nuisance_terms, warm_start, *, all_nuisances, noise_of):
        return SimpleNamespace(
            data="data", warm_start=warm_start, all_nuisances=all_nuisances, noise_of=noise_of
        )

    replacements = {
        "predict": lambda timeline, plant_model: prediction,
        "sensitivities": lambda hysteresis, states: [],
        "generic": lambda *args: [],
        "refit": refit,
        "null_data": lambda prediction, plant_model, refitted, count, seed: "null_data",
        "whitened": lambda candidate, refitted: candidate,
    }
    for name, replacement in replacements.items():
        monkeypatch.setattr(module, name, replacement)

    def of(data, nulls, alpha=0.1, **settings) -> Any:
        nulls = np.atleast_2d(nulls)
        candidates = [Gains(*those) for those in zip(NAMES, np.atleast_1d(data).tolist(), nulls)]
        monkeypatch.setattr(module, "named", lambda *args: candidates)
        plant_model = PlantModel(NOTHING, NOTHING, "negative")
        return critique(TIMELINE, plant_model, [walking], count=nulls.shape[1], alpha=alpha, **settings)

    return of


SIZES = np.array([2.0, 5.0, 40.0, 300.0])  # nats: by chance some candidates gain much more than others


def by_chance(rng, count):
    """Gains on data and on nulls of the same kind, correlated between candidates."""
    shared = rng.gamma(0.5, 1.0, count + 1)
    gains = SIZES[:, None] * (shared + rng.gamma(0.5, 1.0, (SIZES.size, count + 1)))
    return gains[:, 0], gains[:, 1:]


def test_the_chance_of_any_false_alarm_is_alpha_and_p_is_uniform(critique_of):
    rng, cases = np.random.default_rng(6), 400
    found = [critique_of(*by_chance(rng, 99)) for _ in range(cases)]
    p = np.array([f.p_value for f in found])
    assert 0.05 < np.mean([not f.silent for f in found]) < 0.16
    for share in (0.1, 0.25, 0.5, 0.75):
        assert np.mean(p <= share) == pytest.approx(
            share, abs=4 * np.sqrt(share * (1 - share) / cases) + 0.01
        )


@pytest.mark.parametrize("larger", [0, 1, 2, 3, 10, 98, 99])
@pytest.mark.parametrize("alpha", [0.01, 0.03, 0.1])
def test_p_is_the_share_of_null_runs_at_least_as_extreme_as_the_measured_one(critique_of, larger, alpha):
    """So it is never 0, at most 1, and something stands out where it is no more than α."""
    nulls = np.random.default_rng(2).permutation(np.arange(1.0, 100.0))  # 1 … 99 nats
    found = critique_of(99.5 - larger, nulls, alpha)
    assert found.p_value == (1 + larger) / 100
    assert found.silent is ((1 + larger) / 100 > alpha)


@pytest.mark.parametrize("times", [1.0, 3.0, 100.0])
def test_a_candidate_that_gains_more_by_chance_hides_no_other(critique_of, times):
    """However large its gains are, on data and nulls alike."""
    rng = np.random.default_rng(8)
    nulls = rng.gamma(1.0, 5.0, (2, 199))
    data = np.array([30.0, 10.0])
    usual, larger = (
        critique_of(by * data, by[:, None] * nulls) for by in (np.ones(2), np.array([1.0, times]))
    )
    assert larger.p_value == usual.p_value
    assert larger.threshold == pytest.approx(usual.threshold)
    assert not larger.silent
    assert larger.largest.candidate.name == "a"


def test_the_more_candidates_compete_the_farther_one_must_stand_out(critique_of):
    nulls = np.random.default_rng(3).gamma(1.0, 5.0, (8, 199))
    thresholds = [critique_of(np.zeros(k), nulls[:k]).threshold for k in (1, 3, 8)]
    assert thresholds[0] < thresholds[1] < thresholds[2]


def test_a_score_is_measured_by_its_own_nulls(critique_of):
    """50 and 95 nats are their median and 95 % point; data gain 45 nats more than that again."""
    (score,) = critique_of(140.0, np.arange(0.0, 101.0)).scores
    assert (score.gain, score.median, score.high) == pytest.approx((140, 50, 95))
    assert (score.net, score.standard) == pytest.approx((90, 2))


def test_a_marginal_gain_is_not_reported(critique_of):
    """A candidate that never gains anything by chance stands out by nats, not by spreads of nearly nothing."""
    nulls = np.stack([np.linspace(0.0, 0.001, 101), np.linspace(0.0, 10.0, 101)])
    found = critique_of([0.8 * MIN_SPREAD_NATS, 0.0], nulls)
    assert found.scores[0].standard == pytest.approx(0.8, abs=0.001)
    assert found.silent


def test_what_is_in_already_is_no_candidate(critique_of, monkeypatch):
    nulls, asked = np.arange(50.0), []

    def named(timeline, plant_model, prediction, kinds):
        asked.extend(kinds)
        return [Gains("a", 1.0, nulls)]

    monkeypatch.setattr(module, "named", named)
    critique(
        TIMELINE, PlantModel(NOTHING, NOTHING, "negative", (walking(0.3),)), [walking, settling], count=50
    )
    assert asked == [settling]


def test_noise_is_as_in_another_critique_where_one_is_given(critique_of):
    nulls = np.arange(50.0)
    other = critique_of(0.0, nulls)
    warm_start, noise_of = (
        critique_of(0.0, nulls, **given).refitted for given in ({"warm_start": other}, {"noise_of": other})
    )
    assert (warm_start.warm_start, warm_start.noise_of) == (other.refitted, None)
    assert (noise_of.warm_start, noise_of.noise_of) == (None, other.refitted)
    assert critique_of(0.0, nulls, all_nuisances=True).refitted.all_nuisances


def test_a_critique_with_effects_keeps_the_traces_of_the_first(critique_of):
    """Traces hardly depend on the effects that are present, and simulating them again takes most of the time."""
    first = critique_of(80.0, np.arange(50.0))
    again = critique_of([1.0, 2.0], np.ones((2, 50)), warm_start=first)
    assert again.named_traces == first.named_traces
    assert [s.gain for s in again.scores] == [80.0]


def test_the_best_are_by_turns_those_that_gain_most_and_those_that_stand_out_most():
    def score(name, net, spread, generic=False):
        candidate: Any = Gains(name, 0.0, np.empty(0), generic)
        return CandidateScore(candidate, net + 5.0, 5.0, 5.0 + spread)

    scores = (
        score("a", 90.0, 90.0),
        score("b", 50.0, 5.0),
        score("c", 20.0, 10.0),
        score("d", -1.0, 2.0),
        score("?", 99.0, 2.0, generic=True),
    )
    found = Critique(NOTHING, NOTHING, NOTHING, NOTHING, scores, (), 3.0, 0.5, 0.5, 3.0)
    assert [s.candidate.name for s in found.best(9)] == ["a", "b", "c"]
    assert [s.candidate.name for s in found.best(1)] == ["a"]
    assert [s.candidate.name for s in found.best(9, generic=True)] == ["?"]


@pytest.mark.parametrize(
    ("gain", "searched", "alarm"), [(60.0, False, False), (120.0, True, False), (900.0, True, True)]
)
def test_what_exceeds_null_data_is_searched_and_what_exceeds_other_wires_is_an_alarm(
    critique_of, gain, searched, alarm
):
    found = critique_of(gain, np.random.default_rng(4).gamma(1.0, 20.0, 400), 0.03)
    assert (not found.silent, found.alarm) == (searched, alarm)
    assert found.alarm is (found.calibrated_p < 0.03)

"""What held-out runs, which no fit has seen, must show of a cause: it removes more of their error than it leaves."""

import numpy as np
import pytest

from smarig.diagnosis.comparison.commanded.commanded_evidence import _with_held_out_gain
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import weigh
from smarig.diagnosis.held_out_gain import HeldOutGain

HEAT = Part("effect", "latent_heat")
IN_POSITIONS = ({"settled": 1.0}, {"settled": 0.1})  # mean squares without and with
ELSEWHERE = ({"settled": 1.0, "current": 1.0}, {"settled": 1.0, "current": 0.1})


def evidence(left: float, floor: float, squares=IN_POSITIONS) -> VerdictEvidence:
    """Of an effect that is sure by the training runs; ``left`` of the held-out error remains with it."""
    hypotheses = tuple(
        ComparedHypothesis(parts, (Trial({}, np.full(20, nats), np.zeros(20)),))
        for parts, nats in (((), 0.0), ((HEAT,), 5.0))
    )
    sure = VerdictEvidence(
        causes={HEAT: 0.99},
        nothing=0.01,
        size={HEAT: 0.1},
        span=1.0,
        error=0.1,
        noise=0.01,
        remains={HEAT: 0.01},
        blocks=20,
        held_out={HEAT: left},
    )
    gain = HeldOutGain(np.full(9, 1.0), np.full(9, left), np.arange(9), floor)
    found = SearchedHypotheses(hypotheses, {}, ())
    return _with_held_out_gain(
        sure, found, weigh(hypotheses), {(): squares[0], (HEAT,): squares[1]}, (HEAT,), gain
    )


@pytest.mark.parametrize(("left", "word"), [(0.65, "named"), (0.75, "unknown"), (0.95, "unknown")])
def test_a_cause_that_leaves_more_than_it_removes_is_no_name(left: float, word: str) -> None:
    found = decide(evidence(left, floor=0.1))
    assert (found.word, found.reason) == (word, "likely" if word == "named" else "not_borne_out")


def test_held_out_runs_with_little_to_explain_refute_nothing() -> None:
    assert decide(evidence(0.9, floor=0.5)).word == "named"


def test_what_acts_in_another_channel_need_not_show_in_positions() -> None:
    assert decide(evidence(1.0, floor=0.1, squares=ELSEWHERE)).word == "named"

"""Weighted hypotheses and their causes as plain values."""

from typing import Any

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.probabilities import Probabilities
from smarig.diagnosis.comparison.verdict_rules import SENTENCES, Verdict
from smarig.diagnosis.comparison.weights import Weights


def verdict_json(
    verdict: Verdict, effects: list[dict[str, Any]], weights: Weights, stated: Probabilities
) -> dict[str, Any]:
    """What every diagnosis says first: the verdict with its effects, and all that it was weighed from."""
    return {
        "verdict": verdict.word,
        "effects": effects,
        "set": list(verdict.names),
        "depends_on": verdict.depends_on,
        "reason": SENTENCES[verdict.reason],
        "stands_out": verdict.stands_out,
        "causes": causes_json(stated),
        "hypotheses": hypotheses_json(weights),
        "alpha": None,
        "nulls": 0,
    }


def causes_json(stated: Probabilities) -> list[dict[str, Any]]:
    """The probability of every cause, of nothing and of what is outside, likeliest first."""
    found = [{"kind": "nothing", "name": "nothing", "probability": stated.nothing}]
    found += [{"kind": "outside", "name": "outside", "probability": stated.outside}]
    found += [{"kind": p.kind, "name": p.name, "probability": w} for p, w in stated.causes.items()]
    return sorted(found, key=lambda cause: -float(cause["probability"]))


def hypotheses_json(weights: Weights) -> list[dict[str, Any]]:
    """Every hypothesis with its score, weight and best parameters, heaviest first."""
    rows = [_hypothesis(h, w) for h, w in zip(weights.hypotheses, weights.weight.tolist())]
    return sorted(rows, key=lambda row: -row["weight"])


def _hypothesis(hypothesis: ComparedHypothesis, weight: float) -> dict[str, Any]:
    return {
        "parts": [p.name for p in hypothesis.parts],
        "log_score": hypothesis.score,
        "weight": weight,
        "parameters": dict(hypothesis.best.parameters),
    }

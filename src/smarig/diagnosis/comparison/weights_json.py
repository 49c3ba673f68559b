"""Weighted hypotheses and their causes as plain values."""

from typing import Any

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.weights import Weights


def causes_json(weights: Weights) -> list[dict[str, Any]]:
    """The probability of every cause and of nothing, likeliest first."""
    found = [{"kind": "nothing", "name": "nothing", "probability": weights.nothing}]
    found += [{"kind": p.kind, "name": p.name, "probability": w} for p, w in weights.causes.items()]
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

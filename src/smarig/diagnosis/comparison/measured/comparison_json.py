"""A comparison of records with a measured input as plain values for ``--json``."""

from typing import Any

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.measured.measured_comparison import MeasuredComparison
from smarig.diagnosis.comparison.rules import SENTENCES
from smarig.diagnosis.comparison.weights import Weights


def comparison_json(found: MeasuredComparison) -> dict[str, Any]:
    """The verdict, every cause with its probability, every hypothesis with its score and weight, and the errors."""
    verdict = found.verdict
    return {
        "verdict": verdict.word,
        "reason": SENTENCES[verdict.reason],
        "names": list(verdict.names),
        "depends_on": verdict.depends_on,
        "probability_of_nothing": found.weights.nothing,
        "causes": [{"kind": p.kind, "name": p.name, "probability": w} for p, w in found.causes.items()],
        "parameters": {
            effect: {name: {"value": v, "ci95": [low, high]} for name, (v, low, high) in values.items()}
            for effect, values in found.parameters.items()
        },
        "error": {"base": found.base_error, "extended": found.extended_error, "noise": found.noise},
        "held_out": dict(found.held_out),
        "missing_knowledge": found.missing,
        "excursions": found.excursions,
        "hypotheses": _hypotheses(found.weights),
        "between_runs": None if found.between is None else _hypotheses(found.between),
        "seconds": round(found.seconds, 2),
    }


def _hypotheses(weights: Weights) -> list[dict[str, Any]]:
    rows = [_row(h, w) for h, w in zip(weights.hypotheses, weights.weight.tolist())]
    return sorted(rows, key=lambda row: -row["weight"])


def _row(hypothesis: ComparedHypothesis, weight: float) -> dict[str, Any]:
    return {
        "name": hypothesis.name,
        "weight": weight,
        "log_score": hypothesis.score,
        "parameters": dict(hypothesis.best.parameters),
    }

"""The JSON object of a diagnosis of runs with a measured input."""

from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.measured.measured_text import MISSING_EXPERIMENT
from smarig.diagnosis.comparison.rules import SENTENCES
from smarig.diagnosis.comparison.weights import Weights
from smarig.diagnosis.error_parts import error_parts
from smarig.diagnosis.suspects import suspects
from smarig.identification import MeasuredHypothesis

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis


def measured_json(d: "MeasuredDiagnosis") -> dict[str, Any]:
    """The whole object; errors in output units, scores in nats."""
    verdict, learned, missing = d.verdict, d.learned, d.evidence.missing
    return {
        "verdict": verdict.word,
        "effects": d.effects(),
        "set": list(verdict.names),
        "depends_on": verdict.depends_on,
        "reason": SENTENCES[verdict.reason],
        "causes": causes_json(d.evidence.weights),
        "hypotheses": hypotheses_json(d.evidence.weights),
        "missing_knowledge": missing
        and {
            "share_of_error": missing.share,
            "where": {"input": list(missing.inputs), "unit": d.runs[0].input_unit},
            "experiment": MISSING_EXPERIMENT,
        },
        "not_identifiable": d.not_testable,
        "error": {
            "unit": d.unit,
            "noise_floor": d.noise,
            "base": d.rms(),
            "extended": d.rms(d.best),
            "given": d.given_rms,
        },
        "adequacy": {
            "times_noise": d.base.rms / d.noise if d.noise else None,
            "where": _where(d.base),
            "adequate": d.evidence.adequate,
        },
        "learned": learned and learned.to_json(),
        "preisach_properties": {t.name: t.to_json() for t in d.properties},
        "held_out": d.gain and d.gain.to_json(),
        "run_offsets": [
            {
                "run": o.run,
                "offset": o.offset,
                "ci95": list(o.interval),
                "error_without": o.without,
                "error_with": o.with_offset,
            }
            for o in d.offsets
        ],
        "between_runs": d.evidence.between_runs,
        "suspects": [s.to_json() for s in suspects(d.runs)],
        "conditions": d.conditions,
        "separating_run": None,
        "alpha": None,
        "nulls": 0,
        "stands_out": verdict.word != "silent",
        "model": d.model.name,
        "seconds": d.seconds,
    }


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


def _where(base: MeasuredHypothesis) -> dict[str, float]:
    """The parts of the weighted errors on blocks left out."""
    plan, known = base.fit.problem.plan, np.isfinite(base.errors)
    return error_parts(base.weighted[known], plan.record[known], plan.block[known], plan.y[known])

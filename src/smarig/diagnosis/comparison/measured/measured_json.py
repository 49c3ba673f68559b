"""The JSON object of a diagnosis of runs with a measured input."""

from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.diagnosis.comparison.weights_json import verdict_json
from smarig.diagnosis.error_parts import error_parts
from smarig.diagnosis.suspects import suspects
from smarig.identification import MeasuredHypothesis

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis


def measured_json(d: "MeasuredDiagnosis") -> dict[str, Any]:
    """The whole object; errors in output units, scores in nats."""
    learned, missing = d.learned, d.evidence.missing
    return verdict_json(d.verdict, d.effects(), d.evidence.weights, d.probabilities) | {
        "missing_knowledge": missing and missing.to_json(d.runs[0].input_unit),
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
            "adequate": d.evidence.adequate and not d.verdict.stands_out,
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
                "against": o.against,
                "held_out": o.held_out,
            }
            for o in d.offsets
        ],
        "between_runs": d.evidence.between_runs,
        "suspects": [s.to_json() for s in suspects(d.runs)],
        "conditions": d.conditions,
        "separating_run": None,
        "model": d.model.name,
        "seconds": d.seconds,
    }


def _where(base: MeasuredHypothesis) -> dict[str, float]:
    """The parts of the weighted errors on blocks left out."""
    plan, known = base.fit.problem.plan, np.isfinite(base.errors)
    return error_parts(base.weighted[known], plan.record[known], plan.block[known], plan.y[known])

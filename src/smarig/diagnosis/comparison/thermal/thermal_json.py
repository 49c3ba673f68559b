"""The JSON object of a diagnosis of a thermal record."""

from typing import TYPE_CHECKING, Any

from smarig.diagnosis.comparison.rules import SENTENCES
from smarig.diagnosis.comparison.weights_json import causes_json, hypotheses_json

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis


def thermal_json(d: "ThermalDiagnosis") -> dict[str, Any]:
    """The whole object; errors in kelvin, scores in nats. ``held_out`` are blocks of the record, left out in turn."""
    verdict = d.verdict
    return {
        "verdict": verdict.word,
        "effects": [f.to_json() for f in d.findings],
        "set": list(verdict.names),
        "depends_on": verdict.depends_on,
        "reason": SENTENCES[verdict.reason],
        "causes": causes_json(d.evidence.weights),
        "hypotheses": hypotheses_json(d.evidence.weights),
        "missing_knowledge": None,
        "not_identifiable": d.not_testable,
        "parameters": d.parameters(),
        "error": {
            "unit": "K",
            "noise_floor": d.noise,
            "base": d.base.rms,
            "extended": d.extended.rms,
        },
        "adequacy": {
            "times_noise": d.gain.base / d.noise if d.noise else None,
            "adequate": d.evidence.evidence.adequate,
        },
        "transients": d.evidence.problem.transients,
        "held_out": d.gain.to_json(),
        "separating_run": None,
        "alpha": None,
        "p_value": None,
        "nulls": 0,
        "stands_out": verdict.stands_out,
        "seconds": d.seconds,
    }

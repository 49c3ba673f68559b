"""The JSON object of a diagnosis of a thermal record."""

from typing import TYPE_CHECKING, Any

from smarig.diagnosis.comparison.weights_json import verdict_json

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis


def thermal_json(d: "ThermalDiagnosis") -> dict[str, Any]:
    """The whole object; errors in kelvin, scores in nats. ``held_out`` are blocks of the record, left out in turn."""
    return verdict_json(d.verdict, [f.to_json() for f in d.findings], d.evidence.weights, d.probabilities) | {
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
        "p_value": None,
        "seconds": d.seconds,
    }

"""The JSON object of a diagnosis of commanded runs."""

from typing import TYPE_CHECKING, Any

from smarig.diagnosis.comparison.weights_json import verdict_json
from smarig.diagnosis.error_parts import error_parts
from smarig.replay import predict

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.commanded.commanded_diagnosis import CommandedDiagnosis


def commanded_json(d: "CommandedDiagnosis") -> dict[str, Any]:
    """The whole object; errors in output units, scores in nats."""
    e = d.error
    return verdict_json(d.verdict, d.effects(), d.weights, d.probabilities) | {
        "missing_knowledge": d.missing and d.missing.to_json("K"),
        "not_identifiable": list(d.not_identifiable),
        "error": {
            "unit": e.unit,
            "noise_floor": e.noise_floor,
            "base": e.base,
            "extended": e.extended,
            "given": e.original,
        },
        "adequacy": {
            "times_noise": d.times_noise,
            "where": _where(d),
            "adequate": not d.verdict.stands_out,
        },
        "noise": {
            "settled": d.scatter,
            "reading": d.noise.settled,
            "room_K": d.noise.temperature_K,
            "correlation_s": d.noise.correlation_s,
        },
        "learned": d.learned and d.learned.to_json(),
        "held_out": d.gain and d.gain.to_json(),
        "separating_run": d.separating_run,
        "model": d.model.name,
        "numerics": d.numerics,
        "seconds": d.seconds,
    }


def _where(d: "CommandedDiagnosis") -> dict[str, float]:
    """The parts of the base model's error at settled points."""
    timeline = d.timeline
    error = timeline.settled.value - predict(timeline, d.base).values["settled"]
    return error_parts(error - error.mean(), timeline.run, timeline.block, timeline.settled.value)

"""The JSON object of a diagnosis of commanded runs."""

from math import isfinite
from typing import TYPE_CHECKING, Any

from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.error_parts import error_parts
from smarig.diagnosis.explain.discrepancy import Discrepancy
from smarig.diagnosis.explain.parameter_fit import ParameterFit
from smarig.diagnosis.explain.search import NearestEffect
from smarig.diagnosis.name_gates import DISCREPANCY_NATS, NORMAL_95, slow_room
from smarig.plant import EffectType, Parameter
from smarig.replay import predict

if TYPE_CHECKING:
    from smarig.diagnosis.diagnosis_result import Diagnosis

NO_FINDING = ("silent", "not_identifiable")


def diagnosis_json(d: "Diagnosis") -> dict[str, Any]:
    """The whole object; errors in output units, gains in nats."""
    e = d.error
    return {
        "verdict": d.verdict.word,
        "effects": effects_json(d),
        "set": list(d.verdict.names),
        "depends_on": d.verdict.depends_on,
        "reason": d.reason or None,
        "nearest": d.nearest and _nearest(d.nearest),
        "no_candidates": list(d.refused),
        "not_identifiable": list(d.visibility.invisible),
        "error": {
            "unit": e.unit,
            "noise_floor": e.noise_floor,
            "base": e.base,
            "extended": e.extended,
            "given": e.original,
        },
        "adequacy": _adequacy(d),
        "noise": _noise(d),
        "discrepancy": _discrepancy(d.discrepancy),
        "remaining": d.remaining and _discrepancy(d.remaining),
        "learned": d.learned and d.learned.to_json(),
        "held_out": d.gain and d.gain.to_json(),
        "separating_run": d.separating_run,
        "alpha": d.alpha,
        "p_value": d.first.calibrated_p,
        "stands_out": d.first.alarm or d.verdict.word not in NO_FINDING,
        "nulls": d.nulls,
        "model": d.model.name,
        "numerics": d.numerics,
        "seconds": d.seconds,
    }


def _nearest(found: NearestEffect) -> dict[str, Any]:
    effect = found.effect
    return {
        "name": effect.kind.name,
        "parameters": {
            p.name: {"value": effect.values[p.name], "unit": p.unit} for p in effect.kind.parameters
        },
        "gain_nats": found.gain,
        "required_nats": found.required,
        "lead_nats": found.lead if isfinite(found.lead) else None,
    }


def effects_json(d: "Diagnosis") -> list[dict[str, Any]]:
    """The effects of the best explanation that are candidates: name, score, parameters with 95 % intervals."""
    best, compatible = d.best, d.verdict.compatible
    if best is None:
        return []
    return [
        _effect(p, best, d.verdict) for p in best.effects if compatible is None or p.kind.name in compatible
    ]


def _effect(effect: Any, best: ParameterFit, verdict: DiagnosisVerdict) -> dict[str, Any]:
    kind: EffectType = effect.kind
    fitted = {q: s for (name, q), s in best.spread.items() if name == kind.name}
    return {
        "name": kind.name,
        "probability": verdict.probability(kind.name),
        "parameters": {
            p.name: {
                "value": effect.values[p.name],
                "ci95": parameter_interval(p, effect.values[p.name], fitted.get(p.name)),
                "unit": p.unit,
            }
            for p in kind.parameters
        },
    }


def parameter_interval(parameter: Parameter, value: float, sd: float | None) -> list[float] | None:
    """The 95 % interval of a parameter within its bounds, or None if its standard deviation is not known."""
    if sd is None:
        return None
    half = NORMAL_95 * sd
    return [max(value - half, parameter.lower), min(value + half, parameter.upper)]


def _adequacy(d: "Diagnosis") -> dict[str, Any]:
    """How far the base model misses the training runs, and where."""
    timeline = d.timeline
    error = timeline.settled.value - predict(timeline, d.base).values["settled"]
    return {
        "times_noise": d.times_noise,
        "where": error_parts(error - error.mean(), timeline.run, timeline.block, timeline.settled.value),
        "adequate": d.verdict.word in NO_FINDING,
    }


def _noise(d: "Diagnosis") -> dict[str, Any]:
    """What the refit takes for noise beside what was found: of a settled point, and of the wire's temperature."""
    own = d.remaining if d.extended and d.remaining and not d.learned else d.discrepancy
    return {
        "settled": own.noise,
        "reading": d.first.refitted.noise.settled,
        "room_K": own.room_K,
        "correlation_s": own.correlation_s,
        "more_than_a_draught": slow_room(own),
    }


def _discrepancy(found: Discrepancy) -> dict[str, Any]:
    return {
        "depends_on": found.depends_on or None,
        "enters": found.place or None,
        "gain_nats": found.gain,
        "minor_loops_return": not (found.not_preisach and found.gain >= DISCREPANCY_NATS),
    }

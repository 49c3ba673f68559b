"""What a characterisation measured, whether its model is good, and what to do now: three sentences and a level."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from smarig.core import spaced
from smarig.diagnosis import DIAGNOSIS_MODEL, CommandedDiagnosis, variable_experiment, variable_words
from smarig.identification import ErrorLevel, ErrorVerdict, Verification, error_verdict
from smarig.plant import Effect
from smarig.record import Run
from smarig.report.components.numbers import duration, runs_text
from smarig.report.components.page_summary import Assessment, box_level
from smarig.report.components.run_description import display_unit, duration_s, extent
from smarig.report.diagnosis.verdict_text import changes_text, strengths_text
from smarig.report.models.evidence import Evidence, settled_range, stroke_run, stroke_text
from smarig.report.models.model_tables import pooled_rms
from smarig.report.models.preisach_verdict import preisach_verdict


def assessment(e: Evidence) -> Assessment:
    """The assessment of a characterisation, built from its figures."""
    verdict, error = _held_out(e)
    cause = _cause(e, pooled_rms(e.verifications.get(e.chosen)))
    levels = {_quality_level(e, verdict), cause.level}
    level = "bad" if "bad" in levels else "warning" if "warning" in levels else "good"
    return Assessment(level, _measured(e), _quality(e, verdict, error), _advice(e, verdict, cause))


_REMOVE = "Remove the cause and measure again; the extended model does not predict better."
_MUCH_LESS = 0.5  # of the chosen model's error
_NEARER = 0.8  # of the chosen model's error: less is told
_VISIBLE_SHARE = 0.01  # of the measured stroke: a smaller part by effects is not told
_ROOM_CHANGED_K = 0.3  # a smaller change of the room is noise of its thermometer


@dataclass(frozen=True)
class _Cause:
    """What the diagnosis found: its ``level``, a sentence, and what to do."""

    level: str
    text: str
    advice: str


def _measured(e: Evidence) -> str:
    runs = list(e.runs.values())
    if not runs:
        return "No run was made."
    run = max(runs, key=lambda each: np.nan_to_num(extent(each, "position")))
    hours = duration(sum(duration_s(each) for each in runs if duration_s(each) == duration_s(each)))
    settled = sum(len(each.settled) for each in runs)
    fitted = stroke_run(e)
    travel = settled_range(fitted) if fitted is not None else None
    wide = extent(run, "position") if travel is None else travel
    stroke = f"{stroke_text(wide)}{spaced(display_unit(run.unit))}{_without_effects(e, wide)}"
    inputs = [extent(each, "input") for each in runs if each.has("input")]
    if inputs:
        stroke += f" over {max(inputs):.3g}{spaced(display_unit(run.input_unit))}"
    count = runs_text(len(runs))
    return f"Measured: a stroke of {stroke}, {settled} settled points in {count}, {hours} on the rig."


def _without_effects(e: Evidence, measured: float) -> str:
    """The stroke of the hysteresis alone in brackets, if named effects make up a visible part of the measured one."""
    d = e.diagnosis
    if d is None or not d.extended or d.verdict.word != "named":
        return ""
    h = d.model.hysteresis
    own = abs(float(h.everett(h.upper, h.lower)))
    if abs(own - measured) <= _VISIBLE_SHARE * measured:
        return ""
    return (
        f" ({stroke_text(own)}{spaced(display_unit(d.model.unit))} without {' and '.join(d.verdict.names)})"
    )


def _held_out(e: Evidence) -> tuple[ErrorVerdict | None, str]:
    """The verdict on the held-out error of the chosen model, and the error as text."""
    found = e.verifications.get(e.chosen)
    rms = pooled_rms(found)
    if found is None or rms is None:
        return None, ""
    share = _share_of_stroke(e, rms) if found.noise_floor else ""  # else the verdict has it
    return _verdict_on(rms, found), f"{rms:.3g}{spaced(found.unit)} rms{share}"


def _verdict_on(rms: float, found: Verification) -> ErrorVerdict:
    """The verdict on an error at the settled points of verified runs."""
    travels = [run.settled.rms / run.settled.nrmse for run in found.runs if run.settled.nrmse > 0]
    return error_verdict(rms, found.noise_floor, rms / min(travels, default=float("nan")))


def _quality_level(e: Evidence, verdict: ErrorVerdict | None) -> str:
    if e.best is None:
        return "bad"
    if verdict is None:
        return "warning"
    return box_level(verdict.level)


def _quality(e: Evidence, verdict: ErrorVerdict | None, error: str) -> str:
    if e.best is None:
        return "No model was identified."
    if verdict is None:
        return f"The {e.chosen} model was not tested: no run was held out."
    preisach = preisach_verdict(e)
    against = f" {preisach.headline}" if preisach.holds is False else ""
    return f"The {e.chosen} model predicts held-out data to {error}, {verdict.text}.{_nearer(e)}{against}"


def _nearer(e: Evidence) -> str:
    """Which surface comes much nearer to the held-out run, which has no part in the choice."""
    errors = {name: rms for name, found in e.verifications.items() if (rms := pooled_rms(found)) is not None}
    best = min(errors, key=errors.__getitem__)
    if errors[best] > _NEARER * errors[e.chosen]:
        return ""
    basis = "held-out curves" if e.choice is not None else "the training runs"
    value = f"{errors[best]:.3g}{spaced(e.verifications[best].unit)}"
    return f" It was chosen on {basis}; on these data the {best} model comes nearer, to {value}."


def _room_text(runs: Iterable[Run]) -> str:
    """The measured temperatures of the room, "" if it stayed the same."""
    ends = [found for run in runs if run.has("ambient_degC") and (found := run.extremes("ambient_degC"))]
    low, high = min((a for a, _ in ends), default=0.0), max((b for _, b in ends), default=0.0)
    return f" (the room: {low:.1f} to {high:.1f} °C)" if high - low > _ROOM_CHANGED_K else ""


def _cause(e: Evidence, rms: float | None) -> _Cause:
    """What the diagnosis says, in one sentence each; ``rms`` is the held-out error of the chosen model."""
    d = e.diagnosis
    if d is None:
        return _Cause("good", "", "")
    word = d.verdict.word
    if word == "named":
        room = _room_text(e.runs.values()) if "ambient_drift" in d.verdict.names else ""
        advice = _named_advice(e, d, rms) + _remedies(d.likely_effects)
        return _Cause("bad", f"Cause: {strengths_text(d.findings)}{room}. {changes_text(d)}", advice)
    if word == "ambiguous":
        return _Cause(
            "bad",
            f"Cause: one of {', '.join(d.verdict.names)}.",
            "Make the run that the diagnosis proposes; it tells them apart.",
        )
    if word == "unknown":
        return _Cause("bad", _unknown_text(d), _unknown_advice(d))
    if word == "not_identifiable":
        return _Cause("warning", "These data cannot show any effect.", "Make a longer run.")
    return _Cause("good", "No disturbance was found.", "")


def _unknown_text(d: CommandedDiagnosis) -> str:
    depends = f" It depends on {variable_words(d.verdict.depends_on)}." if d.verdict.depends_on else ""
    names = f" Candidates, not proved: {', '.join(d.verdict.names)}." if d.verdict.names else ""
    return f"Something acts on this wire, and no effect of the catalogue is certain.{depends}{names}"


def _unknown_advice(d: CommandedDiagnosis) -> str:
    if d.not_preisach:
        return "No Preisach operator describes such a wire: use the model within this error only."
    if d.verdict.depends_on is None:
        return "Repeat the run: a real effect appears again."
    return variable_experiment(d.verdict.depends_on)


def _named_advice(e: Evidence, d: CommandedDiagnosis, rms: float | None) -> str:
    gain = d.gain
    if gain is None:
        return _REMOVE
    error = gain.settled_rms(gain.extended_error)
    found = e.verifications.get(e.chosen)
    verdict = _verdict_on(error, found) if found is not None else None
    is_poor = verdict is not None and verdict.level == ErrorLevel.POOR
    if is_poor and rms is not None and error >= rms:
        return _REMOVE
    unit = spaced(d.timeline.unit)
    instead = f" instead of {rms:.3g}{unit}" if is_poor and rms is not None else ""
    held_out = f"held-out error {error:.3g}{unit}{instead}{_share_of_stroke(e, error)}" + (
        f", {verdict.text}" if verdict else ""
    )
    if gain.extended < gain.base:
        model = f"the extended model (diagnosis/{DIAGNOSIS_MODEL}, {held_out})"
    elif rms is not None and error < _MUCH_LESS * rms:
        model = f"the model of the diagnosis ({held_out})"
    else:
        return _REMOVE
    if is_poor:
        return f"Remove the cause and measure again. Until then, {model} comes nearest."
    return f"Use {model}, or remove the cause and measure again."


def _share_of_stroke(e: Evidence, error: float) -> str:
    """The error as a share of the stroke: the ratio to the noise alone makes an accurate rig look poor."""
    run = stroke_run(e)
    stroke = settled_range(run) if run is not None else 0.0
    return f", {100 * error / stroke:.2g} % of the stroke" if stroke else ""


def _remedies(effects: Iterable[Effect]) -> str:
    """What can be done against each effect: a sentence for each that has a remedy."""
    return "".join(f" {text}" for effect in effects if (text := effect.kind.remedy_text))


def _advice(e: Evidence, verdict: ErrorVerdict | None, cause: _Cause) -> str:
    if e.best is None:
        return "Run first_order_descending over the whole range, then identify."
    if cause.level != "good":
        return f"{cause.text} {cause.advice}"
    if verdict is None:
        return f"{cause.text} Measure a validation run, then verify the model on it.".strip()
    if verdict.level == ErrorLevel.GOOD:
        return f"{cause.text} The model can be used as it is.".strip()
    found = "The diagnosis names no cause" if e.diagnosis is not None else "No diagnosis was made"
    return f"{found}. Use the model within this error, or measure more curves where the error is large."

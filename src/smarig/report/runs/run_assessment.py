"""What a run shows: what was measured, whether the record is sound, how well a model fits, and what to do."""

import numpy as np

from smarig.core import Severity, spaced
from smarig.identification import ErrorLevel, RunVerification
from smarig.record import AnyRun
from smarig.report.components.numbers import duration, number, signed, thousands
from smarig.report.components.page_summary import Assessment, box_level
from smarig.report.components.run_description import (
    display_unit,
    duration_s,
    protocol_name,
    quality_counts,
)

_WITH_CURVES = ("first_order_descending", "first_order_ascending", "adaptive_fod")
_IDENTIFIED_FROM = (*_WITH_CURVES, "minor_loops")


def run_assessment(run: AnyRun, verified: RunVerification | None = None, model: str = "") -> Assessment:
    """The assessment of a run, and of the prediction of a ``model`` that was ``verified`` on it, if one was."""
    level, quality = _record_quality(run)
    if verified is None or level == "bad":
        return Assessment(level, _measured(run), quality, _advice(run, level))
    unit = spaced(display_unit(run.unit))
    found = verified.verdict
    rms = f"{number(verified.settled.rms)}{unit} rms, {found.text}"
    text = f"The model {model} predicts this run to {rms}."
    if verified.is_training:
        text = f"The model {model} was fitted to this run; the error of the fit is {rms}."
    if found.level != ErrorLevel.GOOD:
        advice = f"{_largest_error(run, verified)}Diagnose the run (smarig diagnose) to find its cause."
    elif verified.is_training:
        advice = "That is no prediction: verify the model on a run that it was not fitted to."
    else:
        advice = "The model can be used as it is."
    return Assessment(box_level(found.level), _measured(run), text, advice)


def _largest_error(run: AnyRun, verified: RunVerification) -> str:
    """Where the error is largest, as a sentence with a space behind it; "" if nothing is predicted."""
    error = verified.error
    if not np.isfinite(error).any():
        return ""
    k = int(np.nanargmax(np.abs(error)))
    units = spaced(display_unit(run.unit)), spaced(display_unit(run.input_unit))
    place = f"at {number(float(verified.input[k]))}{units[1]} (point {k + 1} of {error.size})"
    return f"The largest error is {signed(float(error[k]))}{units[0]}, {place}. "


def _measured(run: AnyRun) -> str:
    ends, input_ends = run.extremes("position"), run.extremes("input")
    if ends is None:
        return f"Measured: {protocol_name(run)}, without readings of the output."
    travel = f"{number(ends[1] - ends[0], 4)}{spaced(display_unit(run.unit))}"
    words = f"Measured: {protocol_name(run)}, a travel of {travel}"
    if input_ends is not None:
        words += f" over {number(input_ends[1] - input_ends[0], 4)}{spaced(display_unit(run.input_unit))}"
    m = quality_counts(run)
    points = "1 settled point" if m.settled == 1 else f"{m.settled} settled points"
    count = points if m.settled else f"{thousands(m.samples)} samples"
    took = f", {duration(duration_s(run))}" if np.isfinite(duration_s(run)) else ""
    return f"{words}; {count}{took}."


def _record_quality(run: AnyRun) -> tuple[str, str]:
    """The level and the sentence on the record itself."""
    m = quality_counts(run)
    if not len(run):
        return "bad", "The run has no samples."
    if not run.complete or run.cause != "done":
        return "bad", f"The run is incomplete: {run.early_end}."
    if run.remaining_severity.reaches(Severity.MAJOR):
        return "bad", f"The run had an event of severity {run.remaining_severity}; see Data quality."
    if m.timed_out + m.interrupted:
        return "warning", _unused_holds(m.timed_out, m.interrupted, m.steps)
    if not m.clean:
        return "warning", "Samples are marked or missing; see Data quality."
    if run.info.warnings:
        count = len(run.info.warnings)
        return (
            "warning",
            f"The import has {count} remark{'s' if count > 1 else ''} on this file; see Warnings.",
        )
    # a waveform has steps that are no holds
    holds = {0: "", 1: " and its hold settled"}.get(m.settled, f" and all {m.settled} holds settled")
    several = f"{m.void} steps were" if m.void > 1 else "1 step was"
    repeated = (
        f" {several} repeated after an interruption, and the first attempt is not used." if m.void else ""
    )
    return "good", f"The run ended as planned{holds}.{repeated}"


def _unused_holds(late: int, interrupted: int, steps: int) -> str:
    """What became of holds that did not settle."""
    parts = [f"{late} did not settle in time"] * bool(late)
    parts += [f"{interrupted} {'were' if interrupted > 1 else 'was'} interrupted"] * bool(interrupted)
    return f"Of {steps} holds, {' and '.join(parts)}; no point of theirs is used."


def _advice(run: AnyRun, level: str) -> str:
    if any(e.kind == "still_on" for e in run.events):
        return "Find out why the source did not switch off before you use the rig again."
    if level == "bad" and run.cause == "done":
        return "Repeat the run, or leave out what the events concern, before using it."
    if level == "bad":
        return "Resume the run (smarig resume), or repeat it, before using it."
    if run.info.protocol in _IDENTIFIED_FROM:
        surface = "" if run.info.protocol in _WITH_CURVES else "--surface positive "
        return f"Identify a model from it: smarig identify {run.path.name} {surface}-o wire.model.json."
    if run.info.protocol == "validation":
        return f"Verify a model on it: smarig verify MODEL {run.path.name}."
    return ""

"""The sentences of a diagnosis for a terminal, a notebook and the report."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.core import capitalised, spaced
from smarig.diagnosis.critique.calibration import CALIBRATION_BOXES, p_text
from smarig.diagnosis.explain.search import NearestEffect
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.noise_terms import PREDICTION_LIMIT, REMAINING_SCATTER
from smarig.diagnosis.variable_words import variable_words
from smarig.plant import parameter_words

if TYPE_CHECKING:
    from smarig.diagnosis.diagnosis_result import Diagnosis

FAR_OFF_RATIO = 10.0  # times the rms error of a refitted density: the model is of another wire or state
INADEQUATE_RATIO = 3.0  # times the noise: worth a sentence
INADEQUATE_HELD_OUT = 5.0  # times the prediction limit: the same
MIN_UNRECORDED_S = 60.0  # shorter gaps: two commands typed one after the other
DOUBT = "something stands out, but no effect and no variable explains enough of it"
AT_FLOOR = f"The base model already reaches the {PREDICTION_LIMIT}."


def text_lines(d: "Diagnosis") -> Iterator[str]:
    """The findings of a diagnosis, one or two sentences per line."""
    e, gain, best = d.error, d.gain, d.best
    p = f"p {p_text(d.first.calibrated_p)}, calibrated on {CALIBRATION_BOXES} simulated wires without an effect"
    if d.verdict.word in ("silent", "not_identifiable"):
        if not d.first.alarm:
            yield f"Nothing stands out ({p}; an alarm needs p ≤ {d.alpha:g})."
        else:
            yield f"{capitalised(DOUBT)} ({p})."
        if d.reason:
            yield f"{capitalised(d.reason)}."
    if d.verdict.word == "unknown":
        size = f"log likelihood higher by {d.discrepancy.gain:.0f}" if d.first.silent else p
        yield f"{capitalised(unknown_text(d))} ({size})."
        if d.reason:
            yield f"Why no effect is named: {d.reason}."
        if d.nearest:
            yield nearest_text(d.nearest)
        yield from _not_preisach(d)
    yield from _learned(d)
    if best is not None:
        unsure = (
            "Best explanation, but not sufficient"
            if d.verdict.compatible is None
            else "Candidate, not proved"
        )
        opening = {"named": "Found", "ambiguous": "Ambiguous, best explanation"}.get(d.verdict.word, unsure)
        for effect in d.effects():
            values = ", ".join(parameter_text(n, v) for n, v in effect["parameters"].items())
            yield f"{opening}: {effect['name']} ({values}), score {effect['probability']:.2f}."
        if d.verdict.word == "named":
            yield from filter(None, (e.kind.remedy_text for e in best.effects))
    if d.refused:
        yield (
            f"No candidates: {', '.join(d.refused)}. They follow a part of the error, but nothing speaks for them that "
            "an error of the operator does not explain too."
        )
    if d.verdict.word == "ambiguous":
        yield f"The likeliest causes, with 0.9 of the score together: {', '.join(d.verdict.names)}."
    yield (
        f"Settled points, rms error: {e.original:.4g} {e.unit} (given model), {e.base:.4g} {e.unit} (base model, "
        "refitted without effects)"
        + (f", {e.extended:.4g} {e.unit} (extended model)" if d.extended else "")
        + f"; {d.point_noise_text} {e.unit}."
    )
    if d.times_noise > INADEQUATE_RATIO:
        scatter = f"{REMAINING_SCATTER} of {d.discrepancy.noise:.2g} {e.unit}"
        yield f"Without effects, the model misses these runs by {d.times_noise:.0f} × their {scatter}."
    unsettled = [step for run in d.timeline.runs for step in run.settled if step.verdict == "timed_out"]
    if unsettled:
        yield f"{len(unsettled)} of {len(d.timeline.settled)} settled points had not settled by their time limit."
    if e.original > FAR_OFF_RATIO * max(min(e.base, e.extended), e.noise_floor):
        yield (
            "The given model is far from these data, with or without effects. The model of this diagnosis is fitted "
            "to them."
        )
    if d.left is not None:
        yield (
            f"The remaining residuals exceed the noise and depend on {d.left}. The named effects explain most of "
            "the error, but their sizes may be wrong by more than their intervals state."
        )
    if d.timeline.unrecorded_gap_s > MIN_UNRECORDED_S:
        yield (
            f"{d.timeline.unrecorded_gap_s / 60:.0f} min between these runs are not recorded. If the wire was driven "
            "then, effects of time and of cycles are assessed wrongly. Give every run of the session."
        )
    if gain is not None:
        yield gain_text(gain, e.unit) if d.extended else held_out_text(gain, e.unit)
        yield from as_verified(gain, e.unit, extended=d.extended)
    if d.separating_run:
        yield d.separating_run["why"]
    if d.visibility.invisible:
        yield f"Effects that these data cannot show at any strength: {', '.join(d.visibility.invisible)}."


def _not_preisach(d: "Diagnosis") -> Iterator[str]:
    if d.discrepancy.not_preisach and d.verdict.depends_on == d.discrepancy.depends_on:
        yield (
            "The errors grow with the motion since the last saturation and vanish there: minor loops do not return. No "
            "Preisach operator describes such a wire, with any density."
        )


def _learned(d: "Diagnosis") -> Iterator[str]:
    """What was learned in place of a cause, or why nothing was."""
    if d.learned is None:
        yield from nothing_learned_text(d.learned_reason)
        return
    shape = d.learned.shape
    yield f"A term at the {shape.enters.replace('_', ' ')} that depends on {shape.variable_text} was learned."
    yield learned_gain_text(d.learned.gain_blocks, d.learned.looks_like)


def nothing_learned_text(reason: str) -> Iterator[str]:
    """Why no term was learned, if there is a reason, as a sentence."""
    if reason:
        yield f"No extended model is offered: {reason}."


def learned_gain_text(gain_blocks: float, similar: Sequence[str]) -> str:
    """What a learned term removes, and the effects that it looks like."""
    like = f", and looks like {', '.join(similar)}" if similar else ""
    return f"It removes {100 * gain_blocks:.0f} % of the error on blocks left out of the fit{like}."


def parameter_text(name: str, v: Mapping[str, Any]) -> str:
    """A parameter with its 95 % interval and unit."""
    ends, name = v["ci95"], parameter_words(name, v["unit"])
    if ends and ends[1] is None:  # the search is open above
        return f"{name} at least {ends[0]:.3g}{spaced(v['unit'])}"
    return (
        f"{name} {v['value']:.3g}" + (f" [{ends[0]:.3g}, {ends[1]:.3g}]" if ends else "") + spaced(v["unit"])
    )


def gain_text(gain: HeldOutGain, unit: str) -> str:
    """The gain of the extended model on held-out runs."""
    opening = (
        f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g} → {gain.extended:.4g}{spaced(unit)}"
    )
    if gain.original is not None:
        opening += f" (given model: {gain.original:.4g}{spaced(unit)})"
    share, ends = gain.removable_share, gain.interval()
    if gain.extended > max(gain.base, gain.floor):
        return f"{opening}. The extended model is WORSE. Check its parameters before you use it."
    if share is None:
        return f"{opening}. {AT_FLOOR}"
    between = f" (95 %: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    words = f"{opening}; removable share R = {share_text(share)}{between}."
    if gain.original is not None and gain.original < gain.extended:
        words += " The given model predicts them better than the extended one. Keep the given model."
    return words


def held_out_text(gain: HeldOutGain, unit: str) -> str:
    """The errors on held-out runs where no extended model is offered."""
    given = f" (given model: {gain.original:.4g}{spaced(unit)})" if gain.original is not None else ""
    ratio = gain.base / gain.floor
    many = f", {ratio:.0f} × the {PREDICTION_LIMIT}" if ratio > INADEQUATE_HELD_OUT else ""
    return f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g}{spaced(unit)}{many}{given}."


def as_verified(gain: HeldOutGain, unit: str, *, extended: bool) -> Iterator[str]:
    """The same in the measure of ``smarig verify``, and what differs; nothing if the measures are the same."""
    if gain.weight is None and (gain.settled is None or gain.settled.all()):
        return
    errors = [gain.settled_rms(gain.base_error)]
    if extended:
        errors.append(gain.settled_rms(gain.extended_error))
    shown = " → ".join(f"{error:.4g}" for error in errors)
    yield (
        f"At the settled points only, all with one weight, as smarig verify counts: {shown}{spaced(unit)}. The "
        "figures before also count positions during motion, and weight each by 1/σ² of its prediction. The zero of "
        "the output is estimated from all training runs; smarig verify takes that of the model."
    )


def nearest_text(nearest: NearestEffect) -> str:
    """The effect that comes nearest to a name, by how much it falls short, and what helps if it is the cause."""
    effect = nearest.effect
    primary, gap = effect.kind.primary, f"{nearest.gain:.3g} of the {nearest.required:.0f}"
    strength = f"{parameter_words(primary.name, primary.unit)} {effect.strength:.3g}{spaced(primary.unit)}"
    helps = effect.kind.remedy_text
    return (
        f"Nearest effect of the catalogue: {effect.kind.name} ({strength}). It is not named, because it raises the log "
        f"likelihood of these data by only {gap} nats that a name needs." + (f" {helps}" if helps else "")
    )


def unknown_text(d: "Diagnosis") -> str:
    """The finding of the verdict "unknown", as a clause."""
    if d.verdict.depends_on is None and not d.nearest:
        return "something is wrong, but no known effect and no single variable explains it"
    known = "no effect of the catalogue is certain" if d.nearest else "no known effect explains it"
    if d.verdict.depends_on is None:
        return f"something is wrong, but {known}"
    return f"something is wrong and depends on {variable_words(d.verdict.depends_on)}, but {known}"


def share_text(share: float) -> str:
    """R with two decimals, or with as many as distinguish it from 1.

    >>> share_text(0.937), share_text(0.99986), share_text(-20.8193)
    ('0.94', '0.9999', '−20.82')
    """
    left = 1 - share
    digits = int(np.clip(np.ceil(-np.log10(left)), 2, 5)) if left > 0 else 2
    return f"{share:.{digits}f}".replace("-", "−")

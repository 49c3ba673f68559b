"""The sentences of a diagnosis of commanded runs."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from smarig.diagnosis.comparison.verdict_rules import RULES, SENTENCES
from smarig.diagnosis.comparison.verdict_sentences import verdict_lines
from smarig.diagnosis.diagnosis_text import (
    as_verified,
    gain_text,
    held_out_text,
    learned_gain_text,
    no_extension_text,
)
from smarig.diagnosis.noise_terms import POINT_NOISE

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.commanded.commanded_diagnosis import CommandedDiagnosis

MIN_UNRECORDED_S = 60.0  # shorter gaps: two commands typed one after the other
NO_EXTENSION = (
    "it predicts the held-out runs worse, or the errors go with a variable and not with its effects"
)


def commanded_lines(d: "CommandedDiagnosis") -> Iterator[str]:
    """The findings, one or two sentences per line; the verdict first."""
    silence = f"Nothing stands out. {SENTENCES[d.verdict.reason]}"
    yield from verdict_lines(d.verdict, d.findings, d.causes, silence)
    if d.verdict.word == "silent":
        yield _tested(d)
    if d.verdict.word == "named":
        yield from filter(None, (e.kind.remedy_text for e in d.likely_effects))
    yield from _learned(d)
    yield from _errors(d)
    yield from _limits(d)
    if d.gain is not None:
        yield gain_text(d.gain, d.error.unit) if d.extended else held_out_text(d.gain, d.error.unit)
        yield from as_verified(d.gain, d.error.unit, extended=d.extended)
    if d.missing is not None:
        yield d.missing.sentence("K")
    if d.separating_run:
        yield d.separating_run["why"]
    if d.not_identifiable:
        yield f"Effects that these data cannot show at any strength: {', '.join(d.not_identifiable)}."


def _tested(d: "CommandedDiagnosis") -> str:
    """On what data nothing stands out."""
    points, excursions = len(d.timeline.settled), d.evidence.blocks
    effects = len(d.subject.catalogue) - len(d.not_identifiable)
    held_out = "no run was held out" if d.gain is None else f"held out: {d.gain.blocks} blocks"
    return (
        f"Tested: {effects} of {len(d.subject.catalogue)} effects, on {points} settled points in {excursions} "
        f"excursions; {held_out}."
    )


def _learned(d: "CommandedDiagnosis") -> Iterator[str]:
    """What was learned in place of a cause, or why no extended model is offered."""
    law = d.learned
    if law is not None:
        place = law.shape.enters.replace("_", " ")
        yield f"A term at the {place} that depends on {law.shape.variable_text} was learned."
        yield learned_gain_text(law.gain_blocks, law.looks_like)
    elif d.extended and d.verdict.word == "unknown":
        names = " and ".join(e.kind.name for e in d.extension.extended.catalogue_effects)
        yield f"The extended model has {names}, which predicts best; that it is the cause is not certain."
    elif not d.extended and d.extension.parts and d.verdict.word != "silent":
        yield no_extension_text(NO_EXTENSION)


def _errors(d: "CommandedDiagnosis") -> Iterator[str]:
    e = d.error
    yield (
        f"Settled points, rms error: {e.original:.4g} {e.unit} (given model), {e.base:.4g} {e.unit} (base model, "
        "refitted without effects)"
        + (f", {e.extended:.4g} {e.unit} (extended model)" if d.extended else "")
        + f"; {POINT_NOISE} {e.noise_floor:.2g} {e.unit}."
    )
    if d.times_noise > RULES["adequate"].value:
        scatter = f"{d.scatter:.2g} {e.unit}"
        yield f"Without effects, the model misses these runs by {d.times_noise:.0f} × their scatter of {scatter}."
    if d.given_is_far:
        yield (
            "The given model is far from these data, with or without effects. The model of this diagnosis is fitted "
            "to them."
        )


def _limits(d: "CommandedDiagnosis") -> Iterator[str]:
    """What is wrong with the runs themselves."""
    timeline = d.timeline
    unsettled = [step for run in timeline.runs for step in run.settled if step.verdict == "timed_out"]
    if unsettled:
        yield f"{len(unsettled)} of {len(timeline.settled)} settled points had not settled by their time limit."
    if timeline.unrecorded_gap_s > MIN_UNRECORDED_S:
        yield (
            f"{timeline.unrecorded_gap_s / 60:.0f} min between these runs are not recorded. If the wire was driven "
            "then, effects of time and of cycles are assessed wrongly. Give every run of the session."
        )

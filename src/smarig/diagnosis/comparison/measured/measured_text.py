"""The sentences of a diagnosis of runs with a measured input."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from smarig.core import spaced
from smarig.diagnosis.comparison.measured.measured_comparison import RunOffset
from smarig.diagnosis.comparison.verdict_rules import RULES
from smarig.diagnosis.comparison.verdict_sentences import verdict_lines
from smarig.diagnosis.diagnosis_text import (
    FAR_OFF_RATIO,
    gain_text,
    held_out_text,
    learned_gain_text,
    no_extension_text,
)
from smarig.diagnosis.looks_like import looks_like
from smarig.diagnosis.suspects import suspect_lines, suspects
from smarig.identification import assumed_starts, assumed_starts_text

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis

PROPERTIES = {  # what is to be expected of every Preisach operator, in case it fails
    "return_point": "Minor loops do not return: where an excursion of the input closes, the output differs",
    "wiping_out": "Wiping-out fails: branches that start at the same end of the input differ",
}
NO_EXTENSION = "it predicts blocks left out of the fit, or the held-out runs, no better"
NO_LAW = "a law of one of the variables that vary together here may be wrong where they do not"


def measured_lines(d: "MeasuredDiagnosis") -> Iterator[str]:
    """The findings, one or two sentences per line; the verdict first, then conditions that could cause it."""
    yield from verdict_lines(d.verdict, d.findings, d.causes, _silence(d))
    yield from d.conditions
    for name in d.measured_once:
        yield (
            f"Each {name} was measured in one run only: another change from run to run that goes with it would look "
            f"the same. Repeat the first {name} to exclude this."
        )
    yield from _learned(d)
    yield adequacy_text(d)
    yield from _properties(d)
    yield from _limits(d)
    yield from _held_out(d)
    yield from _missing(d)
    for offset in d.offsets:
        yield offset_sentence(offset, d.runs[0].input_unit, d.unit)
    lost = sum(r.dropouts for r in d.records)
    if lost:
        yield f"{lost} rows in which the input reads exactly 0 are drop-outs of the instrument and were left out."
    yield from suspect_lines(suspects(d.runs), d.not_testable, d.verdict.names)
    if d.not_testable:
        yield f"Effects that these data cannot show: {', '.join(d.not_testable)}."


def offset_sentence(offset: RunOffset, input_unit: str, unit: str) -> str:
    """By how much the loop of a run lies higher or lower along the input, and what that explains.

    An offset is added to the reading, so a negative one says that the loop lies higher.
    """
    ends = sorted(-e for e in offset.interval)
    shift = f"{-offset.offset:.3g} [{ends[0]:.3g}, {ends[1]:.3g}] {input_unit}"
    which = "held-out run" if offset.held_out else "training run"
    return (
        f"The loop of {which} {offset.run} is shifted by {shift} along the input against {offset.against}: the reading "
        "of the input, the load or the specimen differs. With this shift, blocks of that run that are left out are "
        f"predicted to {offset.with_offset:.4g}{spaced(unit)} instead of {offset.without:.4g}{spaced(unit)}."
    )


def _silence(d: "MeasuredDiagnosis") -> str:
    size = d.base.rms / float(np.ptp(d.comparison.plan.y[d.comparison.train]))
    error = f"{100 * size:.2f} % of the range"
    return f"Nothing stands out: a Preisach model predicts blocks left out of the fit to {error}."


def _learned(d: "MeasuredDiagnosis") -> Iterator[str]:
    """What was learned in place of a cause, or why no extended model is offered."""
    law = d.learned
    if d.extension is None and not d.evidence.between_runs and (d.findings or d.verdict.depends_on):
        yield no_extension_text(NO_LAW if d.verdict.reason == "confounded" else NO_EXTENSION)
    for term in law.terms if law else ():
        of = " and ".join(v.replace("_", " ") for v in term.variables)
        formula = law.formula(term) if law else None
        values = f": {formula}" if formula else ""
        yield f"A term at the {term.enters} that depends on {of} was learned{values}."
    if law:
        yield learned_gain_text(law.gain_blocks, looks_like(law.terms[0].variable))


def _missing(d: "MeasuredDiagnosis") -> Iterator[str]:
    """What the training runs do not determine and the held-out runs need."""
    if d.evidence.missing is not None:
        yield d.evidence.missing.sentence(d.runs[0].input_unit)


def adequacy_text(d: "MeasuredDiagnosis") -> str:
    """How far the plain and the extended model miss the runs, against the noise of a reading."""
    ratio = d.base.rms / d.noise if d.noise else float("inf")
    found = "the learned term" if d.learned else "the effects found"
    extended = f", with {found} by {d.best.rms:.4g}{spaced(d.unit)}" if d.best else ""
    size = f" ({ratio:.0f} × the noise)" if ratio > RULES["adequate"].value else ""
    return (
        "On blocks left out of the fit, a Preisach model misses the training runs by "
        f"{d.base.rms:.4g}{spaced(d.unit)} rms"
        f"{size}{extended}; noise of one reading {d.noise:.2g}{spaced(d.unit)}."
    )


def _held_out(d: "MeasuredDiagnosis") -> Iterator[str]:
    """The errors on held-out runs."""
    if d.gain is None:
        return
    errors = gain_text(d.gain, d.unit) if d.extended else held_out_text(d.gain, d.unit)
    yield (
        f"{errors} These errors are at {d.gain.block.size} readings, spread along the branches; smarig verify and "
        "smarig study count every row, so their figures differ."
    )


def _properties(d: "MeasuredDiagnosis") -> Iterator[str]:
    """The properties of every Preisach operator that these records do not have; nothing if all is well otherwise."""
    for test in d.properties if d.verdict.word != "silent" else ():
        if not test.holds:
            yield (
                f"{PROPERTIES[test.name]} by {test.violated_rms:.3g}{spaced(d.unit)} rms in {test.tested} comparisons "
                f"(noise {test.noise:.2g}{spaced(d.unit)}). No Preisach operator of the recorded "
                "input does so: either the "
                "wire is none, or its input or output also depends on the time or the rate."
            )


def _limits(d: "MeasuredDiagnosis") -> Iterator[str]:
    given, sentences = d.given_rms, assumed_starts_text(assumed_starts(d.given, d.runs), d.unit)
    if given is not None and given > FAR_OFF_RATIO * max(d.rms(), d.noise):
        cure = "State how the runs start, then identify" if sentences else "Identify"
        yield f"The given model is far from these data, with or without effects. {cure} it again from them."
    yield from sentences
    starts = list(zip((r.name for r in d.records), d.comparison.plan.starts))
    for name in dict.fromkeys(name for name, start in starts if start.contradicted):
        yield (
            f"The first branch of {name} differs from all later ones from the same end of the input, or the output "
            "never comes back to where it began: the specimen began in another state. The branch was left out."
        )
    assumed = dict.fromkeys(name for name, start in starts if start.assumed and not start.contradicted)
    if assumed and not sentences:
        yield (
            f"The state at the start of {', '.join(assumed)} is not recorded and was assumed from the first input. "
            'If you know it, write initial = "negative" or "positive" in the mapping and import again.'
        )

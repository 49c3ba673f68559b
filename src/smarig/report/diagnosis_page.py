"""The page of a diagnosis: verdict, residuals, causes and hypotheses, noise, gain and the next experiment."""

from collections.abc import Iterator

from smarig.diagnosis import CommandedDiagnosis, MeasuredDiagnosis
from smarig.plant import effect_types
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, bullets, notice, paragraph, tag
from smarig.report.components.numbers import duration
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.diagnosis.compared_causes import compared_causes
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions, noise_budget
from smarig.report.diagnosis.gain_figure import gain_figure
from smarig.report.diagnosis.learned_law_figure import commanded_law_figure
from smarig.report.diagnosis.residual_figures import residual_figure
from smarig.report.diagnosis.verdict_text import (
    SEVERITY_LEVELS,
    distinguishing_text,
    next_experiment,
    summary,
    verdict_sentence,
)
from smarig.report.measured_diagnosis_page import measured_diagnosis_page
from smarig.report.run_page import ending_notices, run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import record_parts
from smarig.report.runs.run_title import titled

Parts = Iterator[Html | Figure]


def diagnosis_page(d: CommandedDiagnosis | MeasuredDiagnosis) -> str:
    """The self-contained HTML page of a diagnosis, for ``write_page``."""
    return measured_diagnosis_page(d) if isinstance(d, MeasuredDiagnosis) else _commanded_page(d)


def _commanded_page(d: CommandedDiagnosis) -> str:
    sections = [Section(title, short, list(parts(d))) for title, short, parts in _SECTIONS]
    runs = d.timeline.runs
    return page(
        titled("Diagnosis", runs),
        f"{run_lead(*runs)}; model {d.model.name}",
        [section for section in sections if section.parts],
        label=source_label(*runs),
        notices=ending_notices(list(runs)),
        summary=summary_with_loop("diagnosis", verdict_sentence(d), SEVERITY_LEVELS[d.verdict.word], runs[0]),
    )


def _residuals(d: CommandedDiagnosis) -> Parts:
    if not d.extended:
        yield paragraph("No effect was added to the model, so the figures show the base model only.")
    yield residual_figure(DiagnosisPredictions.of(d))
    if d.error.base > 1.5 * d.error.original:
        yield notice(
            "warning",
            paragraph(
                "The density that the diagnosis refitted has a larger error on its own data than the given model: "
                f"{d.error.base:.3g} against {d.error.original:.3g} {display_unit(d.error.unit)} rms. Part of the "
                "residuals above may come from that density. The verdict does not depend on it, because every "
                "hypothesis allows for any smooth density."
            ),
        )


def _compared(d: CommandedDiagnosis) -> Parts:
    yield from compared_causes(d.weights, d.probabilities, source_label(*d.timeline.runs))


def _learned(d: CommandedDiagnosis) -> Parts:
    if d.learned is not None:
        yield commanded_law_figure(d.learned, d.timeline.unit, source_label(*d.timeline.runs))


def _unseen(d: CommandedDiagnosis) -> Parts:
    types = {t.name: t for t in effect_types()}
    if d.not_identifiable:
        yield paragraph(
            tag("b", "Effects that these data cannot show at any strength, and what would show them:")
        )
        yield bullets(distinguishing_text(types[n]) for n in d.not_identifiable)
    else:
        yield paragraph("These data would show each effect of the catalogue at some strength.")


def _held_out(d: CommandedDiagnosis) -> Parts:
    if d.gain is None:
        yield paragraph("No held-out run was given, so the gain of the effects on other data is unknown.")
        return
    yield gain_figure(d.gain, d)


def _provenance(d: CommandedDiagnosis) -> Parts:
    words = f"The runs above are the training runs. Model {d.model.name}. Computed in {duration(d.seconds)}."
    yield from record_parts(d.timeline.runs, words)


_SECTIONS = (
    ("Verdict", "Verdict", summary),
    ("Residuals of the model", "Residuals", _residuals),
    ("Effects and variables that were compared", "Compared", _compared),
    ("What was learned in place of a cause", "Learned term", _learned),
    ("Noise and numerics", "Noise", noise_budget),
    ("What could not have been seen", "Visibility", _unseen),
    ("Gain on held-out blocks", "Gain", _held_out),
    ("The next experiment", "Next", next_experiment),
    ("Rig, data quality, provenance", "Provenance", _provenance),
)

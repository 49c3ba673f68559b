"""The page of a diagnosis: residuals, explanations, detection, noise, visibility, gain and the next experiment."""

from collections.abc import Iterator

from smarig.diagnosis import Diagnosis, MeasuredDiagnosis
from smarig.plant import effect_types
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, bullets, notice, paragraph, tag
from smarig.report.components.numbers import duration
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import display_unit, protocol_name, source_label
from smarig.report.components.run_title import titled
from smarig.report.diagnosis.detection_figure import detection_figure, similar_effects_figure
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions
from smarig.report.diagnosis.diagnosis_summary import SEVERITY_LEVELS, summary
from smarig.report.diagnosis.diagnosis_tables import candidates_table, explanations_table, visibility_table
from smarig.report.diagnosis.explanations_figure import explanations_figure
from smarig.report.diagnosis.gain_figure import gain_figure
from smarig.report.diagnosis.input_offset_figure import input_offset_figure
from smarig.report.diagnosis.learned_law_figure import learned_term_figure
from smarig.report.diagnosis.noise_budget import noise_budget
from smarig.report.diagnosis.residual_figures import channel_figure, residual_figure
from smarig.report.diagnosis.verdict_text import distinguishing_text, next_experiment, verdict_sentence
from smarig.report.measured_diagnosis_page import measured_diagnosis_page
from smarig.report.run_page import ending_notices, run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import conditions_table, provenance_table, quality_table

Parts = Iterator[Html | Figure]


def diagnosis_page(d: Diagnosis | MeasuredDiagnosis) -> str:
    """The self-contained HTML page of a diagnosis, for ``write_page``."""
    return measured_diagnosis_page(d) if isinstance(d, MeasuredDiagnosis) else _commanded_page(d)


def _commanded_page(d: Diagnosis) -> str:
    predictions = DiagnosisPredictions.of(d)
    sections = [Section(title, short, list(parts(predictions))) for title, short, parts in _SECTIONS]
    runs = d.timeline.runs
    return page(
        titled("Diagnosis", runs),
        f"{run_lead(*runs)}; model {d.model.name}",
        [section for section in sections if section.parts],
        label=source_label(*runs),
        notices=ending_notices(list(runs)),
        summary=summary_with_loop("diagnosis", verdict_sentence(d), SEVERITY_LEVELS[d.verdict.word], runs[0]),
    )


def _summary(predictions: DiagnosisPredictions) -> Parts:
    yield from summary(predictions.d)


def _residuals(predictions: DiagnosisPredictions) -> Parts:
    d = predictions.d
    if predictions.extended is None:
        yield paragraph("No effect was added to the model, so the figures show the base model only.")
    yield residual_figure(predictions)
    for figure in (channel_figure(predictions), input_offset_figure(predictions)):
        if figure:
            yield figure
    if d.error.base > 1.5 * d.error.original:
        yield notice(
            "warning",
            paragraph(
                "The density that the diagnosis refitted has a larger error on its own data than the given model: "
                f"{d.error.base:.3g} against {d.error.original:.3g} {display_unit(d.error.unit)} rms. Part of the "
                "residuals above may come from that density. The verdict does not depend on it, because the critique "
                "allows for any smooth density."
            ),
        )


def _explanations(predictions: DiagnosisPredictions) -> Parts:
    d = predictions.d
    if d.levels:
        yield explanations_table(d)
    yield candidates_table(d)
    yield explanations_figure(d)


def _learned(predictions: DiagnosisPredictions) -> Parts:
    d = predictions.d
    if d.learned is not None:
        yield learned_term_figure(d.learned, d.timeline.unit, source_label(*d.timeline.runs))


def _detection(predictions: DiagnosisPredictions) -> Parts:
    yield detection_figure(predictions.d)
    not_tested = [s.candidate.name for s in predictions.d.first.scores if not s.candidate.traces.shape[1]]
    if not_tested:
        yield paragraph(f"Not tested, because these data cannot show them: {', '.join(not_tested)}.")


def _noise(predictions: DiagnosisPredictions) -> Parts:
    yield from noise_budget(predictions.d)


def _visibility(predictions: DiagnosisPredictions) -> Parts:
    d, v = predictions.d, predictions.d.visibility
    types = {t.name: t for t in effect_types()}
    yield visibility_table(d, types)
    if v.invisible:
        yield paragraph(
            tag("b", "Effects that these data cannot show at any strength, and what would show them:")
        )
        yield bullets(distinguishing_text(types[n]) for n in v.invisible)
    else:
        yield paragraph(
            f"These data would show each of the {len(v.names)} effects of the catalogue at some strength."
        )
    figure = similar_effects_figure(v, d)
    if figure:
        yield figure
    similar = [n for n in v.names if v.group(n)]
    if similar:
        yield paragraph(tag("b", "What distinguishes similar effects:"))
        yield bullets(distinguishing_text(types[n]) for n in similar)


def _held_out(predictions: DiagnosisPredictions) -> Parts:
    d = predictions.d
    if d.gain is None:
        yield paragraph("No held-out run was given, so the gain of the effects on other data is unknown.")
        return
    yield gain_figure(d.gain, d)


def _next(predictions: DiagnosisPredictions) -> Parts:
    yield from next_experiment(predictions.d)


def _provenance(predictions: DiagnosisPredictions) -> Parts:
    d = predictions.d
    runs = {f"{k}. {protocol_name(run)}": run for k, run in enumerate(d.timeline.runs, start=1)}
    yield conditions_table(d.timeline.runs[0])
    yield quality_table(runs)
    yield provenance_table(runs)
    yield paragraph(
        f"The runs above are the training runs. Model {d.model.name}; {d.nulls} null data sets, α = {d.alpha:g}. "
        f"Computed in {duration(d.seconds)}."
    )


_SECTIONS = (
    ("Verdict", "Verdict", _summary),
    ("Residuals of the model", "Residuals", _residuals),
    ("Competing explanations", "Explanations", _explanations),
    ("What was learned in place of a cause", "Learned term", _learned),
    ("Do the residuals exceed the noise?", "Detection", _detection),
    ("Noise and numerics", "Noise", _noise),
    ("What could not have been seen", "Visibility", _visibility),
    ("Gain on held-out blocks", "Gain", _held_out),
    ("The next experiment", "Next", _next),
    ("Rig, data quality, provenance", "Provenance", _provenance),
)

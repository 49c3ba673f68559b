"""The page of a characterisation: its figures, tables and sentences in order."""

from collections.abc import Callable, Iterator

from smarig.identification import NO_CURVES, POSITIVE_KIND
from smarig.record import Run
from smarig.report.components.decimate import POINTS
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, bullets, notice, paragraph, tag
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import PageSummary
from smarig.report.components.run_description import count_size, protocol_name, source_label
from smarig.report.diagnosis.verdict_text import findings
from smarig.report.models.assessment import assessment
from smarig.report.models.characterisation_cards import characterisation_cards, model_recommendation
from smarig.report.models.evidence import Evidence, training_run
from smarig.report.models.first_order_figures import curves_figure, parameters_figure, replay_figure
from smarig.report.models.held_out_figures import loop_figure, validation_figure
from smarig.report.models.identification_plot_data import density_report_of
from smarig.report.models.model_tables import (
    M_P,
    calibration_table,
    classes_table,
    errors_table,
    parameters_table,
)
from smarig.report.models.plane_figures import density_figure, maps_figure, surface_figure
from smarig.report.models.preisach_verdict import preisach_verdict
from smarig.report.models.tradeoff_figure import tradeoff_figure
from smarig.report.run_page import ending_notices, representation_notice, run_lead
from smarig.report.runs.hysteresis_figure import hysteresis_figure
from smarig.report.runs.representation_figure import representation_figure
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import conditions_table, provenance_table, quality_table
from smarig.report.runs.time_figures import initialisation_figure, time_series_figure
from smarig.report.transformation.transformation_tables import narrowest_temperature_cards

_REST_COUNTS = 4.0
Parts = Iterator[Html | Figure]
_ALL_POINTS = 3_000  # per channel over all runs, so that the page stays below 1 MB


def characterisation_page(evidence: Evidence) -> str:
    """The HTML page of a characterisation: what was found, then its evidence in the order of chapter 5."""
    runs = list(evidence.runs.values())
    sections = [
        Section(title, short, list(parts(evidence)), folded)
        for title, short, parts, folded in _sections(evidence)
    ]
    return page(
        evidence.title,
        run_lead(*runs) if runs else "No runs",
        [section for section in sections if section.parts],
        label=source_label(*runs),
        notices=ending_notices(runs),
        summary=_page_summary(evidence),
    )


def _page_summary(e: Evidence) -> PageSummary:
    found = assessment(e)
    words = f"{found.quality} {found.advice}"
    return summary_with_loop("characterisation", words, found.level, training_run(e))


def _first_screen(e: Evidence) -> Parts:
    """What was measured, whether the model is good, what to do; the loops; the key figures."""
    yield assessment(e).html()
    run = training_run(e)
    figure = loop_figure(e, run) if run is not None else None
    if figure:
        yield figure
    yield characterisation_cards(e)
    temperatures, source = narrowest_temperature_cards(e.runs.values())
    if source:
        yield temperatures
        yield paragraph(source.strip())


def _summary(e: Evidence) -> Parts:
    yield model_recommendation(e)


def _preisach_notice(e: Evidence) -> Html:
    """Whether the wire is a Preisach operator, why, and the errors of its models."""
    verdict = preisach_verdict(e)
    styles = {True: "good", False: "bad", None: "warning"}
    headline, *rest = verdict.sentences()
    style = "warning" if verdict.holds and verdict.is_inaccurate else styles[verdict.holds]
    return notice(style, paragraph(tag("b", headline)), bullets(rest))


def _rig(e: Evidence) -> Parts:
    if e.runs:  # of the longest run: the first one only prepares the wire, and hardly heats it
        run = max(e.runs.values(), key=lambda each: each.span_s)
        yield paragraph(f"Values of the longest run, {run.name}.")
        yield conditions_table(run)
    if e.calibration is not None:
        yield calibration_table(e.calibration)


def _findings(e: Evidence) -> Parts:
    if e.discoveries:
        yield notice("good", paragraph(tag("b", "Findings")), bullets(e.discoveries))
    if e.warnings:
        yield notice("warning", paragraph(tag("b", "Warnings")), bullets(e.warnings))
    if not (e.discoveries or e.warnings):
        yield paragraph("No findings and no warnings.")
    yield quality_table(e.runs)


def _time(e: Evidence) -> Parts:
    points = min(POINTS, _ALL_POINTS // max(1, len(e.runs)))
    for run in _with_samples(e):
        if run.has("t_s") and not (run.info.protocol == "initialise" and _rests(run)):
            yield time_series_figure(run, points, explore=False)


def _rests(run: Run) -> bool:
    """Whether the output only shows noise."""
    low, high = run.extremes("position") or (0.0, 0.0)
    return high - low < _REST_COUNTS * count_size(run)


def _hysteresis_graphs(e: Evidence) -> Parts:
    graphs = [
        hysteresis_figure(run, explore=False).html() for run in _with_samples(e) if len(run.settled) >= 2
    ]
    if graphs:
        yield tag("div", *graphs, class_="pairs")


def _with_samples(e: Evidence) -> list[Run]:
    return [run for run in e.runs.values() if len(run)]


def _initialisation(e: Evidence) -> Parts:
    for run in e.of("initialise"):
        figure = initialisation_figure(run)
        if figure:
            yield figure


def _representation(e: Evidence) -> Parts:
    yield _preisach_notice(e)
    for test in e.representation:
        yield representation_notice(test)
        for run in e.of(test.name)[:1]:
            yield representation_figure(test, run)


def _curves(e: Evidence) -> Parts:
    run = training_run(e)
    if e.best is None or run is None:
        yield paragraph("No model was identified.")
        return
    yield from _first_order_parts(e, run)
    if len(run.settled) >= 2:
        yield replay_figure(e.identifications, run)
    yield surface_figure(e.identifications, e.chosen, run)
    yield errors_table(e.identifications, e.verifications, e.chosen, e.choice)
    first = sorted(e.identifications, key=lambda name: name != e.chosen)
    fitted = [parameters_table(e.identifications[name]) for name in first if name != "table"]
    yield tag("div", *fitted, class_="columns")


def _first_order_parts(e: Evidence, run: Run) -> Parts:
    """The curves with those of the chosen model and of the positive model, which has intervals."""
    if e.best is None or not e.best.data.curves:
        yield paragraph(NO_CURVES)
        return
    yield curves_figure(e.best, run)
    positive = e.identifications.get(POSITIVE_KIND)
    if positive is not None and positive is not e.best and positive.data.curves:
        yield curves_figure(positive, run)
    own = parameters_figure(e.best, run)
    if own:
        yield own


def _density(e: Evidence) -> Parts:
    run = training_run(e)
    if e.best is None or run is None:
        return
    yield classes_table(e.identifications, run)
    yield density_class_text(e)
    if e.choice is not None:
        yield tradeoff_figure(e.choice, e.identifications, e.verifications, run)
    yield maps_figure(e.identifications, run)
    figure = density_figure(e.identifications, e.chosen, run)
    if figure:
        yield figure


def density_class_text(e: Evidence) -> Html:
    """Prop. 4.6 in words, in the direction in which it is proved, and the class of the model."""
    if e.best is None:
        return Html("")
    if e.best.curves.cross:
        wire = "The measured curves cross inside the major loop, so μ of the wire is negative somewhere (Prop. 4.6)."
        wire = f"{wire} {e.best.crossing_note}".rstrip()
    else:
        wire = (
            "The measured curves do not cross. Crossing curves would prove μ < 0 somewhere (Prop. 4.6). The converse "
            "is not proved, so curves that do not cross do not determine the sign of μ."
        )
    if density_report_of(e.best).M_P:
        model = (
            f"The {e.chosen} model has μ ≥ 0. It is in ",
            M_P,
            ", as the theorems on passivity and stability require.",
        )
    else:
        model = (
            f"The {e.chosen} model has μ < 0 somewhere. It is not in ",
            M_P,
            ", so the theorems on passivity and stability do not apply to it.",
        )
    return paragraph(wire, " ", *model)


def _validation(e: Evidence) -> Parts:
    verification = e.verifications.get(e.chosen)
    if verification is None:
        yield paragraph("No held-out run was made, so the model's error on other data is unknown.")
        return
    by_path = {str(run.path): run for run in e.runs.values()}
    for one in verification.runs:
        if one.run in by_path:
            yield validation_figure(one, by_path[one.run], e.chosen)
        for warning in one.warnings:
            yield notice("warning", paragraph(warning))


def _model_errors(e: Evidence) -> Parts:
    """The diagnosis of the chosen model, with a link to its page."""
    if e.diagnosis is None:
        return
    quiet = e.diagnosis.verdict.word in ("silent", "not_identifiable")
    yield notice("good" if quiet else "warning", bullets(findings(e.diagnosis)))
    yield paragraph(
        tag(
            "a",
            "Full diagnosis: residuals, competing explanations, noise, gain",
            href="diagnosis/report.html",
        )
    )


def _provenance(e: Evidence) -> Parts:
    yield provenance_table(e.runs)
    yield paragraph("Command: ", tag("code", e.command))
    yield paragraph(
        f"Computed in {e.seconds:.1f} s. Protocols: ", ", ".join(map(protocol_name, e.runs.values())), "."
    )


def _sections(e: Evidence) -> tuple[tuple[str, str, Callable[[Evidence], Parts], bool], ...]:
    """Titles, names in the navigation, contents, and whether folded: what was found first, evidence below."""
    quiet = e.diagnosis is None or e.diagnosis.verdict.word in ("silent", "not_identifiable")
    diagnosis = ("Diagnosis of the model", "Diagnosis", _model_errors, False)
    model = (
        ("Findings and warnings", "Findings", _findings, False),
        ("Is it a Preisach system? Wiping-out and congruency", "Representation", _representation, False),
        ("Which model the theorems apply to", "Theorems", _summary, False),
        ("First-order curves and the model", "Curves and model", _curves, True),
        ("Weighting function μ and reversible part g", "Density μ", _density, True),
        ("Validation on held-out data", "Validation", _validation, True),
    )
    data = (
        ("Hysteresis graphs", "Hysteresis", _hysteresis_graphs, True),
        ("Time series of the runs", "Time series", _time, True),
        ("Initialisation", "Initialisation", _initialisation, True),
        ("Rig and conditions", "Rig", _rig, True),
        ("Provenance", "Provenance", _provenance, True),
    )
    ordered = (*model, diagnosis) if quiet else (diagnosis, *model)
    return (("", "", _first_screen, False), *ordered, *data)

"""One sheet of paper on a run or a characterisation: three sentences, the loop, key figures, and its origin."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from smarig.core import capitalised, spaced
from smarig.identification import RunVerification, verify
from smarig.record import Run
from smarig.replay import Model, driven_by_input, provenance
from smarig.report.components.figure import Figure, Panel
from smarig.report.components.html import Html, cards, paragraph
from smarig.report.components.numbers import duration, number
from smarig.report.components.page import LIBRARY, Section, page
from smarig.report.components.run_description import (
    display_unit,
    duration_s,
    extent,
    source_label,
)
from smarig.report.model_comparison_page import residuals_figure
from smarig.report.models.assessment import assessment
from smarig.report.models.characterisation_cards import characterisation_cards
from smarig.report.models.evidence import Evidence, training_run
from smarig.report.models.held_out_figures import loop_figure
from smarig.report.run_page import ending_notices, run_lead
from smarig.report.runs.hysteresis_figure import hysteresis_figure
from smarig.report.runs.run_assessment import run_assessment
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_title import run_title, sheet_header
from smarig.report.transformation.transformation_tables import figure_name, narrowest_temperature_cards
from smarig.transformation import headline

_LOOP_PX = 350  # leaves room for the rest of the sheet
_Card = tuple[str | Html, str, str]


def summary_page(run: Run, model: Model | None = None, *, library: str = LIBRARY) -> str:
    """The HTML page, made to be printed on one sheet; ``model`` is verified on the run.

    Raises the errors of ``verify``.
    """
    verified = verify(model, [run]).runs[0] if model is not None else None
    assessed = run_assessment(run, verified, model.name if model else "")
    figure = _figure(run, model, verified)
    parts: list[Html | Figure] = [
        assessed.html(),
        sheet_header([run]),
        figure,
        cards(_cards(run, verified)),
        paragraph(_origin(run, model)),
    ]
    title = f"Summary: {run_title(run)}"
    sentence = f"{assessed.quality} {assessed.advice}"
    return page(
        title,
        run_lead(run),
        [Section("", "", parts)],
        label=source_label(run),
        notices=ending_notices([run]),
        library=library,
        summary=summary_with_loop("summary", sentence, assessed.level, run),
    )


def _figure(run: Run, model: Model | None, verified: RunVerification | None) -> Figure:
    """The loop; with a model, both loops and the error against the input."""
    if model is None or verified is None:
        loop = hysteresis_figure(run, explore=False)
        return replace(loop, panels=[replace(panel, height=_LOOP_PX) for panel in loop.panels])
    whole = residuals_figure(run.name, run, {model.name: model}, {model.name: verified})
    loops, errors, *_ = whole.panels
    plain = Panel(loops.data, loops.layout, loops.height)
    unit, floor = spaced(display_unit(run.unit)), verified.noise_floor
    band = f" Band: ± 2 σ of the noise floor, σ = {number(floor, 2)}{unit}." if floor else ""
    counted = "readings" if driven_by_input([run]) else "settled points"
    words = f"Second panel: measured − model, n = {verified.settled.n} {counted}.{band}"
    return Figure([plain, errors], "Measured and predicted loop, and the error.", [words], whole.label, 460)


def _cards(run: Run, verified: RunVerification | None) -> list[_Card]:
    unit = spaced(display_unit(run.unit))
    found = headline(run) if run.has("input") else {}
    shown: list[_Card] = [
        ("Travel", f"{number(extent(run, 'position'), 4)}{unit}", "largest − smallest settled output")
    ]
    for name, estimate in found.items():
        if name == "stroke":
            continue
        low, high = estimate.ci95
        between = f"{number(low, 4)} to {number(high, 4)}"
        shown.append(
            (figure_name(name), f"{number(estimate.value, 4)}{spaced(display_unit(estimate.unit))}", between)
        )
    if verified is not None:
        floor = f"noise {number(verified.noise_floor, 2)}{unit}" if verified.noise_floor else "noise unknown"
        shown.append(("Error, rms", f"{number(verified.settled.rms)}{unit}", floor))
    if duration_s(run) == duration_s(run):
        shown.append(("Rig time", duration(duration_s(run)), f"{len(run)} samples"))
    return shown


def _origin(run: Run, model: Model | None) -> str:
    """File names, the beginning of the run's hash, and of the model."""
    digest = provenance(run).sha256[:12]
    return f"File {run.path.name}, SHA-256 {digest} …" + (
        f"; model {model.name}, {model.created[:10]}." if model else "."
    )


def characterisation_summary(e: Evidence, *, library: str = LIBRARY) -> str:
    """The HTML page, made to be printed on one sheet."""
    runs, assessed = list(e.runs.values()), assessment(e)
    run = training_run(e)
    figure = loop_figure(e, run) if run is not None else None
    temperatures, source = narrowest_temperature_cards(runs)
    parts: list[Html | Figure] = [
        assessed.html(),
        sheet_header(runs),
        *([figure] if figure else []),
        characterisation_cards(e, theory=False),
        temperatures,
        paragraph(f"{_model_origin(e)}{source}"),
    ]
    return page(
        f"Summary: {e.title[:1].lower()}{e.title[1:]}",
        run_lead(*runs) if runs else "No runs",
        [Section("", "", parts)],
        label=source_label(*runs),
        notices=ending_notices(runs),
        library=library,
        summary=summary_with_loop("summary", f"{assessed.quality} {assessed.advice}", assessed.level, run),
    )


def _model_origin(e: Evidence) -> str:
    """Which model it is, with the runs that it was fitted to and those that were held out."""
    if e.best is None:
        return ""
    fitted = _names(p.run for p in e.best.model.provenance)
    verification = e.verifications.get(e.chosen)
    held_out = _names(found.run for found in verification.runs) if verification else ""
    tested = f", tested on {held_out}" if held_out else ""
    return f"{capitalised(e.chosen)} model, fitted to {fitted}{tested}."


def _names(runs: Iterable[str]) -> str:
    return " and ".join(Path(run).name.removesuffix(".run.sqlite") for run in runs)

"""One sheet of paper on a characterisation: three sentences, the loop with the model, key figures, and its origin."""

from collections.abc import Iterable
from pathlib import Path

from smarig.core import capitalised
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, paragraph
from smarig.report.components.page import LIBRARY, Section, page
from smarig.report.components.run_description import source_label
from smarig.report.models.assessment import assessment
from smarig.report.models.characterisation_cards import characterisation_cards
from smarig.report.models.evidence import Evidence
from smarig.report.models.loop_figure import loop_figure
from smarig.report.models.temperature_cards import temperature_cards
from smarig.report.models.training_run import training_run
from smarig.report.run_page import ending_notices, run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.sheet_header import sheet_header


def characterisation_summary(e: Evidence, *, library: str = LIBRARY) -> str:
    """The HTML page, made to be printed on one sheet."""
    runs, assessed = list(e.runs.values()), assessment(e)
    run = training_run(e)
    figure = loop_figure(e, run) if run is not None else None
    temperatures, source = temperature_cards(runs)
    parts: list[Html | Figure] = [
        assessed.html(),
        sheet_header(runs),
        *([figure] if figure else []),
        characterisation_cards(e, theory=False),
        temperatures,
        paragraph(f"{_origin(e)}{source}"),
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


def _origin(e: Evidence) -> str:
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

"""The page of transformation temperatures: figures, loops with their tangents, cycles, stress, branches, method."""

from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, paragraph
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import source_label
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.transformation.tangent_figure import tangent_figure
from smarig.report.transformation.transformation_tables import (
    branches_text,
    figures_table,
    stress_table,
    temperature_cards,
)
from smarig.report.transformation.trend_figures import cycles_figure, stress_figure
from smarig.transformation import TransformationResult, stated_ranges


def transformation_page(found: TransformationResult) -> str:
    """The HTML page of the transformation temperatures of one run or several."""
    runs = found.runs
    summary: list[Html | Figure] = [temperature_cards(runs[0])] if len(runs) == 1 else []
    summary += [figures_table(run) for run in runs]
    sections = [Section("Figures", "Figures", summary)]
    slopes = stress_figure(runs, found.stress)
    if slopes:
        sections.append(Section("Stress dependence", "Stress", [slopes, stress_table(found.stress)]))
    sections.append(Section("Loops and tangents", "Loops", [tangent_figure(run) for run in runs]))
    cycles = [figure for run in runs if (figure := cycles_figure(run))]
    if cycles:
        sections.append(Section("Cycles", "Cycles", cycles))
    sections.append(Section("Branches", "Branches", [branches_text(run) for run in runs]))
    sections.append(Section("Method", "Method", _method()))
    title = "Transformation temperatures"
    lead = ", ".join(run.name for run in runs)
    label = source_label(*(r.run for r in runs))
    about = summary_with_loop(
        "transformation temperatures", f"{lead}: loops with their tangents.", "", runs[0].run
    )
    return page(title, lead, sections, label=label, summary=about)


def _method() -> list[Html]:
    ranges = stated_ranges()
    shares, gaps, cuts = (
        " or ".join(f"{value:g}" for value in ranges[name])
        for name in ("steep_share", "plateau_gap_spans", "plateau_cut")
    )
    return [
        paragraph(
            "A line is fitted to the plateau at each end of a branch and to its steepest part. The lines meet at the "
            "transformation temperatures (ASTM E3097, F2082). No line is used outside the readings of its loop."
        ),
        paragraph(
            "The result depends on the choice of readings, so each line is fitted to several choices. "
            f"Steep tangent: the middle part of the output between both plateaus, a share of {shares}. Plateaus: all "
            f"readings except those near the knee (within {gaps} × the span from start to finish, at most half of the "
            f"plateau) and those at the end of the branch (a share of {cuts} of the plateau). Each temperature is the "
            "mean over all choices. Its 95 % interval includes the noise of the readings and the part of the spread "
            "of the choices that noise does not explain."
        ),
    ]

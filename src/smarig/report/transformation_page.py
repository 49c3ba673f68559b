"""The page of transformation temperatures: figures, loops with their tangents, cycles, stress, branches, method."""

from smarig.core import spaced
from smarig.report.components.html import Html, paragraph, with_subscripts
from smarig.report.components.numbers import number, to_interval
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_title import titled
from smarig.report.transformation.tangent_figures import cycles_figure, stress_figure, tangent_figure
from smarig.report.transformation.transformation_tables import (
    branches_text,
    figures_table,
    stress_table,
    temperature_cards,
)
from smarig.transformation import RunFigures, TransformationResult, stated_ranges, why_not

_SIZES = (("stroke", "stroke"), ("width", "width of the hysteresis"))


def transformation_page(found: TransformationResult) -> str:
    """The HTML page of the transformation temperatures of one run or several."""
    runs = found.runs
    first, *others = runs
    cards = [] if others else [temperature_cards(first)]
    sections = [
        Section("", "Summary", [_opening(found), tangent_figure(first), *cards]),
        Section("Figures with intervals", "Figures", [figures_table(run) for run in runs]),
    ]
    slopes = stress_figure(runs, found.stress)
    if slopes:
        sections.append(Section("Stress dependence", "Stress", [slopes, stress_table(found.stress)]))
    if others:
        sections.append(
            Section("Loops and tangents of the other runs", "Loops", [tangent_figure(run) for run in others])
        )
    cycles = [figure for run in runs if (figure := cycles_figure(run))]
    if cycles:
        sections.append(Section("Cycles", "Cycles", cycles))
    sections.append(Section("Branches", "Branches", [branches_text(run) for run in runs]))
    sections.append(Section("Method", "Method", _method()))
    title = titled("Transformation temperatures", [run.run for run in runs])
    lead = ", ".join(run.name for run in runs)
    label = source_label(*(r.run for r in runs))
    about = summary_with_loop(
        "transformation temperatures", f"{lead}: loops with their tangents.", "", runs[0].run
    )
    return page(title, lead, sections, label=label, summary=about)


def _opening(found: TransformationResult) -> Html:
    """What the wire does on heating and cooling, how wide its hysteresis is, and what load changes."""
    first = found.runs[0]
    which = (
        f" Values of {first.name}; the tables hold all {len(found.runs)} runs." if len(found.runs) > 1 else ""
    )
    return paragraph(
        *map(
            with_subscripts,
            (
                f"{_branch(first, 'heating', 'A', 'austenite')} ",
                f"{_branch(first, 'cooling', 'M', 'martensite')} ",
            ),
        ),
        f"{_width(first)}{which}",
    )


def _branch(run: RunFigures, direction: str, phase: str, name: str) -> str:
    """From where to where a branch transforms."""
    start, finish = f"{phase}_s", f"{phase}_f"
    if start not in run.means or finish not in run.means:
        missing = start if start not in run.means else finish
        return f"On {direction}, {missing} is not given: {why_not(run, missing)}."
    ends = f"{start} = {_value(run, start)} to {finish} = {_value(run, finish)}"
    unsure = "".join(f" {_not_measured(run, one)}" for one in (start, finish) if one in run.gaps)
    return f"On {direction}, the material transforms to {name} from {ends}.{unsure}"


def _not_measured(run: RunFigures, name: str) -> str:
    low, high = (number(v) for v in run.gaps[name])
    unit = spaced(display_unit(run.unit_of(name)))
    return f"Nothing was measured between {low} and {high}{unit}, where {name} lies."


def _width(run: RunFigures) -> str:
    parts = [f"{words} is {_value(run, name)}" for name, words in _SIZES if name in run.means]
    return f"The {' and the '.join(parts)}." if parts else "Neither stroke nor width can be given."


def _value(run: RunFigures, name: str) -> str:
    found = run.means[name]
    return f"{to_interval(found.value, found.ci95)}{spaced(display_unit(run.unit_of(name)))}"


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

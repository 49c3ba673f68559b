"""The page that compares runs: differences of their metadata and of their measurements.

Closed-loop runs are compared by their errors, in their own section.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from smarig.core import NotToml, UsageError, parsed_toml
from smarig.record import Run
from smarig.report.closed_loop.loop_comparison import loops_section
from smarig.report.closed_loop.loop_result import is_closed_loop
from smarig.report.components.comparison_labels import banner, check_comparable_count
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, paragraph, table
from smarig.report.components.numbers import duration, number
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import Assessment
from smarig.report.components.run_description import (
    display_unit,
    duration_s,
    protocol_name,
    quality_counts,
    source_label,
)
from smarig.report.components.style import COMPARED
from smarig.report.run_page import ending_notices
from smarig.report.runs.comparison_assessment import comparison_assessment
from smarig.report.runs.run_alignment import AlignedRun, aligned, check_same_units
from smarig.report.runs.run_comparison_figures import (
    coloured,
    differences_figure,
    overlay_figure,
    sheet_figure,
    time_overlay_figure,
    with_colours,
)
from smarig.report.runs.run_family import family_figures, trend_figure
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import provenance_table, quality_table
from smarig.report.runs.run_title import sheet_header, titled
from smarig.report.transformation.transformation_tables import temperature_table

_DESCRIPTION = (
    "rig",
    "wire",
    "actuator",
    "protocol",
    "source",
    "seed",
    "initial",
    "encoder_zero",
    "period_s",
    "effects",
    "notes",
)
_MOST_RUNS = 60
_GROUPS = ("settings", "conditions", "versions")


def comparison_page(runs: Mapping[str, Run], *, summary: bool = False) -> str:
    """The HTML page of runs by name; the first run is the one that the others are compared with. ``summary``: the first
    screen alone, made to be printed on one sheet.

    Raises UsageError for more runs than distinguishable colours, and for different units.
    """
    _check_count(runs)
    check_same_units(runs)
    loops = {name: run for name, run in runs.items() if is_closed_loop(run)}
    others = {name: run for name, run in runs.items() if name not in loops}
    found = aligned(others) if others else []
    if found:
        found = with_colours(found, family_figures(list(others.values())).variable)
    assessed, opening = _first_screen(found, sheet=summary)
    sections = [*opening, *loops_section(loops, first=len(others))]
    if not summary:
        sections += _details(runs, found)
    label, words = banner([source_label(run) for run in runs.values()])
    first, *rest = runs
    lead = f"{', '.join(rest)} compared with {first}"
    title = f"{'Summary: ' if summary else ''}{_title(list(runs.values()))}"
    notices = ending_notices(list(runs.values()))
    sentence = f"{assessed.quality} {assessed.advice}" if assessed else lead
    about = summary_with_loop("comparison of runs", sentence, assessed.level if assessed else "", runs[first])
    return page(title, lead, sections, label=label, simulated=words, notices=notices, summary=about)


def _details(runs: Mapping[str, Run], found: Sequence[AlignedRun]) -> list[Section]:
    """What differs in numbers and over time, and where it comes from."""
    temperatures = temperature_table({each.name: each.run for each in found})
    numbers = [
        *([_numbers_table(found)] if found else []),
        *([temperatures] if temperatures else []),
        _metadata_differences(runs),
    ]
    time_parts = _time_parts(found)
    return [
        Section("Differences in numbers", "Numbers", numbers),
        *([Section("Time series", "Time", time_parts)] if time_parts else []),
        Section("Data quality", "Data quality", [quality_table(runs)], folded=True),
        Section("Provenance", "Provenance", [provenance_table(runs)], folded=True),
    ]


def _title(runs: Sequence[Run]) -> str:
    """The common protocol and wire with the dates, or the number of runs."""
    names = {protocol_name(run) for run in runs}
    what = f"{len(runs)} runs" if len(names) > 1 else f"{len(runs)} runs of {names.pop()}"
    return (
        titled(f"Comparison of {what}", runs)
        if len({run.info.wire for run in runs}) == 1
        else f"Comparison of {what}"
    )


def _first_screen(found: Sequence[AlignedRun], *, sheet: bool) -> tuple[Assessment | None, list[Section]]:
    """The sentences with the overlaid loops, their differences and trends; closed loops have their own figures."""
    if not found:
        return None, []
    runs = [each.run for each in found]
    family = family_figures(runs)
    assessed = comparison_assessment(found, family) if len(found) > 1 else None
    box = [assessed.html()] if assessed else []
    if sheet:
        parts = [*box, sheet_header(runs), sheet_figure(found, family.variable)]
        return assessed, [Section("", "Summary", parts)]
    figures = (overlay_figure(found, family.variable), differences_figure(found), trend_figure(family, runs))
    return assessed, [
        Section(
            "",
            "Summary",
            [*box, *(figure for figure in figures if figure)],
        )
    ]


def _check_count(runs: Mapping[str, Run]) -> None:
    """UsageError for more runs than can be told apart: of closed loops by colours, of others as a family."""
    loops = [name for name, run in runs.items() if is_closed_loop(run)]
    check_comparable_count(loops, "closed loops")
    if len(runs) > _MOST_RUNS:
        raise UsageError(f"{len(runs)} runs are too many for one page. Compare at most {_MOST_RUNS}.")


def _time_parts(found: Sequence[AlignedRun]) -> list[Figure]:
    figure = time_overlay_figure(found) if 0 < len(found) <= len(COMPARED) else None
    return [figure] if figure else []


def _numbers_table(found: Sequence[AlignedRun]) -> Html:
    unit = display_unit(found[0].run.unit)
    rows = []
    for k, each in enumerate(found):
        known = each.run["position"][np.isfinite(each.run["position"])]
        m = quality_counts(each.run)
        rows.append(
            (
                coloured(each.colour, each.name),
                each.run.info.source or "unknown",
                duration(duration_s(each.run)),
                f"{m.settled} of {m.steps}",
                number(float(np.ptp(known)), 4) if known.size else "–",
                *_difference_cells(each, first=k == 0),
            )
        )
    header = (
        "Run",
        "Source",
        "Duration",
        "Steps settled",
        f"Travel ({unit})",
        "Steps in common",
        f"Shift ({unit})",
    )
    return table(
        (*header, f"rms difference ({unit})", f"largest ({unit})", f"σ of a difference ({unit})"),
        rows,
        f"The runs, and their differences from {found[0].name} at the common steps.",
    )


def _difference_cells(each: AlignedRun, *, first: bool) -> tuple[str, ...]:
    n = str(each.difference.size)
    if first:
        return n, "reference", "–", "–", "–"
    kinds = {
        "known": "0, one zero",
        "power-up": "0, zeroed in one state",
        "fitted": f"{number(each.offset)}, fitted",
        "cold": "0, zeroed cold",
        "unknown": "none",
    }
    return n, kinds[each.offset_kind], number(each.rms), number(each.max_abs), number(each.noise)


def _metadata_differences(runs: Mapping[str, Run]) -> Html:
    """A table of metadata that differ between the runs; a sentence if none differ."""
    metadata = {name: dict(_metadata_items(run)) for name, run in runs.items()}
    keys = dict.fromkeys(key for each in metadata.values() for key in each)
    rows = [(key, *(each.get(key, "–") for each in metadata.values())) for key in keys]
    rows = [row for row in rows if len(set(row[1:])) > 1]
    if not rows:
        return paragraph("Rig, wire, protocol, settings and versions are the same in all runs.")
    return table(
        ("Item", *runs),
        rows,
        "Metadata that differ between the runs. All other metadata in the files are equal.",
    )


def _metadata_items(run: Run) -> Iterator[tuple[str, str]]:
    """The metadata of a run file as flat pairs of name and value."""
    for key in _DESCRIPTION:
        if run.meta.get(key) is not None:
            yield from _flattened(key.replace("_", " "), run.meta[key])
    for group in _GROUPS:
        yield from _flattened(group, run.meta.get(group) or {})
    known = run["ambient_degC"][np.isfinite(run["ambient_degC"])]
    if known.size:
        stated = f" ({run.info.ambient_from}, not measured)" if run.info.ambient_from else ""
        yield "ambient, mean (°C)", f"{known.mean():.1f}{stated}"
    try:
        yield from _flattened("rig file", parsed_toml(run.info.config or ""))
    except NotToml:
        yield "rig file", "not readable"


def _flattened(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flattened(f"{name}: {key}" if ":" not in name else f"{name}.{key}", inner)
    else:
        yield name, (", ".join(map(str, value)) or "none") if isinstance(value, list) else str(value)

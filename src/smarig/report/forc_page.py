"""The page of first-order (reversal) curves: FORC diagram, profiles, smoothing, corrections, and provenance."""

from collections.abc import Iterator

from smarig.core import capitalised
from smarig.record import Run
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, cards, joined, paragraph, plain
from smarig.report.components.numbers import number
from smarig.report.components.page import LIBRARY, Section, page
from smarig.report.components.run_description import protocol_name, source_label
from smarig.report.forc.curve_figures import (
    curves_caption,
    curves_panel,
    drift_figure,
    profiles_figure,
    ridge_figure,
    smoothing_figure,
)
from smarig.report.forc.diagram_figures import (
    density_words,
    diagram_caption,
    diagram_panel,
    planes_figure,
    smoothings_figure,
)
from smarig.report.forc.forc_evidence import ForcEvidence, forc_assessment, forc_evidence
from smarig.report.run_page import ending_notices, run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import conditions_table, provenance_table, quality_table, settings_text


def forc_page(run: Run, *, smoothing: float | None = None, library: str = LIBRARY) -> str:
    """The HTML page of a run with first-order curves; ``smoothing`` is the factor SF in grid steps, chosen if None.

    ``library`` is the address of the interactive library, relative to the page. Raises DataError for a run without
    first-order curves, UsageError for an impossible factor.
    """
    e = forc_evidence(run, smoothing)
    found = forc_assessment(e)
    sections = [
        Section("", "Summary", [found.html(), diagram_figure(e), _cards(e)]),
        Section("Profiles and Preisach plane", "Profiles", _present(profiles_figure(e), planes_figure(e))),
        *_ridge_sections(e),
        Section("Smoothing", "Smoothing", _present(smoothing_figure(e), smoothings_figure(e)), folded=True),
        Section("Corrections", "Corrections", list(_corrections(e)), folded=True),
        Section("Settings, conditions and data quality", "Settings", _conditions(run), folded=True),
        Section("Provenance", "Provenance", [provenance_table({protocol_name(run): run})], folded=True),
    ]
    sections = [section for section in sections if section.parts]
    title = "First-order reversal curves" if e.magnetic else "First-order curves"
    return page(
        title,
        run_lead(run),
        sections,
        label=source_label(run),
        notices=ending_notices([run]),
        library=library,
        summary=summary_with_loop("FORC diagram", plain(found.measured), found.level, run),
    )


def diagram_figure(e: ForcEvidence) -> Figure:
    """The diagram beside the curves it was computed from."""
    return Figure(
        [diagram_panel(e), curves_panel(e)],
        "FORC diagram." if e.magnetic else "First-order density.",
        [f"{diagram_caption(e)} Second panel: {curves_caption(e)}."],
        source_label(e.run),
        460,
    )


def _present(*figures: Figure | None) -> list[Figure]:
    return [figure for figure in figures if figure is not None]


def _cards(e: ForcEvidence) -> Html:
    d, scale = e.diagram, e.scale
    unit = f" {scale.unit}" if scale.unit else ""
    items: list[tuple[str, str, Html | str]] = []
    if d.peak is not None:
        place = f"{number(d.peak.half_width * scale.factor)}, {number(d.peak.centre * scale.factor)}{unit}"
        items.append(("Peak", place, joined([scale.half_width, scale.centre], ", ")))
        items.append(
            ("Density at the peak", density_words(e, d.peak.mu), f"± {density_words(e, d.peak.se, 2)} (1 SE)")
        )
    degree = {2: "quadratic", 3: "cubic", 4: "quartic"}[d.estimate.degree]
    chosen = "chosen" if d.tried else "given"
    note = f"{chosen}; {degree}, {d.estimate.nearest} nearest points"
    items.append(("Smoothing factor", number(d.smoothing_factor, 2), note))
    steps = [number(step * scale.factor) for step in d.estimate.steps]
    items.append(("Steps", f"{' and '.join(steps)}{unit}", "between curves, and along them"))
    return cards(items)


def _ridge_sections(e: ForcEvidence) -> list[Section]:
    if e.ridge is None:
        return []
    return [Section("Central ridge", "Central ridge", [ridge_figure(e, e.ridge)], folded=not e.ridge.present)]


def _corrections(e: ForcEvidence) -> Iterator[Figure | Html]:
    drift = drift_figure(e)
    if drift is not None:
        yield drift
    elif e.magnetic:
        yield paragraph("The file has no calibration points, so drift is neither known nor corrected.")
    yield paragraph(
        "Slope: a straight line added to all curves, such as a paramagnetic or diamagnetic moment, does not change "
        "the density, because the density is a mixed second derivative. None was removed."
        if e.magnetic
        else "Slope: a straight line added to all curves does not change the density, because the density is a mixed "
        "second derivative. None was removed."
    )
    if e.magnetic:
        yield paragraph(
            "Pole pieces: the saturation of pole pieces changes the sensitivity with the field. Files of curves do not "
            "hold the calibration needed to correct it; below 1 T it is usually negligible." + _field_words(e)
        )
    first = e.diagram.estimate
    yield paragraph(
        "First points: every curve is used from its reversal point. Beyond the last measured points nothing is "
        f"extrapolated; {first.ill_conditioned} places with too few or one-sided neighbours are left white."
    )


def _field_words(e: ForcEvidence) -> str:
    low, high = e.run.extremes("input") or (0.0, 0.0)
    largest, scale = max(abs(low), abs(high)), e.scale
    return f" The largest field here is {number(largest * scale.factor)} {scale.unit}."


def _conditions(run: Run) -> list[Html]:
    name = capitalised(protocol_name(run))
    return [settings_text(run), conditions_table(run, None), quality_table({name: run})]

"""The page of one run of any kind: complete, interrupted, imported without time or current, or empty."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from smarig.core import DataError, Severity, spaced
from smarig.record import FORC_PROTOCOL, Run
from smarig.report.closed_loop.loop_result import is_closed_loop
from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, bullets, cards, joined, notice, paragraph, severity_mark, tag
from smarig.report.components.numbers import duration, number, thousands
from smarig.report.components.page import LIBRARY, Section, page
from smarig.report.components.run_description import (
    capitalised,
    conditions_text,
    count_size,
    display_unit,
    duration_s,
    lost_samples,
    protocol_name,
    quality_counts,
    source_label,
)
from smarig.report.runs.derived_quantities import DerivedQuantities
from smarig.report.runs.hysteresis_figure import hysteresis_figure
from smarig.report.runs.run_assessment import run_assessment
from smarig.report.runs.run_tables import (
    conditions_table,
    events_table,
    provenance_table,
    quality_table,
    settings_text,
    steps_table,
)
from smarig.report.runs.run_title import run_title
from smarig.report.runs.time_figures import initialisation_figure, time_series_figure

_MOST_OF_A_KIND = 3  # warnings of one kind that are written out

if TYPE_CHECKING:  # of these packages, most runs need nothing: they take a second and fifty megabytes
    from smarig.identification import Representation
    from smarig.replay import Model


def run_page(
    run: Run,
    *,
    library: str = LIBRARY,
    certified: "tuple[Model, str, str] | None" = None,
    derived: DerivedQuantities | None = None,
) -> str:
    """The HTML page of a run: hysteresis graph, time series, marks, events, conditions and provenance.

    ``library`` is the address of the interactive library, relative to the page. A closed loop has its own sections and,
    with ``certified`` (a model, its file name and hash), the certificate of that model. ``derived``: stress and energy
    of the run, if already computed. Reversal curves have their own page (``forc_page``).
    """
    if run.info.protocol == FORC_PROTOCOL and (reversal := _reversal_page(run, library)):
        return reversal
    data = list(_figure_parts(run))
    data = data or [paragraph("The run has no samples to draw.")]
    summary = Section("", "Summary", [run_assessment(run).html(), *data[:1], run_cards(run)])
    loop = _loop_sections(run, certified)
    sections = [
        *([*loop, Section("Run", "Run", summary.parts)] if loop else [summary]),
        *_transformation_sections(run),
        *([Section("Measurement", "Measurement", data[1:])] if data[1:] else []),
        Section(
            "Data quality",
            "Data quality",
            [quality_table({protocol_name(run): run}), steps_table(run), events_table(run)],
        ),
        Section(
            "Rig, settings and conditions",
            "Rig",
            [settings_text(run), conditions_table(run, derived)],
            folded=True,
        ),
        Section("Provenance", "Provenance", [provenance_table({protocol_name(run): run})], folded=True),
    ]
    title = run_title(run)
    notices = [*ending_notices([run]), *_warnings(run)]
    return page(title, _lead(run), sections, label=source_label(run), notices=notices, library=library)


def _reversal_page(run: Run, library: str) -> str:
    """The page of reversal curves; "" if they are too few for a density."""
    from smarig.report.forc_page import forc_page

    try:
        return forc_page(run, library=library)
    except DataError:
        return ""


def _lead(run: Run) -> Html:
    """The lead with the highest severity of the run's events, if it is not none, and the share of lost samples."""
    if run.remaining_severity == Severity.NONE:
        return joined([run_lead(run)])
    lost = lost_samples(run)
    due = lost + len(run)
    losses = (
        f" {thousands(lost)} of {thousands(due)} samples ({number(100 * lost / due, 2)} %) were lost."
        if lost
        else ""
    )
    return joined(
        [
            run_lead(run),
            ". Highest severity of its events: ",
            severity_mark(run.remaining_severity),
            ".",
            losses,
        ]
    )


def _loop_sections(run: Run, certified: "tuple[Model, str, str] | None") -> list[Section]:
    if not is_closed_loop(run):
        return []
    from smarig.report.closed_loop.closed_loop_sections import loop_sections

    return loop_sections(run, certified)


def _transformation_sections(run: Run) -> list[Section]:
    """Transformation temperatures of a run that heats and cools through the whole transformation."""
    if is_closed_loop(run) or run.input_unit not in ("K", "degC") or not len(run):
        return []
    from smarig.report.transformation.tangent_figures import tangent_figure
    from smarig.report.transformation.transformation_tables import temperature_cards
    from smarig.transformation import full_loop

    found = full_loop(run)
    if found is None:
        return []
    notes = [bullets(found.notes)] if found.notes else []
    parts = [temperature_cards(found), *notes, tangent_figure(found)]
    return [Section("Transformation temperatures", "Transformation", parts)]


def _figure_parts(run: Run) -> Iterator[Figure | Html]:
    """The hysteresis first, unless the section of a closed loop contains it; then the channels against time."""
    if not len(run):
        return
    if not is_closed_loop(run):
        if np.isfinite(run["input"] + run["position"]).any() or len(run.settled) >= 2:
            yield hysteresis_figure(run)
        if run.info.protocol in ("wiping_out", "congruency"):
            yield from _representation_parts(run, run.info.protocol)
    start = initialisation_figure(run)
    if start:
        yield start
    if run.has("t_s") and any(run.has(name) for name in ("current_A", "input", "position")):
        yield time_series_figure(run)


def _representation_parts(run: Run, property_name: str) -> Iterator[Figure | Html]:
    from smarig.identification import congruency, wiping_out
    from smarig.report.runs.representation_figure import representation_figure

    tests: dict[str, Callable[[Run], Representation]] = {"wiping_out": wiping_out, "congruency": congruency}
    try:
        test = tests[property_name](run)
    except DataError as error:
        yield notice("warning", paragraph(str(error)))
        return
    yield representation_notice(test)
    yield representation_figure(test, run)


def representation_notice(test: "Representation") -> Html:
    """A box with the verdict and its meaning."""
    return notice("good" if test.holds else "bad", paragraph(tag("b", test.verdict)), paragraph(test.meaning))


def run_lead(run: Run, *others: Run) -> str:
    """A line with the conditions of a run: wire, rig, seed, ambient temperature (also of ``others``), input, and the
    effects that a twin was given.
    """
    given = dict.fromkeys(effect for each in (run, *others) for effect in each.info.effects)
    simulated = f"simulated with {', '.join(given)}" if given else ""
    return capitalised(", ".join(filter(None, (conditions_text(run, *others), simulated)))) or run.path.name


def run_cards(run: Run) -> Html:
    """Cards with the key figures of a run."""
    m, size = quality_counts(run), 0.0 if run.info.imported else count_size(run)
    known = run["position"][np.isfinite(run["position"])]
    travel = f"{number(float(np.ptp(known)), 4)}{spaced(display_unit(run.unit))}" if known.size else "none"
    bad = m.timed_out + m.interrupted + m.suspect_steps
    timed = np.isfinite(duration_s(run))
    return cards(
        [
            ("Travel", travel, f"{np.ptp(known) / size:.0f} counts" if known.size and size else ""),
            (
                "Duration",
                duration(duration_s(run)),
                "first to last sample" if timed else "no time was recorded",
            ),
            (
                "Samples",
                thousands(m.samples),
                "none marked" if m.clean else "some are marked or missing, see Data quality",
            ),
            ("Steps", str(m.steps), f"{m.settled} settled, {bad} failed" if m.steps else "none recorded"),
        ]
    )


def ending_notices(runs: list[Run]) -> list[Html]:
    """A box with the cause for each run that did not end as planned."""
    return [
        notice(
            "bad",
            paragraph(
                tag("b", f"Incomplete run {run.path.name}: "),
                f"{run.early_end}.",
                f" Its end was requested by {run.stopped_by.text}." if run.stopped_by else "",
            ),
        )
        for run in runs
        if not run.complete or run.cause != "done"
    ]


def _warnings(run: Run) -> list[Html]:
    """The warnings of a run; many of one kind are counted."""
    by_kind: dict[str, list[str]] = {}
    for e in run.events:
        if e.level in ("warning", "error") and e.kind != "end":
            by_kind.setdefault(e.kind, []).append(e.text)
    items = list(run.info.warnings)
    for kind, texts in by_kind.items():
        items += texts[:_MOST_OF_A_KIND]
        if (more := len(texts) - _MOST_OF_A_KIND) > 0:
            items.append(f"{more} more of this kind ({kind}).")
    return [notice("warning", paragraph(tag("b", "Warnings")), bullets(items))] if items else [joined([])]

"""The page of a diagnosis of runs with a measured input: verdict, loops, what was tried, and provenance."""

from collections.abc import Iterator

import numpy as np

from smarig.core import Array, spaced
from smarig.diagnosis import MeasuredDiagnosis
from smarig.identification import MeasuredHypothesis
from smarig.report.components.figure import Figure, Panel, axis, dots, line
from smarig.report.components.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.components.numbers import duration, number
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import (
    display_unit,
    input_title,
    output_title,
    protocol_name,
    source_label,
)
from smarig.report.components.style import COOLING, INK, MODEL
from smarig.report.diagnosis.compared_causes import compared_causes
from smarig.report.diagnosis.learned_law_figure import learned_law_figure
from smarig.report.diagnosis.verdict_levels import SEVERITY_LEVELS
from smarig.report.run_page import run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import conditions_table, provenance_table, quality_table

_MOST_LOOPS = 4  # runs whose loops are drawn
_PALE_OPACITY = 0.45


def measured_diagnosis_page(d: MeasuredDiagnosis) -> str:
    """The self-contained HTML page, for ``write_page``."""
    compared = list(compared_causes(d.evidence.weights, d.probabilities, source_label(*d.runs)))
    sections = [
        Section("Verdict", "Verdict", list(_summary(d))),
        Section("Measured and predicted outputs", "Loops", [_loops_figure(d)]),
        *_learned(d),
        Section("Errors in time order", "Errors", [_errors_figure(d)]),
        Section("Effects and variables that were compared", "Compared", compared),
        Section("Data quality, provenance", "Provenance", list(_provenance(d))),
    ]
    return page(
        "Diagnosis of a model",
        f"{run_lead(*d.runs)}; model {d.model.name}",
        sections,
        label=source_label(*d.runs),
        summary=summary_with_loop("diagnosis", d.lines()[0], SEVERITY_LEVELS[d.verdict.word], d.runs[0]),
    )


def _learned(d: MeasuredDiagnosis) -> Iterator[Section]:
    if d.learned is not None:
        figure = learned_law_figure(d.learned, source_label(*d.runs))
        yield Section("What was learned in place of a cause", "Learned term", [figure])


def _summary(d: MeasuredDiagnosis) -> Iterator[Html]:
    first, *rest = d.lines()
    yield notice(SEVERITY_LEVELS[d.verdict.word], paragraph(tag("b", first)))
    unit = _in_brackets(d.unit)
    after = f" → {number(d.best.rms)}" if d.best else ""
    items = [
        (
            f"Error on blocks left out, rms{unit}",
            f"{number(d.base.rms)}{after}",
            f"noise {number(d.noise, 2)}",
        ),
        (
            "Readings",
            str(int(d.comparison.train.sum())),
            f"of {sum(len(r) for r in d.records[: d.train])} rows",
        ),
    ]
    if d.gain is not None:
        after = f" → {number(d.gain.extended)}" if d.extended else ""
        given = "not predicted" if d.gain.original is None else number(d.gain.original)
        title = f"Held-out runs, rms{unit}"
        items.append((title, f"{number(d.gain.base)}{after}", f"given model {given}"))
    yield cards(items)
    yield bullets(rest)


def _in_brackets(unit: str) -> str:
    """A unit behind a quantity; nothing for a quantity without unit."""
    return f" ({display_unit(unit)})" if spaced(unit) else ""


def _loops_figure(d: MeasuredDiagnosis) -> Figure:
    plan, panels = d.comparison.plan, []
    extended = d.best.fit.error if d.best else None
    for k, record in enumerate(plan.records[:_MOST_LOOPS]):
        own = plan.record == k
        u, y = record.u[plan.rows[k]], record.y[plan.rows[k]]
        data = [
            line(_thin(record.u), _thin(record.y), "measured", INK, opacity=_PALE_OPACITY),
            dots(u, y - _about_mean(d.base.fit.error[own], k >= d.train), "plain model", COOLING),
        ]
        if extended is not None:
            data.append(dots(u, y - _about_mean(extended[own], k >= d.train), "extended model", MODEL))
        run = d.runs[k]
        role = "held-out" if k >= d.train else "training"
        layout = {
            "xaxis": axis(f"{input_title(run)}, {role} run {record.name}"),
            "yaxis": axis(output_title(run)),
        }
        panels.append(Panel(data, layout))
    more = len(plan.records) - len(panels)
    caption = [
        "Dots: predictions at the readings that were used; those of held-out runs about the mean of the run.",
        f"{more} further runs are not drawn." if more > 0 else "",
    ]
    return Figure(panels, "Measured and predicted outputs.", caption, source_label(*d.runs))


def _errors_figure(d: MeasuredDiagnosis) -> Figure:
    plan = d.comparison.plan
    row, train = np.arange(len(plan), dtype=float), int(d.comparison.train.sum())
    data = [dots(row, _centred(d, d.base), "plain model", COOLING)]
    if d.best is not None:
        data.append(dots(row, _centred(d, d.best), "extended model", MODEL))
    layout = {"xaxis": axis("Reading"), "yaxis": axis(f"Measured − predicted{_in_brackets(d.unit)}")}
    caption = [
        f"{train} readings of training runs, then {len(plan) - train} of held-out runs.",
        f"Noise of one reading: {number(d.noise, 2)}{spaced(display_unit(d.unit))}.",
    ]
    return Figure([Panel(data, layout, wide=True)], "Errors of both models.", caption, source_label(*d.runs))


def _provenance(d: MeasuredDiagnosis) -> Iterator[Html]:
    runs = {f"{k}. {protocol_name(run)}": run for k, run in enumerate(d.runs, start=1)}
    yield conditions_table(d.runs[0])
    yield quality_table(runs)
    yield provenance_table(runs)
    yield paragraph(f"Computed in {duration(d.seconds)}.")


def _centred(d: MeasuredDiagnosis, found: MeasuredHypothesis) -> Array:
    plan, error = d.comparison.plan, found.fit.error.copy()
    for k in range(d.train, len(plan.records)):
        own = plan.record == k
        error[own] = _about_mean(error[own], held_out=True)
    return error


def _about_mean(error: Array, held_out: bool) -> Array:
    return error - error.mean() if held_out and error.size else error


def _thin(x: Array, most: int = 1500) -> Array:
    return x[:: max(x.size // most, 1)]

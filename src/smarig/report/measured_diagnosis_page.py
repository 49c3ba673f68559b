"""The pages of diagnoses of runs with a measured input and of a thermal record: verdict, errors, what was compared."""

from collections.abc import Iterator, Sequence

import numpy as np

from smarig.core import Array, spaced
from smarig.diagnosis import MeasuredDiagnosis, ThermalDiagnosis
from smarig.identification import MeasuredHypothesis
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, axis, dots, line
from smarig.report.components.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.components.numbers import duration, number
from smarig.report.components.page import PageSummary, Section, page
from smarig.report.components.run_description import (
    display_unit,
    input_title,
    output_title,
    source_label,
    with_unit,
)
from smarig.report.components.style import COOLING, INK, MODEL
from smarig.report.diagnosis.compared_causes import compared_causes
from smarig.report.diagnosis.learned_law_figure import learned_law_figure
from smarig.report.diagnosis.verdict_text import SEVERITY_LEVELS
from smarig.report.run_page import run_lead
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_tables import record_parts

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
        Section(
            "Data quality, provenance",
            "Provenance",
            _provenance(d.runs, d.seconds),
        ),
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
    after = f" → {number(d.best.rms)}" if d.best else ""
    rows = sum(len(r) for r in d.records[: d.train])
    items = [
        (
            with_unit("Error on blocks left out, rms", d.unit),
            f"{number(d.base.rms)}{after}",
            f"noise {number(d.noise, 2)}",
        ),
        ("Readings", str(int(d.comparison.train.sum())), f"of {rows} rows"),
    ]
    if d.gain is not None:
        after = f" → {number(d.gain.extended)}" if d.extended else ""
        given = "not predicted" if d.gain.original is None else number(d.gain.original)
        title = with_unit("Held-out runs, rms", d.unit)
        items.append((title, f"{number(d.gain.base)}{after}", f"given model {given}"))
    yield cards(items)
    yield bullets(rest)


def _provenance(runs: Sequence[Run], seconds: float) -> list[Html]:
    return list(record_parts(runs, f"Computed in {duration(seconds)}."))


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
        x_axis = axis(f"{input_title(run)}, {role} run {record.name}")
        panels.append(Panel(data, {"xaxis": x_axis, "yaxis": axis(output_title(run))}))
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
    layout = {"xaxis": axis("Reading"), "yaxis": axis(with_unit("Measured − predicted", d.unit))}
    caption = [
        f"{train} readings of training runs, then {len(plan) - train} of held-out runs.",
        f"Noise of one reading: {number(d.noise, 2)}{spaced(display_unit(d.unit))}.",
    ]
    return Figure([Panel(data, layout, wide=True)], "Errors of both models.", caption, source_label(*d.runs))


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


def thermal_diagnosis_page(d: ThermalDiagnosis) -> str:
    """The self-contained HTML page, for ``write_page``."""
    compared = list(compared_causes(d.evidence.weights, d.probabilities, source_label(d.run)))
    sections = [
        Section("Verdict", "Verdict", list(_thermal_summary(d))),
        Section("Measured and predicted temperatures", "Temperatures", [_trace_figure(d)]),
        Section("Errors on blocks left out", "Errors", [_thermal_errors_figure(d)]),
        Section("Effects and variables that were compared", "Compared", compared),
        Section(
            "Data quality, provenance",
            "Provenance",
            _provenance([d.run], d.seconds),
        ),
    ]
    return page(
        "Diagnosis of a wire temperature",
        run_lead(d.run),
        sections,
        label=source_label(d.run),
        summary=PageSummary("diagnosis", d.lines()[0], SEVERITY_LEVELS[d.verdict.word]),
    )


def _thermal_summary(d: ThermalDiagnosis) -> Iterator[Html]:
    first, *rest = d.lines()
    yield notice(SEVERITY_LEVELS[d.verdict.word], paragraph(tag("b", first)))
    after = f" → {number(d.gain.extended)}" if d.candidates else ""
    error = (f"{number(d.gain.base)}{after}", f"noise {number(d.noise, 2)}")
    transients = (str(d.evidence.problem.transients), f"of {d.gain.blocks} blocks")
    yield cards([("Error on blocks left out, rms (K)", *error), ("Transients", *transients)])
    yield bullets(rest)


def _trace_figure(d: ThermalDiagnosis) -> Figure:
    x = d.record
    data = [
        line(x.t, x.temperature, "measured", INK),
        line(x.t, x.temperature - d.base.error, "plain balance", COOLING),
    ]
    if d.candidates:
        data.append(line(x.t, x.temperature - d.extended.error, "extended balance", MODEL))
    layout = {"xaxis": axis(_time(d)), "yaxis": axis("Temperature (°C)")}
    below = {"xaxis": axis(_time(d)), "yaxis": axis("Drive (recorded unit)")}
    panels = [Panel(data, layout, wide=True), Panel([line(x.t, x.bin_drive, "drive", INK)], below)]
    caption = [f"Means over {x.t.size} bins; the balances are fitted to all of them."]
    return Figure(panels, "Temperature and drive.", caption, source_label(d.run))


def _thermal_errors_figure(d: ThermalDiagnosis) -> Figure:
    data = [dots(d.record.t, d.gain.base_error, "plain balance", COOLING)]
    if d.candidates:
        data.append(dots(d.record.t, d.gain.extended_error, "extended balance", MODEL))
    layout = {"xaxis": axis(_time(d)), "yaxis": axis("Measured − predicted (K)")}
    caption = [f"Each of {d.gain.blocks} blocks is predicted from the others."]
    return Figure([Panel(data, layout, wide=True)], "Errors of both balances.", caption, source_label(d.run))


def _time(d: ThermalDiagnosis) -> str:
    return f"Time ({d.record.unit})" if d.record.unit == "s" else "Sample"

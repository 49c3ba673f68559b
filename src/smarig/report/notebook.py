"""Runs, models and diagnoses in a notebook: a drawing of a few kilobytes, and a plotly figure on request.

Figures contain only their data, thinned.
"""

from dataclasses import dataclass
from functools import singledispatch
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError, capitalised, spaced
from smarig.diagnosis import CommandedDiagnosis
from smarig.identification import Identification, Verification, density_report, verify
from smarig.record import Run
from smarig.replay import Model, simulate_samples, with_heating_of
from smarig.report.components.decimate import path
from smarig.report.components.figure import Panel, Trace, axis, dots, error_ground, line
from smarig.report.components.html import Html, bullets, joined, table, tag
from smarig.report.components.numbers import number, runs_text
from smarig.report.components.run_description import (
    count_size,
    display_unit,
    input_title,
    output_title,
    protocol_name,
    source_label,
    with_unit,
)
from smarig.report.components.style import COMPARED, INK, MEASURED, MODEL, SYMBOLS
from smarig.report.components.thumbnail import thumbnail
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions
from smarig.report.diagnosis.residual_figures import residual_figure
from smarig.report.diagnosis.verdict_text import findings
from smarig.report.drawing import draw_on
from smarig.report.models.identification_plot_data import (
    density_of,
    hysteresis_description,
    measured_curves,
    model_curves,
    model_loops,
)
from smarig.report.models.plane_figures import map_panel
from smarig.report.runs.run_summary import summary_of
from smarig.report.runs.sample_path import sample_path
from smarig.report.transformation.tangent_figures import tangent_figure
from smarig.transformation import TransformationResult

_POINTS = 1200
_MOST_MARKS = 400


# --- figures --------------------------------------------------------------------------------------------


def plot(thing: Any, model: Model | None = None, *, ax: Any = None) -> Any:
    """Plot a run (with a model's prediction), a model's density μ, an identification, a verification, a diagnosis, or
    transformation temperatures.

    Returns a plotly figure that a notebook displays, and that is also shown where plotly is not (exported HTML, PDF).
    ``figure.write_html(path)`` saves it. With ``ax``, Matplotlib axes, the figure is drawn on them, and they are
    returned. Raises UsageError for any other object.
    """
    drawn = _run_drawn(thing, model) if isinstance(thing, Run) else _drawn(thing)
    if ax is not None:
        if not (hasattr(ax, "plot") and hasattr(ax, "yaxis")):
            raise UsageError(
                f"ax must be the axes of one plot in Matplotlib, got {type(ax).__name__}. Pass one of them."
            )
        draw_on(ax, drawn.panel, drawn.label)
        return ax
    from smarig.report.notebook_figure import notebook_figure

    return notebook_figure(drawn.panel, drawn.title, drawn.label)


@dataclass(frozen=True)
class _Drawn:
    """A panel with its title, and the label of simulated data."""

    panel: Panel
    title: str
    label: str


@singledispatch
def _drawn(thing: Any) -> _Drawn:
    raise UsageError(
        f"An object of type {type(thing).__name__} cannot be plotted. Pass a run, a model, a diagnosis, or what "
        "identify or verify returned."
    )


def _run_drawn(thing: Run, model: Model | None) -> _Drawn:
    inputs, outputs = thing.points()
    name = f"measured ({'twin' if thing.twin else thing.info.text_of('source', 'measured')})"
    kept = sample_path(thing["input"], thing["position"], count_size(thing))
    has_path = kept.size > len(thing.settled)
    if has_path:
        u, y = thing["input"], thing["position"]
        kept = kept[path(u[kept], y[kept], _POINTS)]
    else:
        (u, y), kept = (inputs, outputs), path(inputs, outputs, _POINTS)
    data = [line(u[kept], y[kept], name, MEASURED if model else INK, width=2.0 if model else 1.2)]
    if model is not None:
        data += _model_traces(thing, model, kept if has_path else None)
    if 0 < len(thing.settled) <= _MOST_MARKS:
        data.append(dots(inputs, outputs, "settled points", INK, size=4))
    layout = {"xaxis": axis(input_title(thing)), "yaxis": axis(output_title(thing)), "showlegend": True}
    title = f"{capitalised(protocol_name(thing))} on {thing.info.rig or 'no named rig'}, n = {inputs.size}"
    return _Drawn(Panel(data, layout), title, source_label(thing))


def _model_traces(run: Run, model: Model, kept: NDArray[np.intp] | None) -> list[Trace]:
    """The model along the path of the samples; at the points alone if the run has no path."""
    found = verify(model, [run]).runs[0]
    if kept is None:
        return [dots(found.input, found.predicted, "model", MODEL, symbol="x", size=7)]
    along = with_heating_of(model, run)
    y = simulate_samples(model, along)[kept] + found.offset
    return [line(along["input"][kept], y, "model", MODEL, width=1.4)]


@_drawn.register
def _model_drawn(thing: Model) -> _Drawn:
    hysteresis = thing.hysteresis
    units = (thing.unit, thing.input.unit)
    panel = map_panel("", density_of(hysteresis), density_report(hysteresis), units)
    words = f"Density μ of {thing.name}: {hysteresis_description(hysteresis)}"
    return _Drawn(panel, words, "TWIN" if thing.twin else "")


@_drawn.register
def _identification_drawn(thing: Identification) -> _Drawn:
    if not len(thing.data):
        return _model_drawn(thing.model)
    lines = [line(curve.u, curve.y, "model", MODEL, width=1.2) for curve in model_curves(thing)]
    points = [dots(curve.u, curve.y, "measured", INK, size=4) for curve in measured_curves(thing)]
    data = [trace | {"showlegend": k == 0} for traces in (lines, points) for k, trace in enumerate(traces)]
    described = thing.model
    layout = {
        "xaxis": axis(with_unit(capitalised(described.input.quantity or "value"), described.input.unit)),
        "yaxis": axis(with_unit(capitalised(described.output.quantity or "value"), described.unit)),
        "showlegend": True,
    }
    words = f"First-order curves and the {thing.surface} model, {thing.fit_verdict.text}"
    return _Drawn(Panel(data, layout), words, "TWIN" if described.twin else "")


@_drawn.register
def _verification_drawn(thing: Verification) -> _Drawn:
    data: list[Trace] = []
    known = np.concatenate([run.input for run in thing.runs])
    if thing.noise_floor and known.size:
        data += error_ground(known, thing.noise_floor)[:1]
    for k, run in enumerate(thing.runs):
        style = {"symbol": SYMBOLS[k % len(SYMBOLS)], "size": 6}
        data.append(dots(run.input, run.error, Path(run.run).name, COMPARED[k % len(COMPARED)], **style))
    layout = {
        "xaxis": axis("Input"),
        "yaxis": axis(with_unit("Measured − model", thing.unit)),
        "showlegend": True,
    }
    return _Drawn(Panel(data, layout), f"Errors of {thing.model}", "")


@_drawn.register
def _diagnosis_drawn(thing: CommandedDiagnosis) -> _Drawn:
    predictions = DiagnosisPredictions.of(thing)
    before, *after = residual_figure(predictions).panels[: len(predictions.labelled)]
    data = [
        *before.data,
        *(trace for panel in after for trace in panel.data if trace["name"] == predictions.labelled[1][1]),
    ]
    words = f"Residuals of the model: {thing.verdict.word.replace('_', ' ')}"
    return _Drawn(Panel(data, before.layout), words, source_label(*thing.timeline.runs))


@_drawn.register
def _transformation_drawn(thing: TransformationResult) -> _Drawn:
    figure = tangent_figure(thing.runs[0])
    return _Drawn(figure.panels[0], figure.title, figure.label)


# --- drawings -------------------------------------------------------------------------------------------


@singledispatch
def display_html(thing: Any) -> str:
    """HTML of a few kilobytes that describes a run, a model or a diagnosis."""
    return tag("pre", repr(thing))


@display_html.register
def _run_html(thing: Run) -> str:
    summary = summary_of(thing)
    rows = [f"{summary.size}; {summary.settled} of {summary.steps} steps settled", f"Ended: {summary.cause}"]
    rows += [f"{summary.flagged} steps and samples are marked"] if summary.flagged else []
    title = f"{capitalised(summary.protocol)} on {summary.rig or 'no named rig'}"
    return _drawing_with_text(summary.drawing() if summary.u.size else Html(""), title, summary.label, rows)


@display_html.register
def _model_html(thing: Model) -> str:
    u, y = model_loops(thing)
    words = f"Major loop and first-order curves of {thing.name}."
    label = "TWIN" if thing.twin else ""
    drawn = thumbnail(u, y, words, (thing.input.unit, thing.unit), label)
    report, rms = density_report(thing.hysteresis), thing.fit.get("rms")
    rows = [
        f"{capitalised(hysteresis_description(thing.hysteresis))}, from {runs_text(len(thing.provenance))} of rig "
        f"{thing.rig}"
    ]
    rows += (
        [f"Fit: {rms:.3g}{spaced(thing.unit)} rms over {thing.fit.get('points')} points"]
        if rms is not None
        else []
    )
    rows.append("μ ≥ 0 everywhere" if report.M_P else "μ < 0 somewhere")
    rows += [f"Effects: {', '.join(str(e.get('name')) for e in thing.effects)}"] if thing.effects else []
    return _drawing_with_text(drawn, f"Model {thing.name}", label, rows)


@display_html.register
def _identification_html(thing: Identification) -> str:
    return joined(
        [
            _model_html(thing.model),
            tag("p", tag("b", f"Fit: {thing.fit_verdict.text}.")),
            bullets(thing.warnings),
        ]
    )


@display_html.register
def _verification_html(thing: Verification) -> str:
    unit = display_unit(thing.unit)
    rows = [
        (
            Path(run.run).name,
            str(run.settled.n),
            number(run.settled.rms),
            number(run.settled.max_abs),
            number(run.noise_floor),
            run.verdict.text,
        )
        for run in thing.runs
    ]
    header = ("Run", "n", f"rms ({unit})", f"largest ({unit})", f"noise floor ({unit})", "Verdict")
    warnings = [f"{Path(run.run).name}: {words}" for run in thing.runs for words in run.warnings]
    return joined([table(header, rows, f"Verification of {thing.model}"), bullets(warnings)])


@display_html.register
def _transformation_html(thing: TransformationResult) -> str:
    return tag("pre", str(thing))


@display_html.register
def _diagnosis_html(thing: CommandedDiagnosis) -> str:
    label = source_label(*thing.timeline.runs)
    return _drawing_with_text(
        Html(""), f"Diagnosis: {thing.verdict.word.replace('_', ' ')}", label, findings(thing)
    )


_BADGE = "background:#f7c948;color:#111;font-weight:700;font-size:12px;padding:0 6px;border-radius:2px"


def _drawing_with_text(drawing: Html, title: str, label: str, rows: list[str]) -> str:
    """A drawing with its text; styles are inline because a notebook does not load the style sheet of pages."""
    picture = tag("div", drawing, style="flex:0 0 240px") if drawing else ""
    badge = tag("span", f"{label} · simulated, not hardware", style=_BADGE) if label else ""
    words = tag("div", tag("b", title), " ", badge, bullets(rows))
    return tag("div", picture, words, style="display:flex;gap:16px;align-items:center;flex-wrap:wrap")

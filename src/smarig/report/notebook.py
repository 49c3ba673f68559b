"""Runs, models and diagnoses in a notebook: a drawing of a few kilobytes, and a plotly figure on request.

The notebook supplies Plotly's script; a figure contains only its data, thinned.
"""

from functools import singledispatch
from typing import Any

import plotly.graph_objects as go

from smarig.core import UsageError, capitalised, spaced
from smarig.diagnosis import Diagnosis
from smarig.identification import density_report, verify
from smarig.record import Run
from smarig.replay import Model
from smarig.report.components.decimate import path
from smarig.report.components.figure import WATERMARK, Panel, Trace, axis, dots, line, unpacked
from smarig.report.components.html import Html, bullets, tag
from smarig.report.components.run_description import (
    input_title,
    output_title,
    protocol_name,
    source_label,
)
from smarig.report.components.style import INK, MODEL, template
from smarig.report.components.thumbnail import thumbnail
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions
from smarig.report.diagnosis.residual_figures import residual_figure
from smarig.report.diagnosis.verdict_text import findings
from smarig.report.models.density_figures import map_panel
from smarig.report.models.identification_plot_data import density_of, hysteresis_description
from smarig.report.models.model_loops import model_loops
from smarig.report.runs.run_summary import summary_of
from smarig.report.transformation.tangent_figure import tangent_figure
from smarig.transformation import TransformationResult

_POINTS = 1200


# --- figures --------------------------------------------------------------------------------------------


@singledispatch
def plot(thing: Any, model: Model | None = None) -> go.Figure:
    """Plot a run's hysteresis (with a model's prediction), a model's density μ, a diagnosis's residuals, or tangents.

    Returns a plotly figure. A notebook displays it; ``figure.write_html(path)`` saves it. Raises UsageError for any
    other object.
    """
    del model
    raise UsageError(
        f"An object of type {type(thing).__name__} cannot be plotted. Pass a run, a model or a diagnosis."
    )


@plot.register
def _run_figure(thing: Run, model: Model | None = None) -> go.Figure:
    inputs, outputs = thing.points()
    kept = path(inputs, outputs, _POINTS)
    label = source_label(thing)
    name = f"measured ({'twin' if thing.twin else thing.info.text_of('source', 'measured')})"
    marks = {"mode": "lines+markers", "marker": {"size": 6}} if thing.settled else {}
    data = [line(inputs[kept], outputs[kept], name, INK, width=1.2, **marks)]
    if model is not None:
        predicted = verify(model, [thing]).runs[0].predicted
        data.append(dots(inputs[kept], predicted[kept], "model", MODEL, symbol="x", size=7))
    layout = {"xaxis": axis(input_title(thing)), "yaxis": axis(output_title(thing)), "showlegend": True}
    title = f"{capitalised(protocol_name(thing))} on {thing.info.rig or 'no named rig'}, n = {inputs.size}"
    return _figure(Panel(data, layout), title, label)


@plot.register
def _model_figure(thing: Model, model: Model | None = None) -> go.Figure:
    del model
    hysteresis = thing.hysteresis
    units = (thing.unit, thing.input.unit)
    panel = map_panel("", density_of(hysteresis), density_report(hysteresis), units)
    words = f"Density μ of {thing.name}: {hysteresis_description(hysteresis)}"
    return _figure(panel, words, "TWIN" if thing.twin else "")


@plot.register
def _diagnosis_figure(thing: Diagnosis, model: Model | None = None) -> go.Figure:
    del model
    predictions = DiagnosisPredictions.of(thing)
    before, *after = residual_figure(predictions).panels[: len(predictions.labelled)]
    data = [
        *before.data,
        *(trace for panel in after for trace in panel.data if trace["name"] == predictions.labelled[1][1]),
    ]
    words = f"Residuals of the model: {thing.verdict.word.replace('_', ' ')}"
    return _figure(Panel(data, before.layout), words, source_label(*thing.timeline.runs))


@plot.register
def _transformation_figure(thing: TransformationResult, model: Model | None = None) -> go.Figure:
    del model
    figure = tangent_figure(thing.runs[0])
    return _figure(figure.panels[0], figure.title, figure.label)


def _figure(panel: Panel, title: str, label: str) -> go.Figure:
    layout = {key: value for key, value in panel.layout.items() if key != "narrow"}
    layout |= {"template": template(), "title": {"text": title}, "height": panel.height, "margin": {"t": 90}}
    if label:
        layout["annotations"] = [*layout.get("annotations", ()), WATERMARK | {"text": label}]
    return go.Figure([_with_arrays(trace) for trace in panel.data], layout)


def _with_arrays(trace: Trace) -> Trace:
    """A trace with its packed values converted back to arrays, for further work with the figure."""
    return {
        key: unpacked(value) if isinstance(value, dict) and "bdata" in value else value
        for key, value in trace.items()
    }


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
        f"{capitalised(hysteresis_description(thing.hysteresis))}, from {len(thing.provenance)} run(s) of rig "
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
def _transformation_html(thing: TransformationResult) -> str:
    return tag("pre", str(thing))


@display_html.register
def _diagnosis_html(thing: Diagnosis) -> str:
    label = source_label(*thing.timeline.runs)
    return _drawing_with_text(
        Html(""), f"Diagnosis: {thing.verdict.word.replace('_', ' ')}", label, findings(thing)
    )


def _badge_html(label: str) -> Html:
    return tag("span", f"{label} · simulated, not hardware", style=_BADGE)


_BADGE = "background:#f7c948;color:#111;font-weight:700;font-size:12px;padding:0 6px;border-radius:2px"


def _drawing_with_text(drawing: Html, title: str, label: str, rows: list[str]) -> str:
    """A drawing with its text; styles are inline because a notebook does not load the style sheet of pages."""
    picture = tag("div", drawing, style="flex:0 0 240px") if drawing else ""
    words = tag("div", tag("b", title), " ", _badge_html(label) if label else "", bullets(rows))
    return tag("div", picture, words, style="display:flex;gap:16px;align-items:center;flex-wrap:wrap")

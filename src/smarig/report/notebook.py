"""Runs, models and diagnoses in a notebook: a drawing that weighs kilobytes, and one plotly figure when asked.

Plotly's script is the notebook's own; a figure brings only its data, thinned. Computes nothing new.
"""

from functools import singledispatch
from typing import Any

import numpy as np
import plotly.graph_objects as go

from smarig.diagnosis.diagnose import Diagnosis
from smarig.errors import UsageError
from smarig.identification.density import density_report
from smarig.identification.model_file import Model
from smarig.identification.verify import verify
from smarig.record import Run
from smarig.report.conditions import input_title, label_of, output_title, protocol_of, sentence
from smarig.report.decimate import path
from smarig.report.diagnosed import Replay
from smarig.report.diagnosis_words import findings
from smarig.report.figure import MARK, Panel, Trace, axis, dots, line, unpacked
from smarig.report.figures_density import map_panel
from smarig.report.figures_residuals import residual_figure
from smarig.report.html import Html, bullets, tag
from smarig.report.identified import density_of, kind_of
from smarig.report.style import INK, MODEL, template
from smarig.report.summary import summary_of
from smarig.report.thumbnail import thumbnail

_POINTS = 1200
_REVERSALS = (0.35, 0.55, 0.75)  # first-order curves in a model's drawing, as shares of its range


# --- figures --------------------------------------------------------------------------------------------


@singledispatch
def plot(thing: Any, model: Model | None = None) -> go.Figure:
    """A run's hysteresis graph (with a model's answer, if given), a model's density μ, a diagnosis's residuals.

    Returns a plotly figure; in a notebook it shows itself, ``figure.write_html(path)`` keeps it. UsageError for
    anything else.
    """
    del model
    raise UsageError(f"A {type(thing).__name__} cannot be plotted; give a run, a model or a diagnosis.")


@plot.register
def _of_run(thing: Run, model: Model | None = None) -> go.Figure:
    inputs, outputs = thing.points()
    kept = path(inputs, outputs, _POINTS)
    label = label_of(thing)
    name = f"measured ({'twin' if thing.twin else thing.meta.get('source', 'measured')})"
    marks = {"mode": "lines+markers", "marker": {"size": 6}} if thing.settled else {}
    data = [line(inputs[kept], outputs[kept], name, INK, width=1.2, **marks)]
    if model is not None:
        predicted = verify(model, [thing]).runs[0].predicted
        data.append(dots(inputs[kept], predicted[kept], "model", MODEL, symbol="x", size=7))
    layout = {"xaxis": axis(input_title(thing)), "yaxis": axis(output_title(thing)), "showlegend": True}
    title = f"{sentence(protocol_of(thing))} on {thing.meta.get('rig') or 'no named rig'}, n = {inputs.size}"
    return _figure(Panel(data, layout), title, label)


@plot.register
def _of_model(thing: Model, model: Model | None = None) -> go.Figure:
    del model
    hysteresis = thing.hysteresis
    units = (thing.unit, thing.input.unit)
    panel = map_panel("", density_of(hysteresis), density_report(hysteresis), units)
    words = f"Density μ of {thing.name}: {kind_of(hysteresis)}"
    return _figure(panel, words, "TWIN" if thing.twin else "")


@plot.register
def _of_diagnosis(thing: Diagnosis, model: Model | None = None) -> go.Figure:
    del model
    replay = Replay.of(thing)
    before, *after = residual_figure(replay).panels[: len(replay.told)]
    data = [
        *before.data,
        *(trace for panel in after for trace in panel.data if trace["name"] == replay.told[1][1]),
    ]
    words = f"What the model misses: {thing.verdict.word.replace('_', ' ')}"
    return _figure(Panel(data, before.layout), words, label_of(*thing.story.runs))


def _figure(panel: Panel, title: str, label: str) -> go.Figure:
    layout = {key: value for key, value in panel.layout.items() if key != "narrow"}
    layout |= {"template": template(), "title": {"text": title}, "height": panel.height, "margin": {"t": 90}}
    if label:
        layout["annotations"] = [*layout.get("annotations", ()), MARK | {"text": label}]
    return go.Figure([_with_arrays(trace) for trace in panel.data], layout)


def _with_arrays(trace: Trace) -> Trace:
    """A trace whose packed values are arrays again, for those who work on with the figure."""
    return {
        key: unpacked(value) if isinstance(value, dict) and "bdata" in value else value
        for key, value in trace.items()
    }


# --- drawings -------------------------------------------------------------------------------------------


@singledispatch
def shown(thing: Any) -> str:
    """A few kilobytes of HTML about a run, a model or a diagnosis."""
    return tag("pre", repr(thing))


@shown.register
def _run_shown(thing: Run) -> str:
    told = summary_of(thing)
    rows = [f"{told.size}; {told.settled} of {told.steps} steps settled", f"Ended: {told.cause}"]
    rows += [f"{told.marked} steps and samples are marked"] if told.marked else []
    title = f"{sentence(told.protocol)} on {told.rig or 'no named rig'}"
    return _beside(told.drawing() if told.u.size else Html(""), title, told.label, rows)


@shown.register
def _model_shown(thing: Model) -> str:
    u, y = _loops(thing)
    words = f"Major loop and first-order curves of {thing.name}."
    label = "TWIN" if thing.twin else ""
    drawn = thumbnail(u, y, words, (thing.input.unit, thing.unit), label)
    report, rms = density_report(thing.hysteresis), thing.fit.get("rms")
    rows = [f"{sentence(kind_of(thing.hysteresis))}, from {len(thing.provenance)} run(s) of rig {thing.rig}"]
    rows += (
        [f"Fit: {rms:.3g} {thing.unit} rms over {thing.fit.get('points')} points"] if rms is not None else []
    )
    rows.append("μ ≥ 0 everywhere" if report.M_P else "μ < 0 somewhere")
    rows += [f"Effects: {', '.join(str(e.get('name')) for e in thing.effects)}"] if thing.effects else []
    return _beside(drawn, f"Model {thing.name}", label, rows)


def _loops(model: Model, n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Input and output of the major loop and some first-order curves, in one go."""
    low, high = model.hysteresis.lower, model.hysteresis.upper
    turns = [low, *(end for share in _REVERSALS for end in (low + share * (high - low), low)), high, low]
    u = np.concatenate([np.linspace(a, b, n) for a, b in zip(turns, turns[1:])])
    return u, model.predict(u)


@shown.register
def _diagnosis_shown(thing: Diagnosis) -> str:
    label = label_of(*thing.story.runs)
    return _beside(Html(""), f"Diagnosis: {thing.verdict.word.replace('_', ' ')}", label, findings(thing))


def _badge(label: str) -> Html:
    return tag("span", f"{label} · simulated, not hardware", style=_BADGE)


_BADGE = "background:#f7c948;color:#111;font-weight:700;font-size:12px;padding:0 6px;border-radius:2px"


def _beside(drawing: Html, title: str, label: str, rows: list[str]) -> str:
    """A drawing with its words beside it; styles stand in the elements, for a notebook has none of ours."""
    picture = tag("div", drawing, style="flex:0 0 240px") if drawing else ""
    words = tag("div", tag("b", title), " ", _badge(label) if label else "", bullets(rows))
    return tag("div", picture, words, style="display:flex;gap:16px;align-items:center;flex-wrap:wrap")

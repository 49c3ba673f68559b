"""Axes of residual figures: the variables on the abscissa with their units, and the range of the ordinate."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis import WIRE_NOISE, CommandedDiagnosis, DriveStatistics
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Timeline
from smarig.report.components.figure import (
    AXIS_MARGIN,
    Figure,
    Panel,
    axis,
    dots,
    error_ground,
    noise_band,
)
from smarig.report.components.numbers import number
from smarig.report.components.run_description import count_size, display_unit, source_label
from smarig.report.components.style import GREY
from smarig.report.diagnosis.diagnosis_predictions import (
    DiagnosisPredictions,
    diagnosis_caption,
    models_text,
    readings,
    rms_noise,
)

_FINER_RATIO = 4  # ratio from which the smaller residuals would be a flat line on the axis of the larger ones


def likeliest_variable(d: CommandedDiagnosis) -> str:
    """The variable of the verdict, else the likeliest of all ("time" if none is)."""
    variables = [p.name for p in d.causes if p.kind == "variable"]
    return d.verdict.depends_on or next(iter(variables), "time")


def residual_abscissa(d: CommandedDiagnosis, name: str, kind: str) -> tuple[Array, dict[str, Any]]:
    """A variable's values (n,) at the readings of one kind, and its axis."""
    timeline, r, u = d.timeline, readings(d.timeline, kind), display_unit(d.timeline.runs[0].input_unit)
    unit, target, base = display_unit(timeline.unit), timeline.target_K, d.subject.base.prediction
    before = np.concatenate([target[:1], target[:-1]])
    if name == "cycle":
        travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
        return travel[r.step], axis(f"Accumulated motion, both directions ({unit})")
    if name == "level" and kind in ("settled", "moving"):
        return base.values[kind], axis(f"Predicted position ({unit})")
    if name == "level":
        return target[r.step], axis(f"Target of the step ({u})")
    if name == "step":
        return (target - before)[r.step], axis(f"Change of target in this step ({u})")
    if name == "hold":
        return np.maximum(timeline.hold_s, 1.0)[r.step], axis("Length of the hold (s)", type="log")
    if name == "rate":
        values, label = DriveStatistics(timeline).rate_axis(r)
        return values, axis(label)
    if name == "history":
        values, label = DriveStatistics(timeline).history_axis(r, u)
        return values, axis(label)
    if name == "reversals":
        turned = np.abs(np.diff(np.sign(np.diff(target)), prepend=1)) > 0
        return np.concatenate([[0.0], np.cumsum(turned)])[r.step], axis("Reversals so far")
    t, t_unit = _display_time(timeline, r.t_s)
    return t, axis(f"Clock time of the session ({t_unit})")


def _display_time(timeline: Timeline, t_s: Array) -> tuple[Array, str]:
    """Times in hours or minutes with the unit, or sample numbers without a clock."""
    if not timeline.drive.has_clock:
        return t_s, "samples"
    return (t_s / 3600, "h") if timeline.drive.end_s[-1] > 7200 else (t_s / 60, "min")


def run_start_lines(timeline: Timeline) -> list[dict[str, Any]]:
    """A dotted vertical line at the start of each run."""
    at = _display_time(
        timeline,
        np.array([timeline.settled.t_s[np.argmax(timeline.run == k)] for k in range(1, len(timeline.runs))]),
    )[0]
    style = {"type": "line", "yref": "paper", "y0": 0, "y1": 1, "layer": "below"}
    return [
        style | {"x0": t, "x1": t, "line": {"color": GREY, "width": 1, "dash": "dot"}} for t in at.tolist()
    ]


def residual_layout(
    d: CommandedDiagnosis, name: str, x_axis: dict[str, Any], y_layout: dict[str, Any]
) -> dict[str, Any]:
    """A panel's layout; against time with a line at the start of each run."""
    marks = {"shapes": run_start_lines(d.timeline)} if name == "time" else {}
    return {"xaxis": x_axis} | y_layout | marks


def half_ranges(errors: Sequence[Array], least: float) -> list[float]:
    """The half-range of each panel's axis: that of the first panel, or its own if that is several times smaller.

    Errors larger than those of the first panel are drawn on the axis of the first panel.
    """
    each = [AXIS_MARGIN * max(least, float(np.abs(error).max())) for error in errors]
    whole = max(each)
    return [whole, *(own if whole > _FINER_RATIO * own else whole for own in each[1:])]


def symmetric_layout(title: str, half_range: float, all_half_ranges: Sequence[float]) -> dict[str, Any]:
    """A layout with a symmetric vertical axis, with an annotation if it is finer than that of the other panel."""
    layout: dict[str, Any] = {"yaxis": axis(title, range=[-half_range, half_range])}
    if max(all_half_ranges) > half_range:
        words = f"axis {number(max(all_half_ranges) / half_range, 2)} × finer"
        at = {"xref": "paper", "yref": "paper", "x": 0.01, "y": 0.98, "xanchor": "left", "yanchor": "top"}
        look = {"showarrow": False, "bgcolor": "#ffffff", "font": {"size": 12, "color": GREY}}
        layout["annotations"] = [{"text": words} | at | look]
    return layout


_WIRE_NOISE_RATIO = (
    1.02  # noise with that of the wire's temperature over that without, from which a second band is drawn
)
_READING_NAMES = {
    "settled": "settled positions",
    "moving": "positions while the wire moves",
    "resistance": "the wire's resistance",
    "current": "measured current − command",
    "room": "ambient temperature in the box",
}


def residual_figure(predictions: DiagnosisPredictions) -> Figure:
    """Residuals in the rig's unit against the variable that explains most and against time, before and after."""
    d = predictions.d
    name = likeliest_variable(d)
    kind = (
        "moving"
        if name == "rate" and any(r.kind == "moving" for r in d.timeline.other_readings)
        else "settled"
    )
    return _residual_channel_figure(
        predictions,
        kind,
        list(dict.fromkeys((name, "time"))),
        f"Residuals: {_READING_NAMES[kind]}.",
    )


def _residual_channel_figure(
    predictions: DiagnosisPredictions, kind: str, names: Sequence[str], title: str
) -> Figure:
    d = predictions.d
    own, whole = rms_noise(d, kind)
    r = readings(d.timeline, kind)
    unit = display_unit(r.unit)
    errors = [predictions.residuals(prediction, kind) for prediction, _, _ in predictions.labelled]
    half_range = half_ranges(errors, 2 * whole)
    panels = [
        _residual_panel(
            d=d,
            kind=kind,
            name=name,
            error=error,
            style=(label, colour),
            noise=(own, whole),
            y_layout=symmetric_layout(f"Measured − model ({unit})", own_half_range, half_range),
        )
        for name in names
        for error, own_half_range, (_, label, colour) in zip(errors, half_range, predictions.labelled)
    ]
    zero = "" if kind == "current" else " (the mean is removed, because the zero is free)"
    bands_text = (
        f" Grey band: ± 2 σ of a reading (σ = {own:.2g} {unit}, rms); "
        f"light band: ± 2 σ including the {WIRE_NOISE} (σ = {whole:.2g} {unit}, rms)."
        if whole > _WIRE_NOISE_RATIO * own
        else f" Grey band: ± 2 σ of a reading (σ = {own:.2g} {unit}, rms)."
    )
    sizes = " → ".join(number(root_mean_square(e)) for e in errors)
    return Figure(
        panels,
        title,
        [
            f"Measured − predicted{zero}, n = {len(r)}, rms {sizes} "
            f"{unit}{models_text(predictions, half_range)}.{bands_text}",
            "Each density was refitted to these readings, so residuals that a density can absorb are not "
            "shown."
            if kind in OUTPUT_DEPENDENT_KINDS
            else "",
            _count_text(d) if kind in ("settled", "moving") else "",
            *diagnosis_caption(d, dotted="time" in names),
        ],
        source_label(*d.timeline.runs),
        440,
    )


def _count_text(d: CommandedDiagnosis) -> str:
    size = count_size(d.timeline.runs[0])
    return f"1 count: {size:.3g} {display_unit(d.timeline.unit)}." if size else ""


def _residual_panel(
    d: CommandedDiagnosis,
    kind: str,
    name: str,
    error: Array,
    style: tuple[str, str],
    noise: tuple[float, float],
    y_layout: dict[str, Any],
) -> Panel:
    x, x_axis = residual_abscissa(d, name, kind)
    low, high = float(x.min()), float(x.max())
    data = [*error_ground(x, noise[0], "± 2 σ of a reading"), dots(x, error, style[0], style[1], size=5)]
    if noise[1] > _WIRE_NOISE_RATIO * noise[0]:
        wider = noise_band(low, high, 2 * noise[1], f"± 2 σ with {WIRE_NOISE}", "rgba(107,114,128,.10)")
        data.insert(0, wider)
    return Panel(data, residual_layout(d, name, x_axis, y_layout), 360)

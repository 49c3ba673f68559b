"""Figures of residuals against time and against the variable that explains most, before and after the effects."""

from collections.abc import Sequence
from typing import Any

from smarig.core import root_mean_square
from smarig.diagnosis import WIRE_NOISE, CommandedDiagnosis
from smarig.replay import OUTPUT_DEPENDENT_KINDS
from smarig.report.components.figure import Figure, Panel, Trace, dots, line
from smarig.report.components.numbers import number
from smarig.report.components.run_description import count_size, display_unit, source_label
from smarig.report.components.style import GREY
from smarig.report.diagnosis.diagnosis_predictions import (
    Array,
    DiagnosisPredictions,
    diagnosis_caption,
    models_text,
    readings,
    rms_noise,
)
from smarig.report.diagnosis.residual_axes import (
    half_ranges,
    likeliest_variable,
    residual_abscissa,
    residual_layout,
    symmetric_layout,
)
from smarig.report.runs.representation_figure import noise_band

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
    bands = [noise_band(low, high, 2 * noise[0], "± 2 σ of a reading")]
    if noise[1] > _WIRE_NOISE_RATIO * noise[0]:
        bands.insert(
            0,
            noise_band(low, high, 2 * noise[1], f"± 2 σ with {WIRE_NOISE}")
            | {"fillcolor": "rgba(107,114,128,.10)"},
        )
    data: list[Trace] = [
        *bands,
        line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x, error, style[0], style[1], size=5),
    ]
    return Panel(data, residual_layout(d, name, x_axis, y_layout), 360)

"""Residuals as the equivalent offset of the input (K), at points where the slope is large enough."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis import Diagnosis
from smarig.report.components.figure import Figure, Panel, Trace, dots, line, packed
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.components.style import GREY
from smarig.report.diagnosis.diagnosis_predictions import (
    Array,
    DiagnosisPredictions,
    diagnosis_caption,
    input_slopes,
    models_text,
    rms,
    rms_noise,
)
from smarig.report.diagnosis.residual_axes import (
    best_position_variable,
    half_ranges,
    residual_abscissa,
    residual_layout,
    symmetric_layout,
)

_STEEP_SHARE = 0.25  # of the 90 % quantile of the slope: below it the equivalent offset is too uncertain


def input_offset_figure(predictions: DiagnosisPredictions) -> Figure | None:
    """Residuals as the equivalent offset of the input, at points where the slope is large enough."""
    d = predictions.d
    slope = input_slopes(d)
    steep = slope > _STEEP_SHARE * float(np.quantile(slope, 0.9))
    if not steep.any() or slope.max() <= 0:
        return None
    u, unit = display_unit(d.timeline.runs[0].input_unit), display_unit(d.timeline.unit)
    offsets = [
        predictions.residuals(prediction, "settled")[steep] / slope[steep]
        for prediction, _, _ in predictions.labelled
    ]
    uncertainty = 2 * rms_noise(d, "settled")[0] / slope[steep]
    half_range = half_ranges([np.abs(offset) + uncertainty for offset in offsets], 0.0)
    names = dict.fromkeys((best_position_variable(d), "time"))
    panels = [
        _offset_panel(
            d,
            name,
            steep,
            (offset, uncertainty),
            (label, colour),
            symmetric_layout(f"Equivalent offset ({u})", own_half_range, half_range),
        )
        for name in names
        if name != "rate"
        for offset, own_half_range, (_, label, colour) in zip(offsets, half_range, predictions.labelled)
    ]
    sizes = " → ".join(number(rms(offset)) for offset in offsets)
    return Figure(
        panels,
        f"The same residuals as the equivalent offset of the input ({u}).",
        [
            "Residual of a settled position divided by the base model's slope ∂y/∂u, at points where the slope exceeds "
            f"{100 * _STEEP_SHARE:.0f} % of its 90 % quantile: {int(steep.sum())} of {steep.size} points, slopes "
            f"{slope[steep].min():.2g} to {slope[steep].max():.2g} {unit}/{u}; "
            f"rms {sizes} {u}{models_text(predictions, half_range)}.",
            f"Bars: ± 2 σ of a reading divided by the slope, without the noise of the temperature "
            f"({_fluctuation_text(d)} {u}). The points of a disturbance of the input lie on one curve, apart from the "
            "part that the density absorbs.",
            *diagnosis_caption(d, dotted=True),
        ],
        source_label(*d.timeline.runs),
        440,
    )


def _fluctuation_text(d: Diagnosis) -> str:
    critique = d.levels[-1].critique if d.levels else d.first
    return number(critique.refitted.noise.temperature_K, 2)


def _offset_panel(
    d: Diagnosis,
    name: str,
    steep: NDArray[np.bool_],
    offset: tuple[Array, Array],
    style: tuple[str, str],
    y_layout: dict[str, Any],
) -> Panel:
    x, x_axis = residual_abscissa(d, name, "settled")
    ends = [float(x.min()), float(x.max())]
    bars = {"type": "data", "array": packed(offset[1]), "color": GREY, "thickness": 1, "width": 0}
    data: list[Trace] = [
        line(ends, [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x[steep], offset[0], style[0], style[1], size=5, error_y=bars),
    ]
    return Panel(data, residual_layout(d, name, x_axis, y_layout), 340)

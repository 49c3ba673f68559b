"""Figures of a model against runs it has not seen: in time, and its residual with the noise floor."""

from pathlib import Path

import numpy as np

from smarig.identification.verify import RunVerification
from smarig.report.figure import Figure, Panel, axis, dots, line
from smarig.report.style import INK, MODEL, POSITION
from smarig.report.words import number


def against_data(name: str, judged: RunVerification, unit: str, input_unit: str, twin: bool) -> Figure:
    """Measured and modelled settled points in their order, and the residual beside them."""
    order = np.arange(1, judged.input.size + 1)
    residual = judged.predicted - judged.measured
    floor = judged.noise_floor or 0.0
    band = {"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "y0": -2 * floor, "y1": 2 * floor, "layer": "below"}
    grey = [band | {"fillcolor": "#e3e7ec", "line": {"width": 0}}] if floor else []
    reach = 1.25 * max(float(np.nanmax(np.abs(residual))), 2 * floor) or 1.0
    panels = [
        Panel(
            [
                dots(order, judged.measured, "measured", POSITION, size=8, symbol="circle-open"),
                line(order, judged.predicted, f"model ({name})", MODEL, width=1.3),
            ],
            {"xaxis": axis("settled point, in the order of measurement"), "yaxis": axis(f"output ({unit})")},
            360,
        ),
        Panel(
            [dots(judged.input, residual, "residual", INK, size=6, showlegend=False)],
            {
                "xaxis": axis(f"input ({input_unit})"),
                "yaxis": axis(f"model − measured ({unit})", range=[-reach, reach]),
                "shapes": grey,
            },
            360,
        ),
    ]
    s = judged.settled
    caption = [
        f"{Path(judged.run).name}, never used for the fit: {number(s.rms)} {unit} rms, {number(s.max_abs)} {unit} at most, n = {s.n}.",
        f"Grey: ± 2 × the noise floor of {number(floor)} {unit}." if floor else "No noise floor is known: nothing repeats.",
        f"Encoder zero: {judged.offset_kind}.",
    ]
    return Figure(panels, f"Model against validation data ({name}).", caption, twin, 460)


def resimulated(name: str, judged: RunVerification, unit: str, input_unit: str, twin: bool) -> Figure:
    """The identification input re-simulated with a surface over the data (Figs 5.21, 5.22)."""
    traces = [
        line(judged.input, judged.measured, "measured", POSITION, width=1, dash="dot"),
        dots(judged.input, judged.measured, "measured", POSITION, size=5, showlegend=False),
        line(judged.input, judged.predicted, name, MODEL, width=1.4),
    ]
    s = judged.settled
    layout = {"xaxis": axis(f"input ({input_unit})"), "yaxis": axis(f"output ({unit})")}
    caption = [f"{name.capitalize()}: {number(s.rms)} {unit} rms over n = {s.n} settled points."]
    return Figure([Panel(traces, layout, 380)], "Identification input re-simulated.", caption, twin)

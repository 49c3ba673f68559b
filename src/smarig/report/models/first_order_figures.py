"""Figures of first-order curves: measured, modelled, re-simulated, and their parameters (Figs. 5.12 to 5.22)."""

from collections.abc import Mapping

import numpy as np

from smarig.core import root_mean_square, spaced
from smarig.identification import POSITIVE_KIND, Identification, fit_curves
from smarig.preisach import surface_forms
from smarig.record import Run
from smarig.replay import recorded_start
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line, noise_band
from smarig.report.components.numbers import number
from smarig.report.components.run_description import (
    count_size,
    input_title,
    loop_axes,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import GREY, INK, SEQUENCE, colours, surface_colour
from smarig.report.models.identification_plot_data import (
    FirstOrderCurve,
    axis_symbols,
    interval,
    measured_curves,
    model_curves,
    residuals,
    resimulated,
)
from smarig.report.runs.representation_figure import count_lines, count_text

_MOST_CURVES = 30  # of more curves every n-th is drawn, and the caption states n
_BANDS = "bands: 90 % intervals of a new reading, wide where there are no data; "


def curves_figure(found: Identification, run: Run) -> Figure:
    """Measured first-order curves with those of the chosen model, and the differences."""
    measured, model = measured_curves(found), model_curves(found)
    every = -(-len(model) // _MOST_CURVES)
    shown = {curve.reversal: shade for curve, shade in zip(model, colours(len(model)))}
    shown = {reversal: shown[reversal] for reversal in list(shown)[::every]}
    data: list[Trace] = []
    drawn = [curve for curve in model if curve.reversal in shown]
    bands = [_interval_band(found, curve, shown[curve.reversal]) for curve in drawn]
    data += [each for each in bands if each is not None]
    for curve in drawn:
        data.append(
            line(curve.u, curve.y, "model", shown[curve.reversal], hoverinfo="skip", showlegend=False)
        )
    for curve in measured:
        if curve.reversal in shown:
            data.append(_point_trace(curve, shown[curve.reversal], run))
    unit, (turn, _) = run.input_unit, axis_symbols(found)
    layout = {
        "xaxis": axis(input_title(run)),
        "yaxis": axis(output_title(run)),
        "legend": {
            "orientation": "v",
            "x": 1.01,
            "y": 1,
            "yanchor": "top",
            "title": {"text": f"{turn} ({unit})"},
        },
        "showlegend": len(shown) <= 14,
        "narrow": {"r": 8},
    }
    size = count_size(run)
    rms = root_mean_square(
        residuals(found)[2]
    )  # of the curves: a positive measure is fitted to further points
    some = f" One curve in {every} is drawn." if every > 1 else ""
    return Figure(
        [Panel(data, layout, 500), _residual_panel(found, run)],
        f"First-order {'ascending' if found.data.mirrored else 'descending'} curves and the {found.surface} model.",
        [
            f"Points: measured{f', bars ± 1 count ({size:.3g}{spaced(run.unit)})' if size else ''}; lines: the model; "
            f"{_BANDS if any(bands) else ''}colour: the reversal input {turn}.{some} Second panel: measured − "
            f"model at all {len(found.data)} points of {found.data.curves} curves, "
            f"rms {rms:.3g}{spaced(found.model.unit)}{_noise_text(found)}."
            f"{count_text(size, _residual_half_range(found), run.unit)}",
            run_caption(run),
        ],
        source_label(run),
        460,
    )


def _interval_band(found: Identification, curve: FirstOrderCurve, colour: str) -> Trace | None:
    """The 90 % interval of new readings along a model curve, in the colour of the curve; None without intervals."""
    ends = interval(found, curve)
    if ends is None:
        return None
    low, high = ends
    edge, back = np.concatenate([low, high[::-1]]), np.concatenate([curve.u, curve.u[::-1]])
    fill = colour.replace("rgb(", "rgba(").replace(")", ",.2)")
    style = {"fill": "toself", "fillcolor": fill, "hoverinfo": "skip", "showlegend": False}
    return line(back, edge, "90 % interval", colour, width=0, **style)


def _point_trace(curve: FirstOrderCurve, colour: str, run: Run) -> Trace:
    size = count_size(run)
    bars = (
        {"error_y": {"type": "constant", "value": size, "color": colour, "thickness": 1, "width": 3}}
        if size
        else {}
    )
    return dots(curve.u, curve.y, number(curve.reversal, 4), colour, size=5.5, **bars)


def _noise_text(found: Identification) -> str:
    floor = found.model.noise_floor.value
    return (
        f" (noise floor of these runs {floor:.2g}{spaced(found.model.unit)}, grey band ± 2 σ)"
        if floor
        else ""
    )


def _residual_half_range(found: Identification) -> float:
    return 1.2 * max(float(np.abs(residuals(found)[2]).max()), 2 * (found.model.noise_floor.value or 0.0))


def _residual_panel(found: Identification, run: Run) -> Panel:
    alpha, u, error = residuals(found)
    marker = {"color": alpha.tolist(), "colorscale": SEQUENCE, "showscale": False}
    low, high = float(u.min()), float(u.max())
    floor = found.model.noise_floor.value
    data = [noise_band(low, high, 2 * floor, "± 2 σ of the noise floor")] if floor else []
    data += count_lines(low, high, count_size(run), _residual_half_range(found))
    data.append(dots(u, error, "measured − model", INK, size=6, marker=marker, showlegend=False))
    return Panel(
        data, {"xaxis": axis(input_title(run)), "yaxis": axis(f"Measured − model ({run.unit})")}, 500
    )


def _model_label(name: str) -> str:
    return f"f {name}" if name in surface_forms() else {POSITIVE_KIND: "μ ≥ 0"}.get(name, name)


def replay_figure(found: Mapping[str, Identification], run: Run) -> Figure:
    """The identification input simulated with each surface, with the data (Figs. 5.21, 5.22)."""
    inputs, outputs = run.points()
    panels = []
    for name, one in found.items():
        u, y = resimulated(one, inputs, initial=recorded_start(run) or "negative")
        data = [
            line(u, y, f"model, {_model_label(name)}", surface_colour(name), width=1.4),
            dots(inputs, outputs, "measured", INK, size=4),
        ]
        layout = loop_axes(run)
        panels.append(Panel(data, layout, 400))
    return Figure(
        panels,
        "The identification input, re-simulated with each surface.",
        [
            "Points: measured. Lines: the Preisach operator with the same sequence of inputs. "
            + "; ".join(f"{n}: rms {f.model.fit['rms']:.3g}{spaced(f.model.unit)}" for n, f in found.items())
            + ".",
            run_caption(run),
        ],
        source_label(run),
        440,
    )


def parameters_figure(found: Identification, run: Run) -> Figure | None:
    """b₁, b₂, b₃ of the sigmoid of each curve against α (Fig. 5.16); None if no curve determines them."""
    fits = fit_curves(found.data)
    alpha, b, error = fits.against_alpha()
    if not alpha.size:
        return None
    u, y = run.input_unit, run.unit
    names = (f"b₁ ({y})", f"b₂ (1/{u})", f"b₃ ({u})")
    panels = []
    for k, name in enumerate(names):
        bars = {"type": "data", "array": error[:, k].tolist(), "color": GREY, "thickness": 1.2, "width": 4}
        trace = dots(
            alpha,
            b[:, k],
            name,
            INK,
            mode="lines+markers",
            size=7,
            error_y=bars,
            line={"color": GREY, "width": 1},
        )
        panels.append(
            Panel([trace], {"xaxis": axis(f"α ({u})"), "yaxis": axis(name), "showlegend": False}, 320)
        )
    short = fits.too_short
    left_out = (
        f" Curves with too few points are omitted: α = {', '.join(number(a, 4) for a in short)}."
        if short
        else ""
    )
    *others, last = surface_forms()
    mirror = " Ascending curves: parameters of the mirrored data (−u, −y)." if found.data.mirrored else ""
    return Figure(
        panels,
        "Sigmoid parameters of each curve against α.",
        [
            f"ȳ(β) = b₁/(1 + e^(−b₂(β + b₃))) + b₄ fitted to each of {alpha.size} curves (§5.4.2); bars are standard "
            f"errors. The dependence of b₃ on α decides between the {', '.join(others)} and {last} surface."
            f"{left_out}{mirror}",
            run_caption(run),
        ],
        source_label(run),
        320,
    )

"""Line figures of first-order curves: the curves, profiles through the peak, smoothing, central ridge, and drift."""

import numpy as np

from smarig.core import Array, spaced
from smarig.exchange import DriftDecision
from smarig.identification import SIGNIFICANT, CentralRidge
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line, log_axis
from smarig.report.components.html import Html
from smarig.report.components.numbers import number
from smarig.report.components.run_description import (
    display_unit,
    input_title,
    output_title,
    source_label,
    with_unit,
)
from smarig.report.components.style import COMPARED, GREY, INK, MODEL, colours
from smarig.report.forc.forc_evidence import ForcEvidence
from smarig.report.models.plane_figures import per_square, readable_scale

_MOST_CURVES = 60
_BAND = "rgba(0,114,178,.18)"
_ORDINAL_DEGREES = {2: "quadratic", 4: "quartic"}


def curves_panel(e: ForcEvidence) -> Panel:
    """The measured curves, dark to bright in the order of their reversal inputs; at most sixty of them."""
    data, sign, factor = e.data, -1.0 if e.data.mirrored else 1.0, e.scale.factor
    numbers = np.unique(data.curve)
    kept = numbers[:: -(-numbers.size // _MOST_CURVES)]
    drawn: list[Trace] = []
    for number_, colour in zip(kept, colours(len(kept))):
        mine = data.curve == number_
        drawn.append(
            line(
                sign * data.beta[mine] * factor,
                sign * data.y[mine],
                f"curve {number_}",
                colour,
                width=0.8,
                showlegend=False,
                hoverinfo="skip",
            )
        )
    field = e.scale.labelled("μ₀H" if e.run.input_unit == "T" else "Field H")
    layout = {"xaxis": axis(field if e.magnetic else input_title(e.run)), "yaxis": axis(output_title(e.run))}
    return Panel(drawn, layout, 440)


def curves_caption(e: ForcEvidence) -> str:
    """What the panel of the curves shows."""
    stride = -(-np.unique(e.data.curve).size // _MOST_CURVES)
    each = {1: "the measured curves", 2: "every second measured curve", 3: "every third measured curve"}
    named = each.get(stride, f"every {stride}th measured curve")
    corrected = f", corrected for {e.drift.kind} drift" if e.drift and e.drift.kind != "none" else ""
    return f"{named}{corrected}, dark to bright in the order of measurement"


def profiles_figure(e: ForcEvidence) -> Figure | None:
    """Density along both axes through the peak, with 95 % bands; None without a peak."""
    d, peak, scale = e.diagram, e.diagram.peak, e.scale
    if peak is None:
        return None
    i = int(np.argmin(np.abs(d.centre - peak.centre)))
    j = int(np.argmin(np.abs(d.half_width - peak.half_width)))
    along = _profile(e, d.half_width, d.mu[i], d.se[i], scale.labelled(scale.half_width))
    across = _profile(e, d.centre, d.mu[:, j], d.se[:, j], scale.labelled(scale.centre))
    return Figure(
        [along, across],
        "Profiles through the peak.",
        [
            Html(
                f"First panel: along {scale.half_width} at {scale.centre} = {scale.text(peak.centre)}; second panel: "
                f"along {scale.centre} at {scale.half_width} = {scale.text(peak.half_width)}. Bands: 95 % by the "
                "scatter of the readings."
            )
        ],
        source_label(e.run),
        460,
    )


def _profile(e: ForcEvidence, at: Array, mu: Array, se: Array, title: str) -> Panel:
    scale = e.scale
    known = np.isfinite(mu)
    x, y, half = (
        at[known] * scale.factor,
        mu[known] / scale.factor**2,
        SIGNIFICANT * se[known] / scale.factor**2,
    )
    size, unit = readable_scale(float(np.max(np.abs(y))), per_square(display_unit(e.run.unit), scale.unit))
    y, half = y / size, half / size
    edge_x, edge_y = np.concatenate([x, x[::-1]]), np.concatenate([y - half, (y + half)[::-1]])
    data = [
        line(edge_x, edge_y, "95 %", GREY, width=0, fill="toself", fillcolor=_BAND, hoverinfo="skip"),
        line(x, np.zeros_like(x), "zero", GREY, width=0.8, showlegend=False),
        line(x, y, scale.density, COMPARED[0], width=1.6),
    ]
    layout = {"xaxis": axis(title), "yaxis": axis(f"{scale.density} ({unit})"), "showlegend": False}
    return Panel(data, layout, 340)


def smoothing_figure(e: ForcEvidence) -> Figure | None:
    """Error of the prediction of whole curves against the smoothing factor; None if the factor was given."""
    if not e.diagram.tried:
        return None
    data: list[Trace] = []
    errors = []
    for degree, colour in ((2, COMPARED[0]), (4, COMPARED[1])):
        tried = [choice for choice in e.diagram.tried if choice.degree == degree]
        rms = [float(np.sqrt(choice.error)) for choice in tried]
        errors += rms
        name = f"{_ORDINAL_DEGREES[degree]} polynomials"
        data.append(
            line([c.factor for c in tried], rms, name, colour, mode="lines+markers", marker={"size": 5})
        )
    best = min(e.diagram.tried, key=lambda choice: choice.error)
    data.append(
        dots([best.factor], [float(np.sqrt(best.error))], "chosen", INK, size=12, symbol="circle-open")
    )
    low, high = 0.9 * min(errors), 1.1 * min(max(errors), 30 * min(errors))
    layout = {
        "xaxis": axis(
            "Smoothing factor SF (grid steps)", range=[0, 1.05 * max(c.factor for c in e.diagram.tried)]
        ),
        "yaxis": log_axis(with_unit("Error of prediction, rms", e.run.unit), low, high),
    }
    return Figure(
        [Panel(data, layout, 340)],
        "Choice of the smoothing factor.",
        [
            "Every curve is predicted from the others by local polynomials; the smoothing with the smallest error is "
            "used (circle). SF stands for the (2 SF + 1)² nearest points."
        ],
        source_label(e.run),
    )


def ridge_figure(e: ForcEvidence, ridge: CentralRidge) -> Figure:
    """The mean density across the ridge, with background and fit."""
    scale = e.scale
    mu = ridge.mean / scale.factor**2
    size, unit = readable_scale(float(np.max(np.abs(mu))), per_square(display_unit(e.run.unit), scale.unit))
    x = (ridge.offset + (e.diagram.peak.centre if e.diagram.peak else 0.0)) * scale.factor
    parts = (
        (ridge.background, "background", GREY, "dash"),
        (ridge.fitted, "background and ridge", MODEL, "solid"),
    )
    data = [line(x, y / scale.factor**2 / size, name, colour, dash=dash) for y, name, colour, dash in parts]
    data.append(dots(x, mu / size, "mean density", INK, size=4))
    low, high = number(ridge.between[0] * scale.factor), scale.text(ridge.between[1])
    layout = {"xaxis": axis(scale.labelled(scale.centre)), "yaxis": axis(f"Mean of {scale.density} ({unit})")}
    return Figure(
        [Panel(data, layout, 340)],
        "The central ridge and its background.",
        [
            Html(
                f"Mean of the density over {scale.half_width} from {low} to {high}, with SF = 3. The fitted ridge is "
                f"{scale.text(ridge.fwhm)} wide (full width at half maximum, without the resolution of "
                f"{scale.text(ridge.resolution)}) and holds {100 * ridge.share:.0f} % of this density; its height is "
                f"{number(ridge.height / ridge.height_se, 2)} standard errors."
            )
        ],
        source_label(e.run),
    )


def drift_figure(e: ForcEvidence) -> Figure | None:
    """The calibration points in the order of measurement, with the decision on drift; None without them."""
    if e.drift is None:
        return None
    at = e.run["step"] < 0
    moments = e.run["position"][at]
    mean = float(np.mean(moments))
    change = 100 * (moments / mean - 1) if mean else moments
    unit = "%" if mean else display_unit(e.run.unit)
    layout = {
        "xaxis": axis("Calibration point"),
        "yaxis": axis(f"Moment − mean ({unit})"),
        "showlegend": False,
    }
    points = np.arange(1, moments.size + 1)
    panel = Panel([line(points, change, "calibration points", COMPARED[0], width=1.2)], layout, 300)
    return Figure(
        [panel], "Drift at the calibration points.", [_drift_words(e.drift, e.run.unit)], source_label(e.run)
    )


def _drift_words(drift: DriftDecision, unit: str) -> str:
    shown = spaced(display_unit(unit))
    errors = ", ".join(
        f"{number(drift.error[kind], 4)}{shown} with {kind} correction"
        for kind in ("multiplicative", "additive")
    )
    verdict = (
        "The moments are used as measured."
        if drift.kind == "none"
        else f"The {drift.kind} correction is applied."
    )
    return (
        f"Every second curve is predicted from its neighbours: rms error {number(drift.error['none'], 4)}{shown} as "
        f"measured, {errors} (n = {drift.n}). {verdict}"
    )

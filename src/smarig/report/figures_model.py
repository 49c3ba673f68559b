"""Figures of an identified model: curves with fit, surface, density μ, parameters against α (§5.4).

Mirrored data (reversal curves) are drawn in the mirror they were fitted in, and the caption says so.
"""

from typing import Any

import numpy as np

from smarig.identification.curve_fit import fit_curves
from smarig.identification.fod_data import FodData
from smarig.identification.identify import Identification
from smarig.model.fod_surface import FodSurface
from smarig.model.mirrored import Mirrored
from smarig.report.figure import Figure, Panel, axis, dots, line, packed
from smarig.report.style import DIVERGING, INK, MODEL, SEQUENCE, SURFACES, colours
from smarig.report.words import number

_GRID = 90
_MOST_CURVES = 14


def fod_curves(result: Identification) -> Figure:
    """Measured descending curves with the model's (Figs 5.12, 5.13, 5.17, 5.18)."""
    data, image = result.data, _image(result)
    descents = data.descents()
    shown = descents[:: max(1, len(descents) // _MOST_CURVES)]
    traces: list[dict[str, Any]] = []
    for curve, colour in zip(shown, colours(len(shown)), strict=True):
        beta = np.linspace(data.lower, curve.alpha, 80)
        label = f"α = {number(curve.alpha)}"
        traces.append(line(beta, _along(image, curve.alpha, beta), label, colour, showlegend=False, width=1.5))
        traces.append(dots(curve.beta, curve.y, label, colour, size=6, showlegend=False))
    traces[0]["showlegend"] = traces[1]["showlegend"] = True
    traces[0]["name"], traces[1]["name"] = f"model ({result.surface})", "measured"
    peaks = {"textposition": "top left", "textfont": {"size": 11}, "hoverinfo": "skip", "showlegend": False}
    names = [f"α = {number(c.alpha)}" for c in shown]
    traces.append(line([c.alpha for c in shown], [c.y[-1] for c in shown], "α", INK, mode="text", text=names) | peaks)
    layout = {"xaxis": axis(f"β ({_input_unit(result)})"), "yaxis": axis(f"y(α, β) ({data.unit})")}
    figures = result.model.fit
    caption = [
        f"{len(descents)} curves, {len(data)} points; the colour is the peak α, dark low, bright high.",
        f"The {result.surface} model misses the points by {number(figures['rms'])} {data.unit} rms.",
        _mirror_note(result),
    ]
    return Figure([Panel(traces, layout, 480)], "First-order descending curves.", caption, result.model.twin)


def parameters_against_alpha(result: Identification) -> Figure:
    """b₁, b₂, b₃ of the per-curve sigmoids against α (Fig. 5.16), with standard errors."""
    fits = fit_curves(result.data)
    alpha, b, se = fits.against_alpha()
    panels = []
    for k, (name, unit) in enumerate((("b₁", result.data.unit), ("b₂", f"1/{_input_unit(result)}"), ("b₃", _input_unit(result)))):
        bars = {"type": "data", "array": packed(np.nan_to_num(se[:, k])), "thickness": 1}
        trace = dots(alpha, b[:, k], name, INK, error_y=bars, showlegend=False)
        panels.append(Panel([trace], {"xaxis": axis(f"α ({_input_unit(result)})"), "yaxis": axis(f"{name} ({unit})")}, 300))
    short = ", ".join(number(a) for a in fits.too_short)
    caption = [
        "Each descending curve fitted by itself with b₁/(1 + exp(−b₂(β + b₃))) + b₄; bars are standard errors.",
        f"The points of the curves at α = {short} do not determine four parameters." if short else "",
    ]
    return Figure(panels, "Sigmoids, curve by curve (Fig. 5.16).", caption, result.model.twin, 320)


def surface_plot(result: Identification) -> Figure:
    """The FOD surface with the measured points (Figs 5.14, 5.17)."""
    data, image = result.data, _image(result)
    grid = np.linspace(data.lower, data.upper, 60)
    traces = [
        {
            "type": "surface",
            "x": packed(grid),
            "y": packed(grid),
            "z": packed(_triangle(image, grid)),
            "colorscale": SEQUENCE,
            "opacity": 0.85,
            "colorbar": {"title": {"text": data.unit}, "thickness": 12, "len": 0.7},
        },
        {
            "type": "scatter3d",
            "mode": "markers",
            "x": packed(data.alpha),
            "y": packed(data.beta),
            "z": packed(data.y),
            "marker": {"size": 2.6, "color": INK},
            "name": "measured",
        },
    ]
    layout = {"scene": _scene(result, f"y ({data.unit})"), "margin": {"l": 0, "r": 0, "t": 24, "b": 0}}
    caption = [f"Output after negative saturation → α → β; dots are the {len(data)} measured points."]
    return Figure([Panel(traces, layout, 460)], "FOD surface.", caption, result.model.twin)


def density_plots(result: Identification) -> Figure:
    """μ as a map and in 3-D, the reversible part g(β) beside it (Figs 5.19, 5.20). Analytic surfaces only."""
    image = _image(result)
    if not isinstance(image, FodSurface):
        raise TypeError("Only analytic surfaces have a density to draw.")
    grid = np.linspace(image.lower, image.upper, _GRID)
    a, b = np.meshgrid(grid, grid, indexing="ij")
    mu = np.where(b <= a, image.density(a, b), np.nan)
    top = float(np.nanmax(np.abs(mu)))
    scale = {"colorscale": DIVERGING, "cmin": -top, "cmax": top}
    unit = f"{result.data.unit}/{_input_unit(result)}²"
    panels = [_map(result, grid, mu, top, unit), _relief(result, grid, mu, scale), _reversible(result, image, grid)]
    d = result.density
    positive = "μ ≥ 0 everywhere: M_P." if d.M_P else (
        f"μ is negative (blue, outlined): at least {number(d.mu_min)} {unit}, at α = {number(d.mu_min_at[0])}, "
        f"β = {number(d.mu_min_at[1])}: in M_PC, not in M_P."
    )
    share = f"The reversible part ∫g carries {100 * d.reversible_share:.1f} % of the range."
    return Figure(panels, "Preisach density.", [positive, share, _mirror_note(result)], result.model.twin, 330)


def _map(result: Identification, grid: np.ndarray, mu: np.ndarray, top: float, unit: str) -> Panel:
    heat = {
        "type": "heatmap",
        "x": packed(grid),
        "y": packed(grid),
        "z": packed(mu),
        "colorscale": DIVERGING,
        "zmin": -top,
        "zmax": top,
        "colorbar": {"title": {"text": unit}, "thickness": 12, "exponentformat": "power"},
    }
    zero = {
        "type": "contour",
        "x": packed(grid),
        "y": packed(grid),
        "z": packed(np.where(mu < -1e-3 * top, -1.0, np.where(np.isfinite(mu), 1.0, np.nan))),
        "contours": {"start": 0, "end": 0, "size": 1, "coloring": "none"},
        "line": {"color": INK, "width": 1},
        "showscale": False,
        "hoverinfo": "skip",
    }
    traces = [heat] if result.density.M_P else [heat, zero]
    unit_in = _input_unit(result)
    return Panel(traces, {"xaxis": axis(f"β ({unit_in})"), "yaxis": axis(f"α ({unit_in})")}, 400)


def _relief(result: Identification, grid: np.ndarray, mu: np.ndarray, scale: dict[str, Any]) -> Panel:
    trace = {"type": "surface", "x": packed(grid), "y": packed(grid), "z": packed(mu), "showscale": False} | scale
    layout = {"scene": _scene(result, "μ", swapped=True), "margin": {"l": 0, "r": 0, "t": 24, "b": 0}}
    return Panel([trace], layout, 400)


def _reversible(result: Identification, image: FodSurface, grid: np.ndarray) -> Panel:
    unit_in = _input_unit(result)
    trace = line(grid, image.reversible(grid), "g", SURFACES.get(result.surface, MODEL), showlegend=False)
    return Panel([trace], {"xaxis": axis(f"β ({unit_in})"), "yaxis": axis(f"g(β) ({result.data.unit}/{unit_in})")}, 400)


def _scene(result: Identification, z: str, swapped: bool = False) -> dict[str, Any]:
    unit = _input_unit(result)
    names = ("β", "α") if swapped else ("α", "β")
    return {
        "xaxis": axis(f"{names[0]} ({unit})"),
        "yaxis": axis(f"{names[1]} ({unit})"),
        "zaxis": axis(z),
        "camera": {"eye": {"x": 1.25, "y": -1.35, "z": 0.7}},
        "aspectmode": "manual",
        "aspectratio": {"x": 1, "y": 1, "z": 0.7},
    }


def _triangle(image: Any, grid: np.ndarray) -> np.ndarray:
    """z[j, i] = y(α_i, β_j), NaN above the diagonal: the orientation Plotly wants."""
    b, a = np.meshgrid(grid, grid, indexing="ij")
    return np.where(b <= a, image.y(np.maximum(a, b), b), np.nan)


def _along(image: Any, alpha: float, beta: np.ndarray) -> np.ndarray:
    return np.asarray(image.y(np.full_like(beta, alpha), beta), dtype=float)


def _image(result: Identification) -> Any:
    h = result.model.hysteresis
    return h.image if isinstance(h, Mirrored) else h


def _input_unit(result: Identification) -> str:
    return result.model.input.unit


def _mirror_note(result: Identification) -> str:
    return "Drawn in the mirror (−input, −output), in which rising curves are descending." if result.data.mirrored else ""

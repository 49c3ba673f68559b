"""Figures over the Preisach plane: the FOD surface with its data, μ as map and surface, and g (Figs. 5.19, 5.20)."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from smarig.core import Array, spaced
from smarig.identification import DensityReport, Identification
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, axis, cross, heat_map, line, packed
from smarig.report.components.numbers import number, raised
from smarig.report.components.run_description import run_caption, source_label
from smarig.report.components.style import DIVERGING, INK, SEQUENCE, surface_colour
from smarig.report.models.identification_plot_data import (
    axis_symbols,
    density_grid,
    density_map,
    density_report_of,
    output_grid,
    reversible,
    sign,
)

SURFACE_MIN_PX = 520  # a narrower three-dimensional figure would lose its sides and buttons


def surface_figure(found: Mapping[str, Identification], chosen: str, run: Run) -> Figure:
    """The FOD surface in three dimensions with its data points; buttons select the surface."""
    one = found[chosen]
    d, s = one.data, sign(one)
    points = {
        "type": "scatter3d",
        "mode": "markers",
        "x": (s * d.beta).tolist(),
        "y": (s * d.alpha).tolist(),
        "z": (s * d.y).tolist(),
        "name": "measured",
        "marker": {"size": 3, "color": INK},
    }
    surfaces = []
    for name, each in found.items():
        alpha, beta, y = output_grid(each)
        surfaces.append(
            surface_trace(beta, alpha, y, name, name == chosen) | {"colorscale": SEQUENCE, "opacity": 0.85}
        )
    turn, here = axis_symbols(one)
    layout = scene(f"{here} ({run.input_unit})", f"{turn} ({run.input_unit})", f"y ({run.unit})") | {
        "updatemenus": [buttons(list(found), chosen, keep=1)],
        "showlegend": False,
    }
    return Figure(
        [Panel([points, *surfaces], layout, 440, min_width_px=SURFACE_MIN_PX, explore=True)],
        f"FOD surface y(α, β), {chosen}.",
        [
            f"Output after the input turns at {turn} and reaches {here}. "
            f"{f'Black: the {len(d)} measured points of these curves' if d.curves else 'No such curve was measured'}. "
            "Explore: select a surface, rotate.",
            run_caption(run),
        ],
        source_label(run),
    )


def surface_trace(x: Any, y: Any, z: Any, name: str, visible: bool) -> Trace:
    """A surface trace from grids (n, n) of x, y and z."""
    grids = {key: packed(v, single=True) for key, v in (("x", x), ("y", y), ("z", z))}
    return {"type": "surface", "name": name, "visible": visible, "showscale": False, **grids}


def scene(x: str, y: str, z: str) -> dict[str, Any]:
    """The layout of a three-dimensional plot, viewed from above the β axis."""
    titles = {
        "xaxis": {"title": {"text": x}},
        "yaxis": {"title": {"text": y}},
        "zaxis": {"title": {"text": z}},
    }
    camera = {"eye": {"x": 1.45, "y": -1.6, "z": 0.75}, "center": {"x": 0, "y": 0, "z": -0.16}}
    return {
        "scene": titles
        | {"camera": camera, "aspectmode": "manual", "aspectratio": {"x": 1.1, "y": 1.1, "z": 0.75}},
        "margin": {"l": 0, "r": 0, "t": 44, "b": 0},
    }


def buttons(names: list[str], chosen: str, *, keep: int) -> dict[str, Any]:
    """Buttons that show one surface at a time; the first ``keep`` traces are always visible."""
    return {
        "type": "buttons",
        "direction": "right",
        "x": 0,
        "xanchor": "left",
        "y": 1,
        "yanchor": "bottom",
        "active": names.index(chosen),
        "font": {"size": 12},
        "buttons": [
            {
                "label": name,
                "method": "restyle",
                "args": [{"visible": [True] * keep + [name == other for other in names]}],
            }
            for name in names
        ],
    }


def maps_figure(found: Mapping[str, Identification], run: Run) -> Figure:
    """A map of μ per surface: white zero, red positive, blue negative, with the zero line and the minimum."""
    return Figure(
        [
            map_panel(name, density_map(one), density_report_of(one), (run.unit, run.input_unit))
            for name, one in found.items()
        ],
        "Weighting function μ(α, β) = ½ ∂²y/∂α∂β.",
        [
            "White is zero, red positive, blue negative; each map has its own scale, symmetric about zero. "
            "Outlined and tinted: μ < 0, even if small; cross: the minimum. "
            + "; ".join(_minimum_text(name, one, run) for name, one in found.items())
            + ". For a table, μ is the mass of each cell divided by its area and includes the noise of the readings.",
            "The cells of the positive measure are never negative, and vary smoothly where there are no data."
            if "positive" in found
            else "",
            run_caption(run),
        ],
        source_label(run),
        420,
    )


def density_unit(run: Run) -> str:
    """Unit of μ: output per squared input."""
    return per_square(run.unit, run.input_unit)


def per_square(unit: str, input_unit: str) -> str:
    """Unit of μ from those of output and input."""
    return f"{unit}/{input_unit}²" if input_unit else unit


def readable_scale(top: float, unit: str) -> tuple[float, str]:
    """A power of ten that makes ``top`` readable, and the unit that includes it: (1e-3, "10⁻³ mm/K²")."""
    power = int(np.floor(np.log10(top))) if top > 0 else 0
    if -2 < power < 3:
        return 1.0, unit
    return 10.0**power, f"10{raised(power)}{spaced(unit)}"


def _minimum_text(name: str, found: Identification, run: Run) -> str:
    d = density_report_of(found)
    at = f"α = {number(d.mu_min_at[0], 4)}, β = {number(d.mu_min_at[1], 4)}{spaced(run.input_unit)}"
    return f"{name}: min μ = {number(d.mu_min)} {density_unit(run)} at {at}"


def map_panel(
    name: str,
    grid: tuple[Array, Array, Array],
    d: DensityReport,
    units: tuple[str, str],
    top: float | None = None,
) -> Panel:
    """μ over the Preisach plane, coloured up to ``top`` (default: max |μ|); ``units`` of output and input."""
    alpha, beta, mu = grid
    top = top or float(np.nanmax(np.abs(mu))) or 1.0
    size, unit = readable_scale(top, per_square(*units))
    ends, hover = (-top / size, top / size), "α %{y:.4g}<br>β %{x:.4g}<br>μ %{z:.3g}"
    heat = heat_map(beta, alpha, mu / size, ends, f"μ ({unit})", hover)
    data: list[Trace] = [heat]
    if not d.M_P and beta.size == mu.shape[1]:
        data.append({key: heat[key] for key in "xyz"} | _NEGATIVE)
    inputs = [float(beta.min()), float(beta.max())]
    data.append(line(inputs, inputs, "α = β", INK, width=1, hoverinfo="skip"))
    data.append(cross(d.mu_min_at[1], d.mu_min_at[0], "minimum", INK, size=11, cliponaxis=False))
    layout = {
        "title": {"text": name, "font": {"size": 14}, "x": 0.02, "y": 0.97},
        "xaxis": axis(f"β ({units[1]})", constrain="domain", range=inputs),
        "yaxis": axis(f"α ({units[1]})", scaleanchor="x", constrain="domain", range=inputs),
        "showlegend": False,
    }
    return Panel(data, layout, 430)


_NEGATIVE: Trace = {
    "type": "contour",
    # Plotly tints the region that a constraint excludes
    "contours": {"type": "constraint", "operation": ">", "value": 0},
    "fillcolor": "rgba(33,102,172,.14)",
    "line": {"color": INK, "width": 1.6},
    "showscale": False,
    "hoverinfo": "skip",
}


def density_figure(found: Mapping[str, Identification], chosen: str, run: Run) -> Figure | None:
    """μ in three dimensions, and g(β); None if only tables were identified."""
    grids = {name: grid for name, one in found.items() if (grid := density_grid(one)) is not None}
    if not grids:
        return None
    first = chosen if chosen in grids else next(iter(grids))
    size, unit = readable_scale(
        max(float(np.abs(mu).max()) for _, _, mu in grids.values()), density_unit(run)
    )
    data = []
    for name, (alpha, beta, mu) in grids.items():
        top = float(np.abs(mu).max()) / size
        shades = {"colorscale": DIVERGING, "cmin": -top, "cmax": top}
        data.append(surface_trace(beta, alpha, mu / size, name, name == first) | shades)
    layout = scene(f"β ({run.input_unit})", f"α ({run.input_unit})", f"μ ({unit})")
    layout |= {"updatemenus": [buttons(list(grids), first, keep=0)], "showlegend": False}
    shares = "; ".join(
        f"{name} {100 * density_report_of(found[name]).reversible_share:.1f} %" for name in grids
    )
    return Figure(
        [Panel(data, layout, 440, min_width_px=SURFACE_MIN_PX, explore=True), _reversible(found, grids, run)],
        f"μ(α, β) of the {first} surface, and the reversible part g.",
        [
            "First panel: μ as in the map, with colours centred at zero; explore to select a surface. Second "
            "panel: g(β) = ∂y/∂β on α = β, the relays of zero width, which μ does not contain. A simulation with μ "
            f"alone lacks their part of the stroke ({shares}).",
            run_caption(run),
        ],
        source_label(run),
        440,
    )


def _reversible(found: Mapping[str, Identification], names: Mapping[str, object], run: Run) -> Panel:
    data = []
    for name in names:
        part = reversible(found[name])
        if part is not None:
            data.append(line(*part, name, surface_colour(name), width=2))
    layout = {
        "xaxis": axis(f"β ({run.input_unit})"),
        "yaxis": axis(f"g ({run.unit}/{run.input_unit})", rangemode="tozero"),
    }
    return Panel(data, layout, 440)

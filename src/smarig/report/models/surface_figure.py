"""Three-dimensional surfaces over the Preisach plane: the FOD surface with its data, and shared parts."""

from collections.abc import Mapping
from typing import Any

from smarig.identification import Identification
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, packed
from smarig.report.components.run_description import run_caption, source_label
from smarig.report.components.style import INK, SEQUENCE
from smarig.report.models.identification_plot_data import axis_symbols, output_grid, sign

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

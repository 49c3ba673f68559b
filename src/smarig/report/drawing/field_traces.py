"""Draws fields over a plane: maps of colours, lines of a constant value, and surfaces."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from smarig.report.drawing.colour_scales import colour, colour_map
from smarig.report.drawing.markup import plain_text
from smarig.report.drawing.trace_values import values

Trace = dict[str, Any]
_SURFACE_LINES = 48  # of a surface, in each direction


def draw_map(axes: Axes, trace: Trace) -> None:
    """Draw a map of colours with its scale; cells may have texts."""
    z = np.ma.masked_invalid(values(trace, "z"))
    x, y = _places(axes, trace, "x", z.shape[1]), _places(axes, trace, "y", z.shape[0])
    drawn = axes.pcolormesh(
        x,
        y,
        z,
        cmap=colour_map(trace["colorscale"]),
        vmin=trace.get("zmin"),
        vmax=trace.get("zmax"),
        shading="flat" if len(x) > z.shape[1] else "nearest",
        edgecolors="white" if trace.get("xgap") else "none",
        linewidth=trace.get("xgap", 0),
        rasterized=z.size > 500,
        zorder=0.5,
    )
    if trace.get("showscale", True):
        scale = axes.figure.colorbar(drawn, ax=axes, pad=0.02, fraction=0.05, aspect=30)
        scale.outline.set_visible(False)
        scale.set_label(plain_text(trace.get("colorbar", {}).get("title", {}).get("text", "")))
    if "text" in trace:
        _cell_texts(axes, trace, np.asarray(z))


def _places(axes: Axes, trace: Trace, key: str, count: int) -> Any:
    """Centres of the cells, or their edges; names become ticks."""
    given = values(trace, key)
    if given.dtype.kind in "fi":
        return given
    which = axes.xaxis if key == "x" else axes.yaxis
    which.set_ticks(np.arange(count), [plain_text(name) for name in given])
    return np.arange(count)


def _cell_texts(axes: Axes, trace: Trace, z: Any) -> None:
    middle = (trace.get("zmin", np.nanmin(z)) + trace.get("zmax", np.nanmax(z))) / 2
    for j, row in enumerate(trace["text"]):
        for i, text in enumerate(row):
            if text:
                shade = "white" if z[j, i] < middle else "black"
                size = trace.get("textfont", {}).get("size", 10)
                axes.text(i, j, plain_text(text), color=shade, ha="center", va="center", fontsize=size)


def draw_contour(axes: Axes, trace: Trace) -> None:
    """Draw a tint where a constraint does not hold, and its boundary; or lines of constant values."""
    x, y, z = (values(trace, key) for key in "xyz")
    given, edge = trace["contours"], trace.get("line", {})
    style = {"colors": [edge.get("color", "black")], "linewidths": edge.get("width", 1.0)}
    if given.get("type") == "constraint":
        level = float(given["value"])
        low = float(np.nanmin(z))
        if low < level:
            axes.contourf(x, y, z, levels=[low - 1, level], colors=[colour(trace["fillcolor"])])
        axes.contour(x, y, z, levels=[level], **style)
        return
    axes.contour(x, y, z, levels=[float(level) for level in given["levels"]], **style)


def draw_surface(axes: Any, trace: Trace) -> None:
    """Draw a surface in three dimensions."""
    x, y, z = (values(trace, key) for key in "xyz")
    if x.ndim == 1:
        x, y = np.meshgrid(x, y)
    low, high = trace.get("cmin", np.nanmin(z)), trace.get("cmax", np.nanmax(z))
    axes.plot_surface(
        x,
        y,
        z,
        cmap=colour_map(trace["colorscale"]),
        vmin=low,
        vmax=high,
        rcount=_SURFACE_LINES,
        ccount=_SURFACE_LINES,
        linewidth=0,
        antialiased=True,
        alpha=trace.get("opacity"),
        rasterized=True,
    )


def draw_solid_points(axes: Any, trace: Trace) -> None:
    """Draw points in three dimensions."""
    marker = trace["marker"]
    x, y, z = (values(trace, key) for key in "xyz")
    axes.scatter(x, y, z, s=float(marker.get("size", 3)) ** 2 / 2, color=marker["color"], depthshade=False)

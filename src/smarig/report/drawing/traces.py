"""Draws traces: lines, markers, outlines, error bars, bars; maps of colours, lines of a constant value, surfaces."""

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from smarig.report.components.figure import Trace
from smarig.report.drawing.plotly_schema import colour, colour_map, dash, plain_text, symbol, values

_LABEL_PX = 7.0  # distance of a label from its point
_BAR_LABEL_PX = 4.0


def draw_points(axes: Axes, trace: Trace, *, label: str | None) -> None:
    """Draw a scatter trace. ``label``: its name in the legend, None for none."""
    mode = trace.get("mode", "lines")
    if "fill" in trace:
        _filled(axes, trace, label)
        return
    if trace.get("marker", {}).get("symbol") == "arrow":
        _arrows(axes, trace)
        return
    x, y = values(trace, "x"), values(trace, "y")
    style: dict[str, Any] = {"alpha": trace.get("opacity"), "label": label or "_", "linestyle": "none"}
    if "lines" in mode:
        style |= _line_style(trace)
    many = "markers" in mode and np.ndim(trace.get("marker", {}).get("color")) > 0
    if "markers" in mode and not many:
        style |= _marker_style(trace)
    axes.plot(x, y, clip_on=trace.get("cliponaxis", True), **style)
    if many:
        _coloured_points(axes, trace)
    for key in ("error_x", "error_y"):
        if key in trace:
            _error_bars(axes, trace, key)
    if "text" in mode:
        _labels(axes, trace)


def draw_bars(axes: Axes, trace: Trace) -> None:
    """Draw a trace of horizontal bars with their texts at the ends."""
    x, y = values(trace, "x"), values(trace, "y")
    given = trace["marker"]["color"]
    shades = [colour(c) for c in given] if isinstance(given, list) else colour(given)
    axes.barh(y, x, height=trace.get("width", 0.8), color=shades)
    for text, end, row in zip(trace.get("text", ()), x, y):
        side = "left" if end >= 0 else "right"
        shift = (_BAR_LABEL_PX if end >= 0 else -_BAR_LABEL_PX, 0)
        axes.annotate(plain_text(text), (end, row), shift, textcoords="offset points", ha=side, va="center")


def _line_style(trace: Trace) -> dict[str, Any]:
    given = trace.get("line", {})
    return {
        "color": colour(given.get("color")),
        "linewidth": given.get("width", 1.6),
        "linestyle": dash(given.get("dash", "solid")),
    }


def _marker_style(trace: Trace) -> dict[str, Any]:
    given = trace.get("marker", {})
    shade = colour(given.get("color", trace.get("line", {}).get("color")))
    marker, filled = symbol(given.get("symbol", "circle"))
    edge = given.get("line", {})
    return {
        "marker": marker,
        "markersize": float(given.get("size", 6)),
        "markerfacecolor": shade if filled else "none",
        "markeredgecolor": colour(edge.get("color")) or shade,
        "markeredgewidth": edge.get("width", 0.0 if filled and marker != "x" else 1.2),
    }


def _coloured_points(axes: Axes, trace: Trace) -> None:
    given = trace["marker"]
    size = float(given.get("size", 6)) ** 2
    axes.scatter(
        values(trace, "x"),
        values(trace, "y"),
        size,
        values(given, "color"),
        cmap=colour_map(given["colorscale"]),
        linewidths=0,
        zorder=2,
    )


def _filled(axes: Axes, trace: Trace, label: str | None) -> None:
    axes.fill(
        values(trace, "x"),
        values(trace, "y"),
        facecolor=colour(trace["fillcolor"]),
        edgecolor="none",
        label=label or "_",
        zorder=1,
    )


def _arrows(axes: Axes, trace: Trace) -> None:
    """Heads of arrows at the second of each two points, which are separated by gaps."""
    points = np.stack([values(trace, "x"), values(trace, "y")], 1)
    shade = colour(trace["marker"]["color"])
    head = {"arrowstyle": "-|>,head_width=.28,head_length=.55", "color": shade, "linewidth": 0}
    head |= {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 12}
    for a, b in pairwise(points):
        if np.isfinite(a).all() and np.isfinite(b).all():
            axes.annotate("", b, a, arrowprops=head)


def _error_bars(axes: Axes, trace: Trace, key: str) -> None:
    given = trace[key]
    x, y = values(trace, "x"), values(trace, "y")
    size: Any
    if given["type"] == "constant":
        size = np.full(x.size, float(given["value"]))
    else:
        size = values(given, "array")
        if "arrayminus" in given:
            size = np.stack([values(given, "arrayminus"), size])
    bars: dict[str, Any] = {"xerr" if key == "error_x" else "yerr": np.abs(size)}
    axes.errorbar(
        x,
        y,
        **bars,
        fmt="none",
        ecolor=colour(given.get("color")),
        elinewidth=given.get("thickness", 1.2),
        capsize=given.get("width", 4) / 2,
        zorder=1.5,
    )


def _labels(axes: Axes, trace: Trace) -> None:
    """Texts beside their points, as ``textposition`` says: "top left"."""
    upright, *rest = str(trace.get("textposition", "middle right")).split()
    across = rest[0] if rest else "center"
    dx = {"left": -1, "right": 1}.get(across, 0) * _LABEL_PX
    dy = {"top": 1, "bottom": -1}.get(upright, 0) * _LABEL_PX
    aligned: dict[str, Any] = {
        "ha": {"left": "right", "right": "left"}.get(across, "center"),
        "va": {"top": "bottom", "bottom": "top"}.get(upright, "center"),
    }
    for text, x, y in zip(trace["text"], values(trace, "x"), values(trace, "y")):
        axes.annotate(plain_text(text), (x, y), (dx, dy), textcoords="offset points", **aligned)


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

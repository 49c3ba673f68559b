"""Draws a panel, as SVG text for a page or as a file."""

import io
import math
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as MplFigure

from smarig.core import UsageError
from smarig.report.components.figure import WATERMARK, Panel
from smarig.report.components.style import INK
from smarig.report.drawing.compact_svg import compact_svg
from smarig.report.drawing.panel_axes import (
    LEGEND_ROW_PX,
    finish_axes,
    panel_axes,
    row_names,
    set_margins,
    set_vertical,
)
from smarig.report.drawing.plotly_schema import is_shown, plain_text
from smarig.report.drawing.traces import (
    draw_bars,
    draw_contour,
    draw_map,
    draw_points,
    draw_solid_points,
    draw_surface,
)

_GRID = "#eceff3"
_STYLE: dict[str, Any] = {
    "font.family": ["sans-serif"],
    "font.sans-serif": ["DejaVu Sans", "Arial", "Helvetica"],
    "font.size": 12.5,
    "axes.labelsize": 12.5,
    "axes.titlesize": 13.0,
    "xtick.labelsize": 11.0,
    "ytick.labelsize": 11.0,
    "legend.fontsize": 11.0,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": _GRID,
    "grid.linewidth": 0.8,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.major.size": 4.0,
    "ytick.major.size": 4.0,
    "axes.unicode_minus": True,
    "axes.formatter.limits": (-4, 5),
    "lines.solid_capstyle": "round",
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.4,
    "figure.facecolor": "none",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "path.simplify": True,
    "path.simplify_threshold": 0.3,
    "svg.fonttype": "none",
    "svg.image_inline": True,
    "pdf.fonttype": 42,
    "mathtext.default": "regular",
}


def style(**more: Any) -> Any:
    """The settings of Matplotlib for a drawing; ``more`` replaces some."""
    return _STYLE | more


NARROW_PX, WIDTH_PX, WIDE_PX = 380, 560, 1130  # three, two, one panel a row
_CHARACTER_PX, _HANDLE_PX = 6.2, 42.0  # of an entry of a legend
_MARK_PX = 16.0  # height of the label of simulated data
_MARK_BOX = {"facecolor": WATERMARK["bgcolor"], "edgecolor": "none", "pad": 2.0}
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


def svg_of(panel: Panel, label: str = "", width_px: int = WIDTH_PX) -> str:
    """The panel as an ``svg`` element. ``label`` marks simulated data."""
    with rc_context(style(**{"svg.hashsalt": _salt(panel)})):
        drawing = draw_panel(panel, label, width_px)
        text = io.StringIO()
        FigureCanvasSVG(drawing).print_svg(text, metadata=_NO_METADATA)
    return compact_svg(text.getvalue())


def save_figure(panel: Panel, path: Path, kind: str, label: str = "", width_px: int = WIDTH_PX) -> None:
    """Write the panel to a file of a kind: ".svg", ".pdf" or ".png". ``label`` marks simulated data."""
    with rc_context(style()):
        drawing = draw_panel(panel, label, width_px)
        with path.open("wb") as file:
            # loads the backend of the format: that of PDF only when it is needed, for it takes a quarter of a second
            FigureCanvasAgg(drawing).print_figure(file, format=kind[1:], dpi=144)


def draw_on(axes: Axes, panel: Panel, label: str = "") -> None:
    """Draw a panel on given axes, in their own style. Raises UsageError for a panel of several axes or of a solid."""
    if "scene" in panel.layout or len(row_names(panel.layout)) > 1:
        raise UsageError("This figure needs several axes. Leave ax out to get the whole figure.")
    has_legend = panel.layout.get("showlegend", len(panel.data) > 1)
    set_vertical(axes, panel.layout)
    for trace in panel.data:
        if is_shown(trace):
            _draw(axes, trace, has_legend)
    finish_axes({"y": axes}, panel.layout)
    if has_legend:
        axes.legend()
    if label:
        axes.annotate(label, (1, 1), xycoords="axes fraction", ha="right", va="bottom", bbox=_MARK_BOX)


def draw_panel(panel: Panel, label: str, width_px: int) -> MplFigure:
    """The drawing of a panel; 1 point is 1 CSS pixel."""
    measured = "constrained" if _needs_measuring(panel) else None
    drawing = MplFigure(figsize=(width_px / 72, panel.height / 72), dpi=72, layout=measured)
    if "scene" in panel.layout:
        _draw_solid(drawing, panel)
    else:
        _draw_flat(drawing, panel, width_px)
    if label:
        _mark(drawing, label, at_top=panel.layout.get("legend", {}).get("orientation") != "v")
    return drawing


def _draw_flat(drawing: MplFigure, panel: Panel, width_px: int) -> None:
    layout = panel.layout
    axes = panel_axes(drawing, layout)
    rows = list(axes.values())
    has_legend = layout.get("showlegend", len(panel.data) > 1)
    for trace in panel.data:
        if is_shown(trace):
            _draw(axes[str(trace.get("yaxis", "y"))], trace, has_legend)
    finish_axes(axes, layout)
    if "title" in layout:
        rows[0].set_title(plain_text(layout["title"]["text"]), loc="left")
    legend_rows = _legend(drawing, rows, layout.get("legend", {}), width_px) if has_legend else 0
    if not _needs_measuring(panel):
        set_margins(drawing, rows, max(LEGEND_ROW_PX * legend_rows, _MARK_PX))


def _needs_measuring(panel: Panel) -> bool:
    """Whether a scale, names of cells or a legend stand beside the axes."""
    has_side_legend = panel.layout.get("legend", {}).get("orientation") == "v"
    return has_side_legend or any(trace.get("type") == "heatmap" for trace in panel.data)


def _draw(axes: Axes, trace: dict[str, Any], legend: bool) -> None:
    kind = trace.get("type", "scatter")
    if kind == "scatter":
        named = legend and trace.get("showlegend", True) and trace.get("name")
        draw_points(axes, trace, label=plain_text(trace["name"]) if named else None)
    elif kind == "bar":
        draw_bars(axes, trace)
    elif kind == "heatmap":
        draw_map(axes, trace)
    elif kind == "contour":
        draw_contour(axes, trace)
    else:
        raise ValueError(f"A trace of type '{kind}' cannot be drawn.")


def _legend(drawing: MplFigure, rows: list[Axes], given: Mapping[str, Any], width_px: int) -> int:
    """Draw the legend; the number of its rows above the axes."""
    handles: dict[str, Any] = {}
    for row in rows:
        for handle, name in zip(*row.get_legend_handles_labels()):
            handles.setdefault(name, handle)
    if not handles:
        return 0
    if given.get("orientation") == "v":
        title = plain_text(given.get("title", {}).get("text", ""))
        drawing.legend(
            list(handles.values()), list(handles), loc="outside right upper", title=title, alignment="left"
        )
        return 0
    entry_px = _HANDLE_PX + _CHARACTER_PX * max(len(name) for name in handles)
    columns = max(1, min(len(handles), math.floor((width_px - 40) / entry_px)))
    drawing.legend(list(handles.values()), list(handles), loc="outside upper left", ncols=columns)
    return math.ceil(len(handles) / columns)


def _draw_solid(drawing: MplFigure, panel: Panel) -> None:
    axes: Any = drawing.add_subplot(projection="3d")
    scene = panel.layout["scene"]
    for trace in panel.data:
        if is_shown(trace):
            (draw_surface if trace["type"] == "surface" else draw_solid_points)(axes, trace)
    for side in "xyz":
        getattr(axes, f"set_{side}label")(
            plain_text(scene.get(f"{side}axis", {}).get("title", {}).get("text", ""))
        )
    axes.view_init(elev=22, azim=-52)
    axes.set_box_aspect((1.1, 1.1, 0.75), zoom=0.95)
    drawing.subplots_adjust(left=0.0, right=0.96, bottom=0.02, top=1.0)


def _mark(drawing: MplFigure, label: str, *, at_top: bool) -> None:
    drawing.text(
        0.998,
        0.995 if at_top else 0.01,
        label,
        ha="right",
        va="top" if at_top else "bottom",
        fontsize=WATERMARK["font"]["size"],
        color=WATERMARK["font"]["color"],
        bbox=_MARK_BOX,
        in_layout=False,
    )


def _salt(panel: Panel) -> str:
    """What makes the ids of a drawing different from those of others on the page, and the same each time."""
    return f"{zlib.crc32(repr((panel.layout, panel.data)).encode()):08x}"

"""Axes of a panel: rows with a common abscissa, titles, ranges, ticks, lines across, notes, and margins.

Margins are estimated from the lengths of the texts: measuring each text takes as long as the whole drawing.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from matplotlib.ticker import MaxNLocator, MultipleLocator, NullFormatter, NullLocator, ScalarFormatter

from smarig.report.components.figure import MOST_DRAWN
from smarig.report.components.numbers import raised
from smarig.report.drawing.plotly_schema import colour, dash, plain_text

Layout = Mapping[str, Any]


class _PlainNumbers(ScalarFormatter):
    """Numbers at ticks, with a common power of ten as in "× 10⁻³"."""

    def get_offset(self) -> str:
        power = super().get_offset().partition("e")[2].replace("−", "-")
        return f"× 10{raised(int(power))}" if power else ""


def row_names(layout: Layout) -> list[str]:
    """Names of the vertical axes of a layout, from above: "yaxis", "yaxis2"."""
    names = sorted((key for key in layout if key.startswith("yaxis")), key=lambda key: int(key[5:] or 1))
    return names or ["yaxis"]


def panel_axes(drawing: MplFigure, layout: Layout) -> dict[str, Axes]:
    """The axes of each row by the name that traces use ("y", "y2")."""
    names = row_names(layout)
    heights = [_height(layout.get(name, {})) for name in names]
    rows = drawing.subplots(len(names), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    axes = {f"y{name[5:]}": row for name, row in zip(names, rows)}
    for name, row in zip(names, rows):
        _set_axis(row, "y", layout.get(name, {}))
        if layout.get(name, {}).get("mirror", True) is False:
            row.spines[["top", "right"]].set_visible(False)
    for row in rows[:-1]:
        row.tick_params(labelbottom=False)
    return axes


def set_vertical(axes: Axes, layout: Layout) -> None:
    """Set title and ticks of the ordinate of a panel with one row."""
    _set_axis(axes, "y", layout.get("yaxis", {}))


def _height(axis: Mapping[str, Any]) -> float:
    low, high = axis.get("domain", (0.0, 1.0))
    return max(high - low, 0.01)


def finish_axes(axes: dict[str, Axes], layout: Layout) -> None:
    """Set what depends on the drawn data: the abscissa, equal scales, lines across, and notes."""
    rows = list(axes.values())
    _set_axis(rows[-1], "x", layout.get("xaxis", {}))
    for name, row in zip(row_names(layout), rows):
        _set_range(row, "y", layout.get(name, {}))
        if layout.get(name, {}).get("rangemode") == "tozero":
            row.set_ylim(bottom=min(0.0, row.get_ylim()[0]))
        if layout.get(name, {}).get("scaleanchor"):
            row.set_aspect("equal", adjustable="box")
    _set_range(rows[-1], "x", layout.get("xaxis", {}))
    for row in rows:
        _power_in_label(row)
    for shape in layout.get("shapes", ()):
        _line_across(rows, shape)
    for note in layout.get("annotations", ()):
        _note(rows[0], note)


def _power_in_label(axes: Axes) -> None:
    """State a common power of ten with the unit, as in "Moment (10⁻⁷ A m²)": elsewhere a legend would hide it."""
    form, title = axes.yaxis.get_major_formatter(), axes.get_ylabel()
    if not isinstance(form, _PlainNumbers) or not title.endswith(")") or "(" not in title:
        return
    low, high = sorted(axes.get_ylim())
    form.set_locs([at for at in axes.get_yticks().tolist() if low <= at <= high])
    if power := form.get_offset():
        quantity, unit = title.rsplit("(", 1)
        axes.set_ylabel(f"{quantity}({power.removeprefix('× ')} {unit}")
        axes.yaxis.get_offset_text().set_visible(False)


def _set_axis(axes: Axes, side: str, given: Mapping[str, Any]) -> None:
    which = axes.xaxis if side == "x" else axes.yaxis
    title = given.get("title", {})
    which.set_label_text(
        plain_text(title.get("text", "")), **({"size": title["font"]["size"]} if "font" in title else {})
    )
    if given.get("type") == "log":
        (axes.set_xscale if side == "x" else axes.set_yscale)("log")
    if "tickvals" in given:
        which.set_ticks(given["tickvals"], [plain_text(t) for t in given.get("ticktext", given["tickvals"])])
        which.set_minor_locator(NullLocator())
        which.set_minor_formatter(NullFormatter())
    elif given.get("type") != "log":
        which.set_major_formatter(_PlainNumbers(useOffset=False))
    if "tickvals" in given:
        pass
    elif isinstance(given.get("dtick"), int) and given.get("type") != "log":
        which.set_major_locator(MultipleLocator(given["dtick"]))
    elif "nticks" in given and given.get("type") != "log":
        which.set_major_locator(MaxNLocator(given["nticks"]))
    if given.get("ticks") == "":
        which.set_tick_params(length=0)
    if given.get("showgrid") is False:
        which.grid(visible=False)
    if given.get("tickangle"):
        which.set_tick_params(rotation=-given["tickangle"])


def _set_range(axes: Axes, side: str, given: Mapping[str, Any]) -> None:
    limits = axes.set_xlim if side == "x" else axes.set_ylim
    if "range" in given:
        low, high = (10.0**end if given.get("type") == "log" else end for end in given["range"])
        if max(abs(low), abs(high)) <= MOST_DRAWN:
            limits(low, high)
    if given.get("autorange") == "reversed":
        (axes.invert_xaxis if side == "x" else axes.invert_yaxis)()


def _line_across(rows: list[Axes], shape: Mapping[str, Any]) -> None:
    given = shape.get("line", {})
    style: dict[str, Any] = {
        "color": colour(given.get("color", "black")),
        "linewidth": given.get("width", 1.0),
        "linestyle": dash(given.get("dash", "solid")),
        "zorder": 0.6,
    }
    for row in rows:
        if shape["x0"] == shape["x1"]:
            row.axvline(shape["x0"], **style)
        else:
            row.axhline(shape["y0"], **style)


def _note(axes: Axes, note: Mapping[str, Any]) -> None:
    inside = note.get("xref", "x") != "x"
    frame = (
        {"facecolor": colour(note["bgcolor"]), "edgecolor": "none", "pad": 2.0} if "bgcolor" in note else None
    )
    font = note.get("font", {})
    axes.text(
        note["x"],
        note["y"],
        plain_text(note["text"]),
        transform=axes.transAxes if inside else axes.transData,
        ha={"auto": "center"}.get(note.get("xanchor", "center"), note.get("xanchor", "center")),
        va={"middle": "center"}.get(note.get("yanchor", "center"), note.get("yanchor", "center")),
        fontsize=font.get("size", 12),
        color=colour(font.get("color", "black")),
        bbox=frame,
        zorder=5,
    )


_CHARACTER_PX, _LINE_PX = 6.9, 15.0
_TICK_PX, _EDGE_PX, _ROW_GAP_PX = 8.0, 6.0, 12.0
LEGEND_ROW_PX = 18.0


def set_margins(drawing: MplFigure, rows: Sequence[Axes], above_px: float) -> None:
    """Set the margins of rows of axes. ``above_px``: height of what stands above the axes."""
    width, height = (72 * size for size in drawing.get_size_inches())
    left = max(_left_px(row) for row in rows)
    below = _EDGE_PX + _TICK_PX + _lines(rows[-1].get_xlabel()) * _LINE_PX + _tick_lines(rows[-1]) * _LINE_PX
    right = _EDGE_PX + 0.5 * _CHARACTER_PX * _longest(_tick_texts(rows[-1], "x")[-1:])
    title_px = 1.3 * _LINE_PX if rows[0].get_title("left") else 0.0
    inner = (height - below - above_px - title_px - (len(rows) - 1) * _ROW_GAP_PX) / len(rows)
    drawing.subplots_adjust(
        left=left / width,
        right=1 - right / width,
        bottom=below / height,
        top=1 - (above_px + title_px + _EDGE_PX) / height,
        hspace=_ROW_GAP_PX / inner,
    )
    for row in rows:  # titles of all rows in one line
        row.yaxis.set_label_coords(-(left - _EDGE_PX) / (width - left - right), 0.5)
        row.yaxis.label.set_verticalalignment("top")


def _left_px(row: Axes) -> float:
    ticks = _CHARACTER_PX * _longest(_tick_texts(row, "y"))
    return _EDGE_PX + _TICK_PX + ticks + _lines(row.get_ylabel()) * _LINE_PX


def _tick_texts(row: Axes, side: str) -> list[str]:
    which = row.yaxis if side == "y" else row.xaxis
    low, high = sorted(row.get_ylim() if side == "y" else row.get_xlim())
    shown = [at for at in which.get_majorticklocs() if low <= at <= high]
    return [str(text) for text in which.get_major_formatter().format_ticks(shown)]


def _tick_lines(row: Axes) -> int:
    return max((_lines(text) for text in _tick_texts(row, "x")), default=1)


def _longest(texts: Sequence[str]) -> int:
    return max((len(line) for text in texts for line in text.split("\n")), default=1)


def _lines(text: str) -> int:
    return text.count("\n") + 1 if text else 0

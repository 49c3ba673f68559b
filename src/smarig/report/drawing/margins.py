"""Margins of a drawing with room for tick labels, titles and legend.

They are estimated from the lengths of the texts: measuring each text takes as long as the whole drawing.
"""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure

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

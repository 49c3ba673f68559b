"""A figure: panels, a title sentence, and a self-contained caption.

Traces and layouts are plain dictionaries in Plotly's schema, with arrays packed in base64. A page shows each panel as a
vector drawing; panels to ``explore`` also carry their data, which the interactive library draws on request.
"""

import base64
import gzip
import html
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array
from smarig.report.components.html import Html, joined, tag
from smarig.report.components.numbers import number
from smarig.report.components.style import BAND, DIVERGING, GREY

Trace = dict[str, Any]
MOST_DRAWN = 1e30  # in any unit
AXIS_MARGIN = 1.15  # length of an axis relative to the largest value drawn
WATERMARK = {
    "xref": "paper",
    "yref": "paper",
    "x": 1,
    "y": 1,
    "xanchor": "right",
    "yanchor": "bottom",
    "showarrow": False,
    "bgcolor": "#f7c948",
    "borderpad": 2,
    "font": {"size": 11, "color": "#111"},
}


@dataclass(frozen=True)
class Panel:
    """One plot: traces and layout (Plotly schema), height in CSS pixels; a ``wide`` panel takes a whole row.

    ``explore``: readers want to zoom or turn it. On pages narrower than ``min_width_px`` the panel keeps that width and
    scrolls inside its frame.
    """

    data: Sequence[Trace]
    layout: Mapping[str, Any]
    height: int = 420
    wide: bool = False
    min_width_px: int = 0
    explore: bool = False


@dataclass(frozen=True)
class Figure:
    """Panels under one caption; ``label`` marks simulated data ("TWIN"), "" for hardware.

    Panels narrower than ``min_width_px`` are stacked.
    """

    panels: Sequence[Panel]
    title: str
    caption: Sequence[Any]
    label: str
    min_width_px: int = 560

    def html(self) -> Html:
        """The figure as HTML, with its panels drawn as SVG."""
        # imported here: Matplotlib takes a second, and pages without figures do not need it
        from smarig.report.drawing import NARROW_PX, WIDE_PX, WIDTH_PX, save_if_active

        usual_px = NARROW_PX if self.min_width_px <= NARROW_PX else WIDTH_PX
        widths_px = [WIDE_PX if panel.wide else usual_px for panel in self.panels]
        save_if_active(self, widths_px)
        panels = [_panel(panel, self, width_px) for panel, width_px in zip(self.panels, widths_px)]
        words = joined([part for part in self.caption if part], " ")
        caption = tag("figcaption", tag("b", self.title), " ", words)
        is_single = len(panels) == 1 and not self.panels[0].wide
        scrolls = {"tabindex": 0, "role": "group", "aria_label": self.title} if self._is_scrollable else {}
        frame = tag("div", *panels, class_="panels", style=f"--least:{self.min_width_px}px", **scrolls)
        return tag("figure", frame, caption, class_="single" if is_single else "")

    @property
    def _is_scrollable(self) -> bool:
        """Whether a panel may be wider than a small screen, so that the frame must scroll by keyboard."""
        return any(panel.wide or panel.min_width_px for panel in self.panels)


def _panel(panel: Panel, figure: Figure, width_px: int) -> Html:
    from smarig.report.drawing import svg_of

    drawn = Html(svg_of(panel, figure.label, width_px))
    data = _explored(panel, figure.label) if panel.explore else ""
    least = panel.min_width_px or (0.6 * width_px if panel.wide else 0)
    style = {"style": f"min-width:{least:.0f}px"} if least else {}
    plot = tag("div", drawn, data, class_="plot", role="img", aria_label=alt_text(panel, figure), **style)
    return tag("div", plot, class_="cell wide" if panel.wide else "cell")


def _explored(panel: Panel, label: str) -> Html:
    """The data of a panel for the interactive library, compressed."""
    layout = dict(panel.layout) | {"height": panel.height}
    if label:
        mark = WATERMARK | _watermark_position(layout) | {"text": label}
        layout["annotations"] = [*layout.get("annotations", ()), mark]
    text = json.dumps({"data": list(panel.data), "layout": layout}, allow_nan=False, ensure_ascii=False)
    packed_text = base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
    return Html(f'<script type="application/gzip" class="explored">{packed_text}</script>')


def _watermark_position(layout: Mapping[str, Any]) -> dict[str, str]:
    """The watermark's position: at the axes if axes of equal scale leave part of the paper empty."""
    framed = layout.get("xaxis", {}).get("constrain") == "domain"
    return {"xref": "x domain", "yref": "y domain"} if framed else {}


def alt_text(panel: Panel, figure: Figure) -> str:
    """The text alternative of a plot for screen readers: label, title, axes with units, and names of the traces."""
    flat = [_title(panel.layout[key]) for key in panel.layout if key.startswith("yaxis")]
    solid = panel.layout.get("scene", {})
    vertical = ", ".join(filter(None, flat)) or _title(solid.get("zaxis", {}))
    across = [
        _title(panel.layout.get("xaxis", {})),
        *(_title(solid.get(key, {})) for key in ("xaxis", "yaxis")),
    ]
    names = dict.fromkeys(trace["name"] for trace in panel.data if trace.get("name"))
    drawn = f" Drawn: {', '.join(names)}." if names else ""
    mark = f"{figure.label}, simulated. " if figure.label else ""
    return html.unescape(
        f"{mark}{figure.title} {vertical} against {' and '.join(filter(None, across))}.{drawn}"
    )


def _title(axis: Mapping[str, Any]) -> str:
    return str(axis.get("title", {}).get("text", "")).replace("<br>", " ")


def packed(values: ArrayLike, *, single: bool = False) -> dict[str, str]:
    """An array as Plotly's typed-array specification; NaN is kept. ``single`` uses single precision.

    Numbers over ``MOST_DRAWN`` become NaN: single precision ends near, and axes overflow at their distances.

    >>> packed([1.0, 2.0])["dtype"], packed([[1.0, 2.0]])["shape"]
    ('f8', '1, 2')
    """
    numbers = np.asarray(values, dtype=float)
    drawn = np.where(np.abs(numbers) <= MOST_DRAWN, numbers, np.nan)
    array = np.ascontiguousarray(drawn, dtype="<f4" if single else "<f8")
    spec = {"dtype": "f4" if single else "f8", "bdata": base64.b64encode(array.tobytes()).decode("ascii")}
    if array.ndim == 2:
        spec["shape"] = f"{array.shape[0]}, {array.shape[1]}"
    return spec


def unpacked(spec: Mapping[str, str]) -> Array:
    """The array of a typed-array specification.

    >>> unpacked(packed([[1.0, 2.0]])).tolist()
    [[1.0, 2.0]]
    """
    values = np.frombuffer(base64.b64decode(spec["bdata"]), dtype="<" + spec["dtype"])
    shape = [int(n) for n in spec["shape"].split(",")] if "shape" in spec else -1
    return values.reshape(shape)


def line(x: ArrayLike, y: ArrayLike, name: str, colour: str, **more: Any) -> Trace:
    """A line trace; ``dash`` and ``width`` style it, other keywords are Plotly's."""
    style = {"color": colour, "width": more.pop("width", 1.6), "dash": more.pop("dash", "solid")}
    return _scatter("lines", x, y, name) | {"line": style} | more


def dots(x: ArrayLike, y: ArrayLike, name: str, colour: str, **more: Any) -> Trace:
    """A marker trace; ``size`` and ``symbol`` style it, other keywords are Plotly's."""
    style = {"color": colour, "size": more.pop("size", 6), "symbol": more.pop("symbol", "circle")}
    style |= more.pop("marker", {})
    return _scatter("markers", x, y, name) | {"marker": style} | more


def _scatter(mode: str, x: ArrayLike, y: ArrayLike, name: str) -> Trace:
    return {
        "type": "scatter",
        "mode": mode,
        "x": _packed_x(x),
        "y": _packed_x(y),
        "name": str(plotly_escaped(name)),
    }


def _packed_x(values: ArrayLike) -> dict[str, str]:
    array = np.asarray(values, dtype=float)
    return packed(array, single=array.size > 500)


def error_bars(value: ArrayLike, low: ArrayLike, high: ArrayLike, **style: Any) -> dict[str, Any]:
    """Error bars from ``low`` to ``high`` about values (k,); ``style``: colour, thickness and width."""
    above, below = (np.subtract(*ends).tolist() for ends in ((high, value), (value, low)))
    return {"type": "data", "symmetric": False, "array": above, "arrayminus": below, **style}


def heat_map(
    x: Array, y: Array, z: Array, ends: tuple[float, float], scale: str, hover: str, colours: Any = DIVERGING
) -> Trace:
    """A map of z (m, n) over x (n,) and y (m,), coloured between ``ends``; ``scale``: quantity and unit."""
    return {
        "type": "heatmap",
        "x": packed(x),
        "y": packed(y),
        "z": packed(z, single=True),
        "colorscale": colours,
        "zmin": ends[0],
        "zmax": ends[1],
        "colorbar": {"title": {"text": scale, "side": "right"}, "thickness": 12},
        "hovertemplate": f"{hover}<extra></extra>",
    }


def cross(x: float, y: float, name: str, colour: str, size: float, **more: Any) -> Trace:
    """A thin cross at a point."""
    return dots(
        [x],
        [y],
        name,
        colour,
        symbol="x-thin",
        size=size,
        marker={"line": {"width": 2, "color": colour}},
        **more,
    )


def noise_band(low: float, high: float, half: float, name: str, colour: str = BAND) -> Trace:
    """A grey band of ± ``half`` from ``low`` to ``high``."""
    closed = {"width": 0, "fill": "toself", "fillcolor": colour, "hoverinfo": "skip"}
    return line([low, high, high, low, low], [-half, -half, half, half, -half], name, GREY, **closed)


def zero_line(low: float, high: float) -> Trace:
    """The line on which errors would be none."""
    return line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False)


def error_ground(x: Array, noise: float | None, name: str = "± 2 σ of the noise floor") -> list[Trace]:
    """What errors over ``x`` are drawn on: a band of ± 2 × ``noise`` where that is known, and the zero."""
    low, high = float(np.min(x)), float(np.max(x))
    return [*([noise_band(low, high, 2 * noise, name)] if noise else []), zero_line(low, high)]


def plotly_escaped(text: Any) -> Html:
    """Escaped text for a plot, because Plotly interprets markup."""
    return joined([text])


def axis(title: str, **more: Any) -> dict[str, Any]:
    """An axis with a title of quantity and unit."""
    return {"title": {"text": plotly_escaped(title)}} | more


def log_axis(title: str, low: float, high: float) -> dict[str, Any]:
    """A logarithmic axis from ``low`` to ``high`` with plain numbers at its ticks.

    >>> log_axis("rms (mm)", 0.004, 0.6)["ticktext"]
    ['0.005', '0.01', '0.02', '0.05', '0.1', '0.2', '0.5']
    """
    fine = high < 10 * low
    sizes = [m * 10.0**k for k in range(-15, 10) for m in ((1, 1.5, 2, 3, 4, 5, 6, 8) if fine else (1, 2, 5))]
    ticks = [tick for tick in sizes if low <= tick <= high]
    texts = [number(tick, 2 if fine else 1).replace(".0 ×", " ×") for tick in ticks]
    ends = [math.log10(low), math.log10(high)]
    return axis(title, type="log", range=ends, tickvals=ticks, ticktext=texts)


def figure_with_text(figure: Figure, *parts: Any) -> Html:
    """The figure at the left and the other parts at the right; below each other on narrow screens and on paper."""
    return tag("div", figure.html(), tag("div", *parts), class_="with-text")

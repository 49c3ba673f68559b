"""A plotly figure that also carries a drawing, for places where plotly is not: exported HTML, PDF, plain viewers."""

import json
from typing import Any

import plotly.graph_objects as go
from plotly.utils import PlotlyJSONEncoder

from smarig.report.components.figure import WATERMARK, Panel, Trace, unpacked
from smarig.report.components.style import template
from smarig.report.drawing import svg_of

_PLOTLY = "application/vnd.plotly.v1+json"
_TITLE_PX = 90


class NotebookFigure(go.Figure):
    """A plotly figure whose display holds the figure for plotly and an SVG drawing of the same panel.

    Viewers choose the richest form they know. The drawing shows the panel as ``smarig.plot`` made it; later changes of
    the figure appear in plotly only.
    """

    _ipython_display_: Any = None  # plotly's own would show the figure for plotly alone

    def _repr_html_(self) -> None:
        """None: plotly's own HTML loads a script from the network, and is empty without one."""

    def with_drawing(self, svg: str) -> "NotebookFigure":
        """This figure with its drawing."""
        self._svg = svg
        return self

    def _repr_mimebundle_(
        self, include: Any = None, exclude: Any = None, validate: bool = True, **options: Any
    ) -> dict[str, Any]:
        del include, exclude, validate, options
        bundle = {
            _PLOTLY: json.loads(json.dumps(self.to_plotly_json(), cls=PlotlyJSONEncoder)),
            "text/plain": "A figure of smarig",
        }
        svg = getattr(self, "_svg", "")
        return bundle | ({"image/svg+xml": svg} if svg else {})


def notebook_figure(panel: Panel, title: str, label: str) -> NotebookFigure:
    """The figure of a panel; ``label`` marks simulated data."""
    layout = {key: value for key, value in panel.layout.items() if key != "narrow"}
    layout |= {
        "template": template(),
        "title": {"text": title},
        "height": panel.height,
        "margin": {"t": _TITLE_PX},
    }
    if label:
        layout["annotations"] = [*layout.get("annotations", ()), WATERMARK | {"text": label}]
    figure = NotebookFigure([_with_arrays(trace) for trace in panel.data], layout)
    titled = Panel(panel.data, {**panel.layout, "title": {"text": title}}, panel.height)
    return figure.with_drawing(svg_of(titled, label))


def _with_arrays(trace: Trace) -> Trace:
    """A trace with its packed values converted back to arrays, for further work with the figure."""
    return {
        key: unpacked(value) if isinstance(value, dict) and "bdata" in value else value
        for key, value in trace.items()
    }

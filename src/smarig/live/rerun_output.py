"""Output of primitives to Rerun. This is the only module that imports rerun (extra ``live``).

It serves them on the loopback interface from this process, writes them to a file, or both. Nothing waits for
a viewer: the server keeps up to ``memory`` and drops the oldest data.
"""

import os
from collections.abc import Sequence
from functools import singledispatchmethod
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import MissingExtra, Severity, StorageError
from smarig.live import primitives as m
from smarig.live.colours import GROUND
from smarig.live.recording_file import RecordingFile
from smarig.live.view_layout import Split, View

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError:
    raise MissingExtra("The live view", "live") from None

APPLICATION = "smarig"
TIMELINE = "device_time"
TRAIL_S = 1200.0
SCROLL_S = 300.0
_LEVELS = {  # of Rerun's text log, by severity
    Severity.NONE: "INFO",
    Severity.MINOR: "WARN",
    Severity.MAJOR: "ERROR",
    Severity.INVALID: "CRITICAL",
}


class RerunOutput:
    """An output for primitives. ``serve`` and ``save`` choose where they go."""

    def __init__(self, name: str) -> None:
        self._stream = rr.RecordingStream(APPLICATION)
        self._stream.send_recording_name(name)
        self._sinks: list[Any] = []
        self._files: list[RecordingFile] = []

    def serve(self, port: int, memory: str) -> None:
        """Serve viewers on this machine that connect to ``port``, now or later."""
        self._to(rr.GrpcServerSink("127.0.0.1", port, server_memory_limit=memory))

    def save(self, path: Path) -> None:
        """Write into a file as the data come; ``flush`` and ``close`` say whether that fails."""
        if os.name == "nt":  # has no such pipes
            self._to(rr.FileSink(path))
            return
        self._files.append(RecordingFile(path))
        self._to(rr.FileSink(self._files[-1].pipe))
        self._files[-1].writer_opened()

    def _to(self, sink: Any) -> None:
        self._sinks.append(sink)
        self._stream.set_sinks(*self._sinks)

    def arrange(self, layout: Split, *, replay: bool = False) -> None:
        """Arrange the views. A replay shows all of its time, a live view the last minutes."""
        panel = rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following")
        blueprint = rrb.Blueprint(_part(layout, replay), panel, collapse_panels=True, auto_views=False)
        self._stream.send_blueprint(blueprint)

    def show(self, primitives: Sequence[m.Primitive]) -> None:
        """Draw primitives."""
        for primitive in primitives:
            self._draw(primitive)

    def flush(self) -> None:
        """Send the remaining data. Raises StorageError or OSError if that fails."""
        try:
            self._stream.flush()
        except RuntimeError as error:
            raise StorageError(f"The recording could not be written: {error}.") from None
        for file in self._files:
            file.check()

    def close(self) -> None:
        """Send the remaining data, complete files and close all outputs. Raises as ``flush`` does."""
        try:
            self.flush()
        finally:
            self._stream.disconnect()
            for file in self._files:
                file.close()

    # --- one method for each kind of primitive
    # -------------------------------------------------------------------

    def _columns(self, path: str, times_s: m.Array, columns: Any) -> None:
        self._stream.send_columns(path, [rr.TimeColumn(TIMELINE, duration=times_s)], columns)

    def _always(self, path: str, what: Any) -> None:
        self._stream.log(path, what, static=True)

    @singledispatchmethod
    def _draw(self, primitive: Any) -> None:
        raise TypeError(f"cannot draw {primitive!r}")

    @_draw.register
    def _(self, primitive: m.SeriesLegend) -> None:
        widths = list(primitive.widths_px) or [1.6] * len(primitive.names)
        self._always(
            primitive.path, rr.SeriesLines(names=primitive.names, colors=primitive.colours, widths=widths)
        )

    @_draw.register
    def _(self, primitive: m.TimeSeries) -> None:
        values = rr.Scalars.columns(scalars=primitive.values.ravel())
        self._columns(
            primitive.path,
            primitive.times_s,
            values.partition([primitive.values.shape[1]] * len(primitive.times_s)),
        )

    @_draw.register
    def _(self, primitive: m.Polylines) -> None:
        flat = primitive.strips[0].shape[1] == 2
        kind: Any = rr.LineStrips2D if flat else rr.LineStrips3D
        style: dict[str, Any] = {"radii": rr.Radius.ui_points(primitive.width_px / 2)}
        style |= {"draw_order": primitive.draw_order} if flat else {}
        if primitive.times_s is None:
            hues = list(primitive.colours) or None  # fixed colours would hide colours that change
            self._always(primitive.path, kind(list(primitive.strips), colors=hues, **style))
            return
        several = {"colors": list(primitive.colours)} if not flat else {}
        style |= {} if several else {"colors": primitive.colours[0]}
        self._always(primitive.path, kind.from_fields(**style))
        self._columns(
            primitive.path, primitive.times_s, kind.columns(strips=list(primitive.strips), **several)
        )

    @_draw.register
    def _(self, primitive: m.ColourChanges) -> None:
        self._columns(
            primitive.path, primitive.times_s, rr.LineStrips3D.columns(colors=list(primitive.colours))
        )

    @_draw.register
    def _(self, primitive: m.Points) -> None:
        flat = primitive.points.shape[1] == 2
        kind: Any = rr.Points2D if flat else rr.Points3D
        style: dict[str, Any] = {
            "colors": primitive.colour,
            "radii": rr.Radius.ui_points(primitive.radius_px),
        }
        style |= {"draw_order": primitive.draw_order} if flat else {}
        style |= {"labels": list(primitive.texts), "show_labels": True} if primitive.texts else {}
        if primitive.times_s is None:
            self._always(primitive.path, kind(primitive.points, **style))
            return
        self._always(primitive.path, kind.from_fields(**style))
        self._columns(primitive.path, primitive.times_s, kind.columns(positions=primitive.points))

    @_draw.register
    def _(self, primitive: m.Pixels) -> None:
        picture = rr.Image(
            primitive.pixels, color_model="RGB", draw_order=-30.0, magnification_filter="linear"
        )
        self._always(primitive.path, picture)

    @_draw.register
    def _(self, primitive: m.Transform) -> None:
        if primitive.times_s is None:
            self._always(
                primitive.path, rr.Transform3D(translation=primitive.shift[0], scale=primitive.scale)
            )
            return
        turned = {}
        if primitive.turn_rad is not None:
            half, zero = primitive.turn_rad / 2, np.zeros(len(primitive.turn_rad))
            turned = {"quaternion": np.c_[zero, zero, np.sin(half), np.cos(half)]}
        self._columns(
            primitive.path, primitive.times_s, rr.Transform3D.columns(translation=primitive.shift, **turned)
        )

    @_draw.register
    def _(self, primitive: m.SolidBody) -> None:
        common: dict[str, Any] = {
            "centers": [primitive.centre],
            "colors": primitive.colour,
            "fill_mode": "solid",
        }
        if primitive.shape == "box":
            body: Any = rr.Boxes3D(sizes=[primitive.size], **common)
        else:
            body = rr.Cylinders3D(radii=[primitive.size[0]], lengths=[primitive.size[2]], **common)
        self._always(primitive.path, body)

    @_draw.register
    def _(self, primitive: m.StateLane) -> None:
        self._columns(primitive.path, primitive.times_s, rr.StateChange.columns(state=list(primitive.states)))

    @_draw.register
    def _(self, primitive: m.StateLegend) -> None:
        hues = [(*c, 255) for c in primitive.colours.values()]
        self._always(primitive.path, rr.StateConfiguration(values=list(primitive.colours), colors=hues))

    @_draw.register
    def _(self, primitive: m.TextLog) -> None:
        levels = [_LEVELS[severity] for severity in primitive.severities]
        self._columns(
            primitive.path, primitive.times_s, rr.TextLog.columns(text=list(primitive.texts), level=levels)
        )

    @_draw.register
    def _(self, primitive: m.TextPage) -> None:
        self._always(primitive.path, rr.TextDocument(primitive.text, media_type="text/markdown"))


def viewer_state(url: str) -> dict[str, Any]:
    """The state of a viewer at ``url``: names of its views, their error messages, and the start time of each
    recording."""
    from rerun.experimental import ViewerClient

    state = ViewerClient.connect(url).get_state()
    times = [t for r in state.recordings for t in r.timelines if t.name == TIMELINE]
    return {
        "views": {view.name: view.view_class for view in state.views},
        "complaints": [str(report) for view in state.views for report in view.reports],
        "begins_s": [t.start / 1e9 for t in times if t.start is not None],
        "ends_s": [t.end / 1e9 for t in times if t.end is not None],
    }


def save_screenshot_of(url: str, path: Path, at_s: float | None = None) -> None:
    """Save an image of a headless viewer's contents at a time of the run."""
    from rerun.experimental import ViewerClient

    viewer = ViewerClient.connect(url)
    if at_s is not None:
        viewer.set_time(TIMELINE, duration=float(at_s))
    viewer.save_screenshot(str(path))


def _part(part: Split | View, replay: bool) -> Any:
    if isinstance(part, Split):
        parts = [_part(p, replay) for p in part.parts]
        if part.arrangement == "tabs":
            return rrb.Tabs(*parts)
        if part.arrangement == "rows":
            return rrb.Vertical(*parts, row_shares=list(part.shares))
        return rrb.Horizontal(*parts, column_shares=list(part.shares))
    return _VIEWS[part.kind](part, replay)


def _range(seconds: float) -> Any:
    now = rr.TimeRangeBoundary.cursor_relative(seconds=0.0)
    return rrb.VisibleTimeRanges(
        timeline=TIMELINE, start=rr.TimeRangeBoundary.cursor_relative(seconds=-seconds), end=now
    )


def _plane(view: View, replay: bool) -> Any:
    del replay
    x, y = view.bounds or ((0.0, 1.0), (0.0, 1.0))
    return rrb.Spatial2DView(
        origin=view.origin,
        name=view.name,
        background=GROUND,
        visual_bounds=rrb.VisualBounds2D(x_range=x, y_range=y),
        overrides={trail: [_range(TRAIL_S)] for trail in view.trails},
    )


def _space(view: View, replay: bool) -> Any:
    del replay
    position, target = view.camera or ((0.0, 0.0, 300.0), (0.0, 0.0, 0.0))
    return rrb.Spatial3DView(
        origin=view.origin,
        name=view.name,
        background=GROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(position=position, look_target=target, eye_up=(0.0, 1.0, 0.0)),
    )


def _time(view: View, replay: bool) -> Any:
    return rrb.TimeSeriesView(
        origin=view.origin,
        name=view.name,
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=view.legend),
        axis_x=_axis(replay),
        axis_y=rrb.ScalarAxis(range=view.range, zoom_lock=True) if view.range else None,
    )


def _axis(replay: bool) -> Any:
    """The time range: all of a recorded run, or the last minutes of a running one."""
    first = (
        rr.TimeRangeBoundary.infinite() if replay else rr.TimeRangeBoundary.cursor_relative(seconds=-SCROLL_S)
    )
    last = rr.TimeRangeBoundary.infinite() if replay else rr.TimeRangeBoundary.cursor_relative(seconds=0.0)
    return rrb.TimeAxis(view_range=rr.TimeRange(start=first, end=last))


def _log(view: View, replay: bool) -> Any:
    del replay
    columns = rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["loglevel", "body"])
    return rrb.TextLogView(origin=view.origin, name=view.name, columns=columns)


_VIEWS: dict[str, Any] = {
    "plane": _plane,
    "space": _space,
    "time": _time,
    "lanes": lambda view, replay: rrb.StateTimelineView(
        origin=view.origin, name=view.name, time_view=_axis(replay)
    ),
    "log": _log,
    "page": lambda view, _: rrb.TextDocumentView(origin=view.origin, name=view.name),
}

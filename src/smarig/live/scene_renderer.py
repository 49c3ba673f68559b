"""Conversion of batches of items into the primitives of the live view.

Scalars are drawn for every sample. Shapes (trail, boundary, the rig's body) are redrawn only after a move of
more than 1/``STILL_FRACTION`` of the range and more than noise. A hold of ten minutes therefore costs
nothing, and recordings stay small.
"""

from collections.abc import Callable, Sequence

import numpy as np

from smarig.core import Severity
from smarig.live import colours
from smarig.live.display_info import DisplayInfo, description_markdown, widened_axis
from smarig.live.live_items import EventItem, LiveItem, SampleItem, StepItem
from smarig.live.mechanism import Mechanism
from smarig.live.plot_axes import Axis, Plot
from smarig.live.preisach_plane import boundary, density, density_image
from smarig.live.primitives import (
    Array,
    Pixels,
    Points,
    Polylines,
    Primitive,
    SeriesLegend,
    TextLog,
    TextPage,
    TimeSeries,
    Transform,
)
from smarig.live.state_lanes import SettlingMonitor, StateTracker
from smarig.live.view_layout import Split, layout
from smarig.preisach import Everett, RelayMeasure
from smarig.replay import HysteresisPredictor, NamedPredictor, ZeroedPredictor

STILL_FRACTION = 300
NOISE_COUNTS = 2.5  # smaller moves are noise of the encoder
COUNTDOWN_STRIDE = 5  # samples between points of a straight line
NAN = float("nan")
ShowPrimitives = Callable[[Sequence[Primitive]], None]


class SceneRenderer:
    """Renders batches: ``draw(items, lost)``, after ``opening`` and ``layout``.

    ``hysteresis`` gives the map of the plane; with None only the boundary is drawn.
    """

    def __init__(
        self,
        display_info: DisplayInfo,
        show: ShowPrimitives,
        predictions: Sequence[NamedPredictor] = (),
        hysteresis: Everett | None = None,
    ) -> None:
        self.display_info, self._show = display_info, show
        self._names = tuple(p.name for p in predictions)
        self._models = [ZeroedPredictor(p.predictor) for p in predictions]
        self._map = hysteresis
        plane_hysteresis = hysteresis or RelayMeasure.zero(display_info.input.low, display_info.input.high)
        self._memory = HysteresisPredictor(plane_hysteresis, display_info.initial)
        self.graph = Plot("graph", display_info.input, display_info.output)
        beta, alpha = (
            Axis(f"{name} ({display_info.input_unit})", plane_hysteresis.lower, plane_hysteresis.upper)
            for name in "βα"
        )
        self.plane = Plot("plane", beta, alpha, width=1.0)
        self._mechanism = (
            Mechanism(display_info.actuator, display_info.label) if display_info.actuator else None
        )
        self._settling_monitor = _settling_monitor(display_info)
        self._states = StateTracker()
        self._last_frame: tuple[float, ...] | None = None
        self._trail_ends: list[Array] = []  # end points of the trails so far

    @property
    def layout(self) -> Split:
        """The arrangement of the views."""
        return layout(self.display_info, self.graph, self.plane, len(self._models))

    # --- drawn before the first sample
    # --------------------------------------------------------------------------

    def opening(self) -> list[Primitive]:
        """Axes, legends, the map, the rig's body and the page of text."""
        primitives = [
            *self.graph.primitives(),
            *self._plane_primitives(),
            *self._legends(),
            *self._states.legends(),
        ]
        primitives.append(
            TextPage(
                "about/page", description_markdown(self.display_info, self._names, self._map is not None)
            )
        )
        primitives += self._mechanism.body() if self._mechanism else []
        return [*primitives, *self._badges()]

    def _badges(self) -> list[Primitive]:
        """The twin's label in each plane."""
        text = self.display_info.label
        if not text:
            return []
        return [
            Points(
                f"{p.path}/source",
                None,
                np.array([[p.width - 0.09, -p.height - 0.1]]),
                colours.AMBER,
                texts=(text,),
            )
            for p in (self.graph, self.plane)
        ]

    def _plane_primitives(self) -> list[Primitive]:
        p = self.plane
        corner = np.array([[p.x.low, p.x.low], [p.x.high, p.x.high]])
        primitives = [*p.primitives(grid=self._map is None)]
        primitives.append(Polylines(f"{p.inside}/diagonal", None, [corner], [colours.GREY], 1.0, -5.0))
        h = self._map
        if h is not None:
            mu = density(h)
            step = (h.upper - h.lower) / len(mu)
            shift = np.array([[h.lower, h.lower, 0.0]])
            primitives += [
                Transform(f"{p.inside}/map", None, shift, scale=(step, step, 1.0)),
                Pixels(f"{p.inside}/map", density_image(mu)),
            ]
        return primitives

    def _legends(self) -> list[Primitive]:
        c, u = colours, self.display_info.input_unit
        models = tuple(c.model_colour(k) for k in range(len(self._names)))
        primitives: list[Primitive] = [
            SeriesLegend(
                "position", ("measured", *self._names), (c.MEASURED, *models), (3.0, *[1.2] * len(models))
            ),
            SeriesLegend(
                "temperature",
                ("heating model" if self.display_info.actuator else f"input ({u})",),
                (c.TEMPERATURE,),
            ),
            SeriesLegend("current", ("commanded", "measured"), (c.GREY, c.ORANGE)),
            SeriesLegend("voltage", ("voltage",), (c.PURPLE,)),
            SeriesLegend("resistance", ("voltage / current",), (c.GREEN,)),
        ]
        if models:
            primitives.append(SeriesLegend("residual", self._names, models))
        if self._settling_monitor:
            primitives.append(SeriesLegend("settling/counts", ("off the mean",), (c.MEASURED,)))
            primitives.append(SeriesLegend("settling/band", ("band", "band"), (c.GREEN, c.GREEN)))
            primitives.append(SeriesLegend("countdown", ("at least",), (c.ORANGE,)))
        return primitives

    # --- drawn for each batch
    # -----------------------------------------------------------------------------------

    def draw(self, items: Sequence[LiveItem], lost: int = 0) -> None:
        """Draw a batch. ``lost`` items were dropped before it, so the memory of the models is unknown
        afterwards."""
        primitives: list[Primitive] = []
        if lost:
            for predictor in (*self._models, self._memory):
                predictor.invalidate()
            first = _time_of(items[0])
            text = f"{lost} items were too many for the viewer and are not shown. The record is complete."
            primitives.append(TextLog("log", np.array([first]), (text,), (Severity.MINOR,)))
        run: list[SampleItem] = []
        for item in items:
            if isinstance(item, SampleItem):
                run.append(item)
            elif isinstance(item, EventItem) and item.kind == "zero":
                primitives += self._samples(run)
                run = []
                for model in self._models:
                    model.zeroed()
        primitives += self._samples(run)
        events = [i for i in items if isinstance(i, EventItem)]
        if events:
            texts = tuple(f"{i.kind}: {i.text}" for i in events)
            primitives.append(
                TextLog("log", np.array([i.t_s for i in events]), texts, tuple(i.severity for i in events))
            )
        primitives += self._states.after(items)
        points = [
            i for i in items if isinstance(i, StepItem) and i.target is not None and i.position is not None
        ]
        if points:
            at = np.array([(p.target, p.position) for p in points], dtype=float)
            times = np.array([p.t_s for p in points])
            primitives.append(
                Points(f"{self.graph.inside}/settled", times, at, colours.INK, 3.0, draw_order=5.0)
            )
        self._show(primitives)

    def _samples(self, run: Sequence[SampleItem]) -> list[Primitive]:
        if not run:
            return []
        data = np.array([t.sample for t in run], dtype=float)
        u = np.array([t.input_value for t in run], dtype=float)
        times, command, current, voltage, y = (data[:, k] for k in (1, 2, 3, 4, 7))
        if not np.isfinite(times).any():
            times = data[:, 0]  # data without time: their running tick
        followed, frames, states, settling = self._follow_models(run)
        with np.errstate(divide="ignore", invalid="ignore"):
            resistance = np.where(np.abs(current) > 0.05, voltage / current, NAN)
        primitives: list[Primitive] = [
            TimeSeries("position", times, np.c_[y, followed]),
            TimeSeries("temperature", times, u[:, None]),
            TimeSeries("current", times, np.c_[command, current]),
        ]
        for path, values in (("voltage", voltage), ("resistance", resistance)):
            primitives += [TimeSeries(path, times, values[:, None])] if np.isfinite(values).any() else []
        if self._models:
            primitives.append(TimeSeries("residual", times, y[:, None] - followed))
        if self._settling_monitor:
            ends, half = times[[0, -1]], self._settling_monitor.band_counts / 2
            primitives.append(TimeSeries("settling/counts", times, settling[:, :1]))
            primitives.append(TimeSeries("settling/band", ends, np.array([[half, -half]] * 2)))
            primitives.append(
                TimeSeries("countdown", times[::COUNTDOWN_STRIDE], settling[::COUNTDOWN_STRIDE, 1:])
            )
        primitives += self._widened_axes(u, y)
        if frames:
            primitives += self._draw_frames(times[frames], u[frames], np.c_[y, followed][frames], states)
        return primitives

    def _follow_models(self, run: Sequence[SampleItem]) -> tuple[Array, list[int], list[Array], Array]:
        """Outputs of the models (n, m), samples to draw as shapes, boundaries there, and settling of holds
        (n, 2)."""
        outputs = np.empty((len(run), len(self._models)))
        settling = np.full((len(run), 2), NAN)
        frames: list[int] = []
        states: list[Array] = []
        small_u = (self.graph.x.high - self.graph.x.low) / STILL_FRACTION
        small_y = max(
            (self.graph.y.high - self.graph.y.low) / STILL_FRACTION,
            NOISE_COUNTS * (self.display_info.per_count or 0.0),
        )
        for k, (s, step, u) in enumerate(run):
            for j, model in enumerate(self._models):
                outputs[k, j] = model.after(s, u)
            self._memory.after(s, u)
            if self._settling_monitor:
                settling[k] = self._settling_monitor.after(s, step, u)
            last = self._last_frame
            if (
                u == u
                and s.position == s.position
                and (last is None or abs(u - last[0]) > small_u or abs(s.position - last[1]) > small_y)
            ):
                frames.append(k)
                self._last_frame = (u, s.position)
                states.append(self._boundary())
        return outputs, frames, states, settling

    def _boundary(self) -> Array:
        state, x = self._memory.state, self.plane.x
        h = self._memory.operator.hysteresis
        return boundary(state, h.lower, h.upper) if state else np.array([[x.low, x.low]] * 2)

    def _draw_frames(
        self, times: Array, u: Array, outputs: Array, boundaries: Sequence[Array]
    ) -> list[Primitive]:
        """Trails since the last frame, the present point, the boundary, and the rig."""
        inside, c = self.graph.inside, colours
        primitives: list[Primitive] = []
        places = [np.c_[u, outputs[:, j]] for j in range(outputs.shape[1])]
        names = ["measured", *(f"model_{k}" for k in range(len(self._models)))]
        model_colours = [c.MEASURED, *(c.model_colour(k) for k in range(len(self._models)))]
        ends = self._trail_ends or [p[:1] for p in places]
        for name, colour, place, end in zip(names, model_colours, places, ends, strict=True):
            path = np.vstack([end, place])
            segments = [path[k : k + 2] for k in range(len(place))]
            known = [k for k, s in enumerate(segments) if np.isfinite(s).all()]
            if known:
                chosen = [segments[k] for k in known]
                draw_order = 2.0 if name == "measured" else 3.0
                width = (
                    3.5 if name == "measured" else 1.4
                )  # the model is drawn over the data so that both are visible
                primitives.append(
                    Polylines(
                        f"{inside}/{name}", times[known], chosen, [colour] * len(known), width, draw_order
                    )
                )
        self._trail_ends = [p[-1:] for p in places]
        primitives.append(Points(f"{inside}/now", times, places[0], c.AMBER, 5.0, draw_order=9.0))
        primitives.append(
            Polylines(f"{self.plane.inside}/boundary", times, boundaries, [c.INK] * len(times), 2.4, 5.0)
        )
        primitives.append(
            Points(f"{self.plane.inside}/now", times, np.c_[u, u], c.AMBER, 5.0, draw_order=9.0)
        )
        if self._mechanism:
            primitives += self._mechanism.moved(times, outputs[:, 0], u)
        return primitives

    def _widened_axes(self, u: Array, y: Array) -> list[Primitive]:
        """New axes if the data leave the old ones."""
        if not (np.isfinite(u).any() and np.isfinite(y).any()):
            return []
        x_axis = widened_axis(self.graph.x, float(np.nanmin(u)), float(np.nanmax(u)))
        y_axis = widened_axis(self.graph.y, float(np.nanmin(y)), float(np.nanmax(y)))
        if (x_axis, y_axis) == (self.graph.x, self.graph.y):
            return []
        self.graph = Plot("graph", x_axis, y_axis)
        return self.graph.primitives()


def _settling_monitor(of: DisplayInfo) -> SettlingMonitor | None:
    """A monitor of settling, if the noise and the rule are known."""
    if of.settling_rule is None or of.actuator is None or of.period_s is None:
        return None
    return SettlingMonitor(of.settling_rule, of.actuator, of.period_s)


def _time_of(item: LiveItem) -> float:
    return item.sample.t_s if isinstance(item, SampleItem) else item.t_s

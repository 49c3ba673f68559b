"""Batches of what was seen become marks: the one place that knows what a live view shows.

Scalars are drawn sample by sample. What has a shape (trail, boundary, the rig's body) is drawn anew only where
something moved by a ``STILL``-th of its range and by more than noise: a hold of ten minutes costs nothing, and a
recording stays small.
Knows no viewer and no thread.
"""

from collections.abc import Callable, Sequence

import numpy as np

from smarig.live import colours
from smarig.live.axes import Axis, Plot
from smarig.live.lanes import Lanes
from smarig.live.layout import Split, layout
from smarig.live.marks import Array, Dots, Legend, Mark, Page, Picture, Placed, Said, Series, Strips
from smarig.live.mechanism import Mechanism
from smarig.live.plane import boundary, density, picture
from smarig.live.predicted import Memory, Prediction, Zeroed
from smarig.live.seen import Seen, Stepped, Ticked, Told
from smarig.live.subject import Subject, wider
from smarig.live.waiting import Waiting
from smarig.live.words import about
from smarig.preisach.everett import Everett
from smarig.preisach.relay_measure import RelayMeasure

STILL = 300
NOISE_COUNTS = 2.5  # less is the encoder's noise, not a move
SELDOM = 5  # samples between points of what is a straight line
NAN = float("nan")
Show = Callable[[Sequence[Mark]], None]


class Drawer:
    """``draw(items, lost)`` shows a batch; ``opening`` and ``layout`` come first.

    ``hysteresis`` is what the plane's map is of, None for the boundary alone.
    """

    def __init__(
        self,
        subject: Subject,
        show: Show,
        predictions: Sequence[Prediction] = (),
        hysteresis: Everett | None = None,
    ) -> None:
        self.subject, self._show = subject, show
        self._names = tuple(p.name for p in predictions)
        self._models = [Zeroed(p.follower) for p in predictions]
        self._map = hysteresis
        of_plane = hysteresis or RelayMeasure.silent(subject.input.low, subject.input.high)
        self._memory = Memory(of_plane, subject.initial)
        self.graph = Plot("graph", subject.input, subject.output)
        beta, alpha = (
            Axis(f"{name} ({subject.input_unit})", of_plane.lower, of_plane.upper) for name in "βα"
        )
        self.plane = Plot("plane", beta, alpha, width=1.0)
        self._mechanism = Mechanism(subject.actuator, subject.label) if subject.actuator else None
        self._waiting = _waiting(subject)
        self._lanes = Lanes()
        self._framed: tuple[float, ...] | None = None
        self._ends: list[Array] = []  # where the trails have come to

    @property
    def layout(self) -> Split:
        """Of the views."""
        return layout(self.subject, self.graph, self.plane, len(self._models))

    # --- what is there before the first sample ---------------------------------------------------------------

    def opening(self) -> list[Mark]:
        """Axes, legends, the map, the rig's body, what is shown in words."""
        marks = [*self.graph.marks(), *self._of_plane(), *self._legends(), *self._lanes.legends()]
        marks.append(Page("about/page", about(self.subject, self._names, self._map is not None)))
        marks += self._mechanism.body() if self._mechanism else []
        return [*marks, *self._badges()]

    def _badges(self) -> list[Mark]:
        """The twin's label, in each plane."""
        text = self.subject.label
        if not text:
            return []
        return [
            Dots(
                f"{p.path}/source",
                None,
                np.array([[p.width - 0.09, -p.height - 0.1]]),
                colours.AMBER,
                texts=(text,),
            )
            for p in (self.graph, self.plane)
        ]

    def _of_plane(self) -> list[Mark]:
        p = self.plane
        corner = np.array([[p.x.low, p.x.low], [p.x.high, p.x.high]])
        marks = [*p.marks(grid=self._map is None)]
        marks.append(Strips(f"{p.inside}/diagonal", None, [corner], [colours.GREY], 1.0, -5.0))
        h = self._map
        if h is not None:
            mu = density(h)
            step = (h.upper - h.lower) / len(mu)
            shift = np.array([[h.lower, h.lower, 0.0]])
            marks += [
                Placed(f"{p.inside}/map", None, shift, scale=(step, step, 1.0)),
                Picture(f"{p.inside}/map", picture(mu)),
            ]
        return marks

    def _legends(self) -> list[Mark]:
        c, u = colours, self.subject.input_unit
        models = tuple(c.model_colour(k) for k in range(len(self._names)))
        marks: list[Mark] = [
            Legend(
                "position", ("measured", *self._names), (c.MEASURED, *models), (3.0, *[1.2] * len(models))
            ),
            Legend(
                "temperature",
                ("heating model" if self.subject.actuator else f"input ({u})",),
                (c.TEMPERATURE,),
            ),
            Legend("current", ("commanded", "measured"), (c.GREY, c.ORANGE)),
            Legend("voltage", ("voltage",), (c.PURPLE,)),
            Legend("resistance", ("voltage / current",), (c.GREEN,)),
        ]
        if models:
            marks.append(Legend("residual", self._names, models))
        if self._waiting:
            marks.append(Legend("settling/counts", ("off the mean",), (c.MEASURED,)))
            marks.append(Legend("settling/band", ("band", "band"), (c.GREEN, c.GREEN)))
            marks.append(Legend("countdown", ("at least",), (c.ORANGE,)))
        return marks

    # --- what comes --------------------------------------------------------------------------------------------

    def draw(self, items: Sequence[Seen], lost: int = 0) -> None:
        """Show a batch; ``lost`` were dropped before it, so that no model knows what it remembers."""
        marks: list[Mark] = []
        if lost:
            for follower in (*self._models, self._memory):
                follower.forget()
            first = _time_of(items[0])
            text = f"{lost} items were too many for the viewer and are not shown; the record has them all."
            marks.append(Said("log", np.array([first]), (text,), ("warning",)))
        run: list[Ticked] = []
        for item in items:
            if isinstance(item, Ticked):
                run.append(item)
            elif isinstance(item, Told) and item.kind == "zero":
                marks += self._samples(run)
                run = []
                for model in self._models:
                    model.zeroed()
        marks += self._samples(run)
        told = [i for i in items if isinstance(i, Told)]
        if told:
            texts = tuple(f"{i.kind}: {i.text}" for i in told)
            marks.append(Said("log", np.array([i.t_s for i in told]), texts, tuple(i.level for i in told)))
        marks += self._lanes.after(items)
        points = [
            i for i in items if isinstance(i, Stepped) and i.target is not None and i.position is not None
        ]
        if points:
            at = np.array([(p.target, p.position) for p in points], dtype=float)
            times = np.array([p.t_s for p in points])
            marks.append(Dots(f"{self.graph.inside}/settled", times, at, colours.INK, 3.0, front=5.0))
        self._show(marks)

    def _samples(self, run: Sequence[Ticked]) -> list[Mark]:
        if not run:
            return []
        data = np.array([t.sample for t in run], dtype=float)
        u = np.array([t.input_value for t in run], dtype=float)
        times, command, current, voltage, y = (data[:, k] for k in (1, 2, 3, 4, 7))
        if not np.isfinite(times).any():
            times = data[:, 0]  # data without time: its running tick
        followed, frames, states, off = self._followed(run)
        with np.errstate(divide="ignore", invalid="ignore"):
            resistance = np.where(np.abs(current) > 0.05, voltage / current, NAN)
        marks: list[Mark] = [
            Series("position", times, np.c_[y, followed]),
            Series("temperature", times, u[:, None]),
            Series("current", times, np.c_[command, current]),
        ]
        for path, values in (("voltage", voltage), ("resistance", resistance)):
            marks += [Series(path, times, values[:, None])] if np.isfinite(values).any() else []
        if self._models:
            marks.append(Series("residual", times, y[:, None] - followed))
        if self._waiting:
            ends, half = times[[0, -1]], self._waiting.band_counts / 2
            marks.append(Series("settling/counts", times, off[:, :1]))
            marks.append(Series("settling/band", ends, np.array([[half, -half]] * 2)))
            marks.append(Series("countdown", times[::SELDOM], off[::SELDOM, 1:]))
        marks += self._widened(u, y)
        if frames:
            marks += self._frames(times[frames], u[frames], np.c_[y, followed][frames], states)
        return marks

    def _followed(self, run: Sequence[Ticked]) -> tuple[Array, list[int], list[Array], Array]:
        """Models' outputs (n, m), which samples are drawn as shapes, boundaries there, and how holds settle (n, 2)."""
        outputs = np.empty((len(run), len(self._models)))
        off = np.full((len(run), 2), NAN)
        frames: list[int] = []
        states: list[Array] = []
        small_u = (self.graph.x.high - self.graph.x.low) / STILL
        small_y = max(
            (self.graph.y.high - self.graph.y.low) / STILL, NOISE_COUNTS * (self.subject.per_count or 0.0)
        )
        for k, (s, step, u) in enumerate(run):
            for j, model in enumerate(self._models):
                outputs[k, j] = model.after(s, u)
            self._memory.after(s, u)
            if self._waiting:
                off[k] = self._waiting.after(s, step, u)
            last = self._framed
            if (
                u == u
                and s.position == s.position
                and (last is None or abs(u - last[0]) > small_u or abs(s.position - last[1]) > small_y)
            ):
                frames.append(k)
                self._framed = (u, s.position)
                states.append(self._boundary())
        return outputs, frames, states, off

    def _boundary(self) -> Array:
        state, x = self._memory.state, self.plane.x
        h = self._memory.operator.hysteresis
        return boundary(state, h.lower, h.upper) if state else np.array([[x.low, x.low]] * 2)

    def _frames(self, times: Array, u: Array, outputs: Array, boundaries: Sequence[Array]) -> list[Mark]:
        """Trails (from the last frame on), the point that is now, the boundary, the rig."""
        inside, c = self.graph.inside, colours
        marks: list[Mark] = []
        places = [np.c_[u, outputs[:, j]] for j in range(outputs.shape[1])]
        names = ["measured", *(f"model_{k}" for k in range(len(self._models)))]
        hues = [c.MEASURED, *(c.model_colour(k) for k in range(len(self._models)))]
        ends = self._ends or [p[:1] for p in places]
        for name, hue, place, end in zip(names, hues, places, ends, strict=True):
            path = np.vstack([end, place])
            segments = [path[k : k + 2] for k in range(len(place))]
            known = [k for k, s in enumerate(segments) if np.isfinite(s).all()]
            if known:
                chosen = [segments[k] for k in known]
                front = 2.0 if name == "measured" else 3.0
                width = 3.5 if name == "measured" else 1.4  # the model is drawn over the data, both are seen
                marks.append(
                    Strips(f"{inside}/{name}", times[known], chosen, [hue] * len(known), width, front)
                )
        self._ends = [p[-1:] for p in places]
        marks.append(Dots(f"{inside}/now", times, places[0], c.AMBER, 5.0, front=9.0))
        marks.append(
            Strips(f"{self.plane.inside}/boundary", times, boundaries, [c.INK] * len(times), 2.4, 5.0)
        )
        marks.append(Dots(f"{self.plane.inside}/now", times, np.c_[u, u], c.AMBER, 5.0, front=9.0))
        if self._mechanism:
            marks += self._mechanism.moved(times, outputs[:, 0], u)
        return marks

    def _widened(self, u: Array, y: Array) -> list[Mark]:
        """New axes where the data leave the old ones."""
        if not (np.isfinite(u).any() and np.isfinite(y).any()):
            return []
        x_axis = wider(self.graph.x, float(np.nanmin(u)), float(np.nanmax(u)))
        y_axis = wider(self.graph.y, float(np.nanmin(y)), float(np.nanmax(y)))
        if (x_axis, y_axis) == (self.graph.x, self.graph.y):
            return []
        self.graph = Plot("graph", x_axis, y_axis)
        return self.graph.marks()


def _waiting(of: Subject) -> Waiting | None:
    """Who watches holds come to rest, where anything is known of them."""
    if of.until is None or of.actuator is None or of.period_s is None:
        return None
    return Waiting(of.until, of.actuator, of.period_s)


def _time_of(item: Seen) -> float:
    return item.sample.t_s if isinstance(item, Ticked) else item.t_s

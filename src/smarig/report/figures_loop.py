"""A closed loop over time and over the input: wanted against measured, error in counts, current, temperature.

Knows runs and what their loops did; refuses to know controllers and models.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control.tracking.measures import WITHIN_COUNTS
from smarig.record import Run
from smarig.report.closed_loop import Regulated, Stretch, TrackedRun
from smarig.report.conditions import count_size, exact_unit, input_title, label_of, output_title, place
from smarig.report.decimate import POINTS, envelope, path
from smarig.report.figure import Figure, Panel, Trace, axis, line
from smarig.report.figures_hysteresis import travel
from smarig.report.figures_regulation import B_ELL
from smarig.report.figures_time import time_unit
from smarig.report.html import joined
from smarig.report.numbers import number
from smarig.report.style import CURRENT, GREY, INK, POSITION, TEMPERATURE

Array = NDArray[np.float64]
_ROWS = ("y", "y2", "y3", "y4")
_SHARES = (0.34, 0.26, 0.18, 0.22)  # of the height, from above
_MOST_COUNTS = 12.0  # the error's row shows at least the band, at most so many counts either way
BAND = "rgba(107,114,128,.18)"


def tracking_figure(run: Run, found: TrackedRun) -> Figure:
    """Wanted and measured position, the error with the ± 2-count band, current and predicted temperature."""
    f, words = found.figures, ""
    unit = exact_unit(run.unit)
    if f is not None:
        after = f" from {found.skip_s:g} s on" if found.skip_s else ""
        words = f"Error {number(f.rms)} {unit} rms, {number(f.largest)} {unit} at most{after}, n = {f.n}."
    data, layout, cut = _over_time(run, found.loop)
    return Figure(
        [Panel(data, layout, 720)],
        f"Controller {found.controller} along the reference {found.reference.name}.",
        [words, _band_words(found.loop, cut), place(run)],
        label_of(run),
    )


def holding_figure(run: Run, found: Regulated) -> Figure | None:
    """The same for a set-point, the disturbance shaded; None where the loop was never closed."""
    loop = found.loop
    if loop is None or loop.t_s.size < 2:
        return None
    data, layout, cut = _over_time(run, loop)
    words = ""
    if found.pulse_s is not None:
        size = time_unit(float(loop.t_s[-1]))[0]
        on, off = (t / size for t in found.pulse_s)
        data.append(_shaded(on, off))
        words = "Tinted: the disturbance, added to the control input."
        if found.transient is not None:
            counts = f" ({found.transient / loop.count:.1f} counts)" if loop.count else ""
            words += f" Largest error from then on: {number(found.transient)} {exact_unit(run.unit)}{counts}."
    start = B_ELL if found.facts.get("ell_K") is not None else f"a state of the {found.facts['start']} branch"
    return Figure(
        [Panel(data, layout, 720)],
        "The set-point held in closed loop.",
        [
            joined(["Begun in ", start, "."]),
            words,
            _band_words(loop, cut),
            f"n = {loop.t_s.size} samples in closed loop;",
            place(run),
        ],
        label_of(run),
    )


def loop_hysteresis(run: Run, loop: Stretch, *, moves: bool = True) -> Figure:
    """Output against input while the loop was closed, and the way there; ``moves``: rising and falling apart."""
    kept = path(loop.input_K, loop.position)
    u, y = loop.input_K[kept], loop.position[kept]
    thin = _evenly(run["input"])
    whole = line(run["input"][thin], run["position"][thin], "before and after", GREY, width=0.8)
    layout = {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}
    size = count_size(run)
    return Figure(
        [
            Panel(
                [whole, *(travel(u, y) if moves else [line(u, y, "closed loop", POSITION, width=1.2)])],
                layout,
                450,
            )
        ],
        "The way through the hysteresis in closed loop.",
        [
            "The input is the temperature predicted from the measured current.",
            f"Resolution {size:.3g} {exact_unit(run.unit)}." if size else "",
            place(run),
        ],
        label_of(run),
    )


def _evenly(u: Array) -> NDArray[np.intp]:
    """Indices at equal parts of the way the input went: quick moves are drawn as finely as slow ones."""
    gone = np.cumsum(np.abs(np.nan_to_num(np.diff(u, prepend=u[:1]))))
    return np.unique(np.minimum(np.searchsorted(gone, np.linspace(0.0, gone[-1], POINTS)), u.size - 1))


def _over_time(run: Run, loop: Stretch) -> tuple[list[Trace], dict[str, Any], bool]:
    """Four rows on one time axis; whether errors beyond the error's row are cut off."""
    size, unit = time_unit(float(loop.t_s[-1]) if loop.t_s.size else 0.0)
    t, error = loop.t_s / size, loop.error
    errors = f"Error ({'counts' if loop.count else exact_unit(run.unit)})"
    rows = (
        (loop.position, "measured", POSITION),
        (error, "error", INK),
        (loop.current_A, "current", CURRENT),
        (loop.input_K, "predicted temperature", TEMPERATURE),
    )
    data: list[Trace] = [_band(t, y_axis="y2")] if loop.count else []
    for (values, name, colour), y_axis in zip(rows, _ROWS):
        kept = envelope(values, POINTS)
        data.append(
            line(t[kept], values[kept], name, colour, width=1.2, yaxis=y_axis, showlegend=name == "measured")
        )
    data.append(line(t, loop.wanted, "wanted", INK, width=1.3, dash="dot", yaxis="y"))
    titles = (output_title(run), errors, "Current (A)", input_title(run))
    layout, cut = _stacked(
        titles, f"Time since the loop was closed ({unit})", error if loop.count else error[:0]
    )
    return data, layout, cut


def _stacked(titles: tuple[str, ...], t_title: str, error: Array) -> tuple[dict[str, Any], bool]:
    layout: dict[str, Any] = {"xaxis": axis(t_title, anchor=_ROWS[-1], mirror=False), "showlegend": True}
    top = 1.0
    for title, share, name in zip(titles, _SHARES, _ROWS):
        words = (
            title.replace(" above ambient", "<br>above ambient")
            .replace(", ", ",<br>")
            .replace(" T₁", "<br>T₁")
        )
        layout[f"yaxis{name[1:]}"] = {
            "title": {"text": words, "font": {"size": 11}},
            "domain": [max(top - share + 0.03, 0.0) if name != _ROWS[-1] else 0.0, top],
            "mirror": False,
            "nticks": 6,
        }
        top -= share
    known = np.abs(error[np.isfinite(error)])
    cut = bool(known.size and known.max() > _MOST_COUNTS)
    if known.size:
        half = min(max(1.15 * float(known.max()), 2 * WITHIN_COUNTS), _MOST_COUNTS)
        layout["yaxis2"]["range"] = [-half, half]
    return layout, cut


def _band(t: Array, y_axis: str) -> Trace:
    ends = [float(t[0]), float(t[-1])] if t.size else [0.0, 1.0]
    edge = [ends[0], ends[1], ends[1], ends[0], ends[0]]
    half = WITHIN_COUNTS
    words = f"± {half:g} counts"
    closed = {"fill": "toself", "fillcolor": BAND, "hoverinfo": "skip", "yaxis": y_axis}
    return line(edge, [-half, -half, half, half, -half], words, GREY, width=0, **closed)


def _shaded(on: float, off: float) -> Trace:
    """The time of the disturbance over the error's row."""
    edge, far = [on, off, off, on, on], _MOST_COUNTS * 10
    tint = {"fill": "toself", "fillcolor": "rgba(230,159,0,.18)", "hoverinfo": "skip", "yaxis": "y2"}
    return line(edge, [-far, -far, far, far, -far], "disturbance", CURRENT, width=0, **tint)


def _band_words(loop: Stretch, cut: bool) -> str:
    if not loop.count:
        return ""
    beyond = f" Errors beyond {_MOST_COUNTS:g} counts are cut off." if cut else ""
    return f"Error: measured less wanted, in encoder counts; band: ± {WITHIN_COUNTS:g} counts.{beyond}"

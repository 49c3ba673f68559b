"""A closed loop over time and over the input: wanted against measured, error in counts, current, temperature.

Knows runs and what their loops did; refuses to know controllers and models.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control.tracking.measures import WITHIN_COUNTS
from smarig.record import Run
from smarig.report.closed_loop import Regulated, Stretch, TrackedRun
from smarig.report.closed_loop_words import size as size_of
from smarig.report.conditions import count_size, exact_unit, input_title, label_of, output_title, place
from smarig.report.decimate import POINTS, envelope, path
from smarig.report.figure import BEYOND, Figure, Panel, Trace, axis, line
from smarig.report.figures_hysteresis import travel
from smarig.report.figures_regulation import B_ELL
from smarig.report.figures_time import time_unit
from smarig.report.html import joined
from smarig.report.numbers import counts, number
from smarig.report.style import CURRENT, GREY, INK, POSITION, TEMPERATURE

Array = NDArray[np.float64]
ROWS = ("y", "y2", "y3", "y4")
_SHARES = (0.34, 0.26, 0.18, 0.22)  # of the height, from above
_LEAST_COUNTS, _USUAL = (
    12.0,
    3.0,
)  # jumps of a reference are cut off at these, the second of what 90 % keep within
BAND = "rgba(107,114,128,.18)"


def tracking_figure(run: Run, found: TrackedRun) -> Figure:
    """Wanted and measured position, the error with the ± 2-count band, current and predicted temperature."""
    f, words = found.figures, ""
    unit = exact_unit(run.unit)
    if f is not None:
        after = f" from {found.skip_s:g} s on" if found.skip_s else ""
        words = f"Error {number(f.rms)} {unit} rms, {number(f.largest)} {unit} at most{after}, n = {f.n}."
    loop = found.loop
    reach = error_reach(loop.error[loop.t_s >= found.skip_s]) if loop.count else None
    data, layout = _over_time(run, loop, reach)
    return Figure(
        [Panel(data, layout, 720)],
        f"Controller {found.controller} along the reference {found.reference.name}.",
        [words, _band_words(loop, reach), place(run)],
        label_of(run),
    )


def holding_figure(run: Run, found: Regulated) -> Figure | None:
    """The same for a set-point, the disturbance shaded; None where the loop was never closed."""
    loop = found.loop
    if loop is None or loop.t_s.size < 2:
        return None
    transient = (found.transient or 0.0) / (loop.count or 1.0)
    reach = error_reach(loop.error, transient) if loop.count else None
    data, layout = _over_time(run, loop, reach)
    words = ""
    if found.pulse_s is not None:
        second = time_unit(float(loop.t_s[-1]))[0]
        on, off = (t / second for t in found.pulse_s)
        far = reach or float(np.nanmax(np.abs(loop.error)))
        data.append(shaded(on, off, -far, far, yaxis="y2"))
        words = "Tinted: the disturbance, added to the control input."
        if found.transient is not None:
            largest = size_of(found.transient, run.unit, loop.count)
            words += f" Largest error of the readings from then on: {largest}."
    start = B_ELL if found.facts.get("ell_K") is not None else f"a state of the {found.facts['start']} branch"
    return Figure(
        [Panel(data, layout, 720)],
        "The set-point held in closed loop.",
        [
            joined(["Begun in ", start, "."]),
            words,
            _band_words(loop, reach),
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


def error_reach(error: Array, least: float = 0.0) -> float:
    """How far an error's row reaches either way, in counts: all of it, unless jumps would hide the rest.

    At least three times what nine tenths of the errors keep within, 12 counts and ``least``, or all there is.
    """
    known = np.abs(error[np.isfinite(error)])
    if not known.size:
        return _LEAST_COUNTS
    everything = max(BEYOND * float(known.max()), 2 * WITHIN_COUNTS)
    return min(everything, max(_USUAL * float(np.quantile(known, 0.9)), BEYOND * least, _LEAST_COUNTS))


def _over_time(run: Run, loop: Stretch, reach: float | None) -> tuple[list[Trace], dict[str, Any]]:
    """Four rows on one time axis, that of the error to ``reach`` either way."""
    size, unit = time_unit(float(loop.t_s[-1]) if loop.t_s.size else 0.0)
    t, error = loop.t_s / size, loop.error
    errors = f"Error ({'counts' if loop.count else exact_unit(run.unit)})"
    rows = (
        (loop.position, "measured", POSITION),
        (error, "error", INK),
        (loop.current_A, "current", CURRENT),
        (loop.input_K, "predicted temperature", TEMPERATURE),
    )
    data: list[Trace] = [band(t, -WITHIN_COUNTS, yaxis="y2")] if loop.count else []
    for (values, name, colour), y_axis in zip(rows, ROWS):
        kept = envelope(values, POINTS)
        data.append(
            line(t[kept], values[kept], name, colour, width=1.2, yaxis=y_axis, showlegend=name == "measured")
        )
    data.append(line(t, loop.wanted, "wanted", INK, width=1.3, dash="dot", yaxis="y"))
    titles = (output_title(run), errors, "Current (A)", input_title(run))
    layout = stacked(titles, _SHARES, f"Time since the loop was closed ({unit})")
    if reach is not None:
        layout["yaxis2"]["range"] = [-reach, reach]
    return data, layout


def stacked(titles: Sequence[str], shares: Sequence[float], t_title: str) -> dict[str, Any]:
    """Rows above each other on one time axis, each with its share of the height."""
    last = ROWS[len(titles) - 1]
    layout: dict[str, Any] = {"xaxis": axis(t_title, anchor=last, mirror=False), "showlegend": True}
    top = 1.0
    for title, share, name in zip(titles, shares, ROWS):
        words = (
            title.replace(" above ambient", "<br>above ambient")
            .replace(", ", ",<br>")
            .replace(" T₁", "<br>T₁")
        )
        layout[f"yaxis{name[1:]}"] = {
            "title": {"text": words, "font": {"size": 11}},
            "domain": [max(top - share + 0.03, 0.0) if name != last else 0.0, top],
            "mirror": False,
            "nticks": 6,
        }
        top -= share
    return layout


def band(t: Array, low: float, **more: Any) -> Trace:
    """From ``low`` to + 2 counts, behind the errors."""
    left, right = (float(t[0]), float(t[-1])) if t.size else (0.0, 1.0)
    words = f"{'±' if low < 0 else 'within'} {WITHIN_COUNTS:g} counts"
    return _box(left, right, low, WITHIN_COUNTS, words, GREY, BAND, **more)


def shaded(on: float, off: float, low: float, high: float, **more: Any) -> Trace:
    """The time of the disturbance over the error's row."""
    return _box(on, off, low, high, "disturbance", CURRENT, "rgba(230,159,0,.18)", **more)


def _box(
    left: float, right: float, low: float, high: float, words: str, colour: str, fill: str, **more: Any
) -> Trace:
    edge = [left, right, right, left, left]
    closed = {"fill": "toself", "fillcolor": fill, "hoverinfo": "skip"}
    return line(edge, [low, low, high, high, low], words, colour, width=0, **closed, **more)


def _band_words(loop: Stretch, reach: float | None) -> str:
    if reach is None:
        return ""
    words = f"Error: measured less wanted, in encoder counts; band: ± {WITHIN_COUNTS:g} counts."
    return f"{words}{cut_words(loop.error, reach)}"


def cut_words(error: Array, reach: float) -> str:
    """What an error's row does not show, in a sentence; "" where it shows all."""
    known = np.abs(error[np.isfinite(error)])
    beyond = known > reach
    if not beyond.any():
        return ""
    share = f"{number(100 * float(beyond.mean()), 2)} % of the readings"
    return f" Errors beyond {number(reach)} counts are cut off: {share}, the largest {counts(float(known.max()))}."

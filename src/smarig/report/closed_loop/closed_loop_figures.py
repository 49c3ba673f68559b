"""Figures of a closed loop over time and over the input: reference, position, error in counts, current, temperature."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control import SETTLING_BAND_COUNTS
from smarig.core import Array
from smarig.record import Run
from smarig.report.closed_loop.closed_loop_text import size as size_of
from smarig.report.closed_loop.loop_result import LoopSegment, RegulationResult, TrackingResult
from smarig.report.closed_loop.regulation_plane_figure import B_ELL
from smarig.report.components.decimate import POINTS, envelope, path
from smarig.report.components.figure import AXIS_MARGIN, Figure, Panel, Trace, line
from smarig.report.components.html import joined
from smarig.report.components.numbers import counts, number
from smarig.report.components.run_description import (
    count_size,
    display_unit,
    input_title,
    loop_axes,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import BAND, CURRENT, GREY, INK, POSITION, TEMPERATURE
from smarig.report.runs.hysteresis_figure import direction_traces
from smarig.report.runs.time_figures import ROWS, stacked_layout, time_unit

_SHARES = (0.34, 0.26, 0.18, 0.22)  # of the height, from above
# Limits of the error axis at jumps of a reference; the factor applies to the 90 % quantile.
_MIN_HALF_RANGE_COUNTS, _QUANTILE_FACTOR = 12.0, 3.0


def tracking_figure(run: Run, found: TrackingResult) -> Figure:
    """Reference and measured position, the error with the ± 2-count band, current and predicted temperature."""
    f, words = found.measures, ""
    unit = display_unit(run.unit)
    if f is not None:
        after = f", after the first {found.skip_s:g} s" if found.skip_s else ""
        words = f"The error is {number(f.rms)} {unit} rms and at most {number(f.largest)} {unit}{after}, n = {f.n}."
    loop = found.loop
    half_range = error_half_range(loop.error[loop.t_s >= found.skip_s]) if loop.count else None
    data, layout = _time_panel(run, loop, half_range)
    return Figure(
        [Panel(data, layout, 720)],
        f"Tracking: controller {found.controller}, reference {found.reference.name}.",
        [words, _band_text(loop, half_range), run_caption(run)],
        source_label(run),
    )


def regulation_figure(run: Run, found: RegulationResult) -> Figure | None:
    """The same for a set-point, with the disturbance shaded; None if the loop was never closed."""
    loop = found.loop
    if loop is None or loop.t_s.size < 2:
        return None
    transient = (found.transient or 0.0) / (loop.count or 1.0)
    half_range = error_half_range(loop.error, transient) if loop.count else None
    data, layout = _time_panel(run, loop, half_range)
    words = ""
    if found.disturbance_s is not None:
        second = time_unit(float(loop.t_s[-1]))[0]
        on, off = (t / second for t in found.disturbance_s)
        far = half_range or float(np.nanmax(np.abs(loop.error)))
        data.append(disturbance_shading(on, off, -far, far, yaxis="y2"))
        words = "Shaded: the disturbance, added to the control input."
        if found.transient is not None:
            largest = size_of(found.transient, run.unit, loop.count)
            words += f" Largest error of the readings after its start: {largest}."
    start = (
        B_ELL
        if found.setpoint_data.get("ell_K") is not None
        else f"a state of the {found.setpoint_data['start']} branch"
    )
    return Figure(
        [Panel(data, layout, 720)],
        "Set-point regulation in closed loop.",
        [
            joined(["Initial state: ", start, "."]),
            words,
            _band_text(loop, half_range),
            f"n = {loop.t_s.size} samples in closed loop;",
            run_caption(run),
        ],
        source_label(run),
    )


def loop_hysteresis_figure(run: Run, loop: LoopSegment, *, moves: bool = True) -> Figure:
    """Output against input while the loop was closed, and before; ``moves``: rising and falling in two colours."""
    kept = path(loop.input_K, loop.position)
    u, y = loop.input_K[kept], loop.position[kept]
    thinned = _evenly_along_input(run["input"])
    whole = line(run["input"][thinned], run["position"][thinned], "before and after", GREY, width=0.8)
    layout = loop_axes(run)
    size = count_size(run)
    return Figure(
        [
            Panel(
                [
                    whole,
                    *(direction_traces(u, y) if moves else [line(u, y, "closed loop", POSITION, width=1.2)]),
                ],
                layout,
                450,
            )
        ],
        "Output against input in closed loop.",
        [
            "The input is the temperature predicted from the measured current.",
            f"Resolution {size:.3g} {display_unit(run.unit)}." if size else "",
            run_caption(run),
        ],
        source_label(run),
    )


def _evenly_along_input(u: Array) -> NDArray[np.intp]:
    """Indices at equal shares of the input's travel, so that fast and slow moves are drawn equally finely."""
    travelled_K = np.cumsum(np.abs(np.nan_to_num(np.diff(u, prepend=u[:1]))))
    return np.unique(
        np.minimum(np.searchsorted(travelled_K, np.linspace(0.0, travelled_K[-1], POINTS)), u.size - 1)
    )


def error_half_range(error: Array, least: float = 0.0) -> float:
    """The half-range of an error axis in counts: the largest error, unless jumps would hide the smaller errors.

    The result is at least the smaller of two values: the whole range; and the largest of three times the 90 %
    quantile, 12 counts and ``least``.
    """
    known = np.abs(error[np.isfinite(error)])
    if not known.size:
        return _MIN_HALF_RANGE_COUNTS
    whole_range = max(AXIS_MARGIN * float(known.max()), 2 * SETTLING_BAND_COUNTS)
    return min(
        whole_range,
        max(_QUANTILE_FACTOR * float(np.quantile(known, 0.9)), AXIS_MARGIN * least, _MIN_HALF_RANGE_COUNTS),
    )


def _time_panel(run: Run, loop: LoopSegment, half_range: float | None) -> tuple[list[Trace], dict[str, Any]]:
    """Traces and layout of four rows on one time axis; the error row spans ± ``half_range``."""
    size, unit = time_unit(float(loop.t_s[-1]) if loop.t_s.size else 0.0)
    t, error = loop.t_s / size, loop.error
    errors = f"Error ({'counts' if loop.count else display_unit(run.unit)})"
    rows = (
        (loop.position, "measured", POSITION),
        (error, "error", INK),
        (loop.current_A, "current", CURRENT),
        (loop.input_K, "predicted temperature", TEMPERATURE),
    )
    data: list[Trace] = [tolerance_band(t, -SETTLING_BAND_COUNTS, yaxis="y2")] if loop.count else []
    for (values, name, colour), y_axis in zip(rows, ROWS):
        kept = envelope(values, POINTS)
        data.append(
            line(t[kept], values[kept], name, colour, width=1.2, yaxis=y_axis, showlegend=name == "measured")
        )
    data.append(line(t, loop.wanted, "reference", INK, width=1.3, dash="dot", yaxis="y"))
    titles = (output_title(run), errors, "Current (A)", input_title(run))
    layout = stacked_layout(titles, f"Time since the loop was closed ({unit})", _SHARES)
    if half_range is not None:
        layout["yaxis2"]["range"] = [-half_range, half_range]
    return data, layout


def tolerance_band(t: Array, low: float, **more: Any) -> Trace:
    """A band from ``low`` to +2 counts behind the errors."""
    left, right = (float(t[0]), float(t[-1])) if t.size else (0.0, 1.0)
    words = f"{'±' if low < 0 else 'within'} {SETTLING_BAND_COUNTS:g} counts"
    return _box(
        left=left,
        right=right,
        low=low,
        high=SETTLING_BAND_COUNTS,
        words=words,
        colour=GREY,
        fill=BAND,
        **more,
    )


def disturbance_shading(on: float, off: float, low: float, high: float, **more: Any) -> Trace:
    """The shading of the disturbance in the error row."""
    return _box(
        left=on,
        right=off,
        low=low,
        high=high,
        words="disturbance",
        colour=CURRENT,
        fill="rgba(230,159,0,.18)",
        **more,
    )


def _box(
    left: float, right: float, low: float, high: float, words: str, colour: str, fill: str, **more: Any
) -> Trace:
    edge = [left, right, right, left, left]
    closed = {"fill": "toself", "fillcolor": fill, "hoverinfo": "skip"}
    return line(edge, [low, low, high, high, low], words, colour, width=0, **closed, **more)


def _band_text(loop: LoopSegment, half_range: float | None) -> str:
    if half_range is None:
        return ""
    words = f"Second row: error (measured − reference) in counts, with a band of ± {SETTLING_BAND_COUNTS:g} counts."
    return f"{words}{clipped_text(loop.error, half_range)}"


def clipped_text(error: Array, half_range: float) -> str:
    """A sentence on the errors beyond the axis; "" if the axis shows all of them."""
    known = np.abs(error[np.isfinite(error)])
    beyond = known > half_range
    if not beyond.any():
        return ""
    share = f"{number(100 * float(beyond.mean()), 2)} % of the readings"
    return f" The axis ends at {number(half_range)} counts; {share} exceed it, up to {counts(float(known.max()))}."

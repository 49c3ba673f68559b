"""Figures over time: the channels of a run, and its initialisation (Figs. 5.4, 5.6)."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from smarig.core import Array, Quality, SmarigError
from smarig.record import Run
from smarig.replay import recorded_actuator
from smarig.report.components.decimate import POINTS, envelope
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line, plotly_escaped
from smarig.report.components.numbers import thousands
from smarig.report.components.run_description import (
    capitalised,
    input_title,
    output_title,
    protocol_name,
    run_caption,
    source_label,
)
from smarig.report.components.style import BAD, CURRENT, GREY, INK, POSITION, TEMPERATURE
from smarig.report.runs.sample_path import broken_at_gaps, drawn, ends_of_parts, uninterrupted_parts

ROWS = ("y", "y2", "y3", "y4", "y5", "y6")
# Where the title of a row breaks: in one line it would run into the next row.
_BREAKS = ((" above ambient", "<br>above ambient"), (", ", ",<br>"), (" difference", "<br>difference"))
_CHANNELS = (
    ("current_A", "Current (A)", CURRENT),
    ("current_command_A", "Commanded current (A)", CURRENT),
    ("voltage_V", "Voltage (V)", GREY),
    ("temperature_degC", "Measured temperature (°C)", "#CC79A7"),
    ("input", "", TEMPERATURE),
    ("position", "", POSITION),
)
_QUALITY_MARKERS = (
    (Quality.SATURATED, "saturated", "triangle-up"),
    (Quality.RETRIED, "retried", "x"),
    (Quality.STALE, "stale", "diamond-open"),
    (Quality.TRIPPED, "tripped", "star"),
    (Quality.SUSPECT, "suspect", "hexagram-open"),
)


def time_axis(run: Run) -> tuple[Array, str]:
    """Time since the first sample of a run, and the axis title; sample numbers if no time was recorded."""
    t = run["t_s"]
    if not np.isfinite(t).any():
        return np.arange(len(run), dtype=float), "Sample number (no time recorded)"
    t = t - t[np.isfinite(t)][0]
    size, unit = time_unit(float(np.nanmax(t)))
    return t / size, f"Time since the start of the run ({unit})"


def time_unit(span_s: float) -> tuple[float, str]:
    """A readable unit for a time span: its length in seconds, and its name."""
    return (3600.0, "h") if span_s > 6 * 3600 else (60.0, "min") if span_s > 600 else (1.0, "s")


def stacked_layout(titles: Sequence[str], t_title: str, shares: Sequence[float] = ()) -> dict[str, Any]:
    """The layout of rows that share one time axis, each with its share of the height, else with equal ones.

    >>> stacked_layout(["Wire temperature difference T₁ − T₂ (K)"], "Time (s)")["yaxis"]["title"]["text"]
    'Wire temperature<br>difference T₁ − T₂ (K)'
    """
    last = ROWS[len(titles) - 1]
    layout: dict[str, Any] = {"xaxis": axis(t_title, anchor=last, mirror=False)}
    top = 1.0
    for title, share, name in zip(titles, shares or [1 / len(titles)] * len(titles), ROWS):
        words = plotly_escaped(title)
        for where, instead in _BREAKS:
            words = words.replace(where, instead)
        layout[f"yaxis{name[1:]}"] = {
            "title": {"text": words, "font": {"size": 11}},
            "domain": [max(top - share + 0.03, 0.0) if name != last else 0.0, top],
            "mirror": False,
            "nticks": 6,
        }
        top -= share
    return layout


def time_series_figure(run: Run, points: int = POINTS, *, explore: bool = True) -> Figure:
    """Current, hysteresis input and output against time in stacked rows, with quality marks.

    Each channel has at most ``points`` points: the minimum and the maximum of equal segments. ``explore``: as in Panel.
    """
    t, t_title = time_axis(run)
    channels = [row for row in _CHANNELS if run.has(row[0])]
    if run.has("current_A"):
        channels = [row for row in channels if row[0] != "current_command_A"]
    own = {"input": input_title(run), "position": output_title(run)}
    titles = [title or own[name] for name, title, _ in channels]
    data: list[Trace] = []
    part = uninterrupted_parts(run)
    for (name, _, colour), title, row in zip(channels, titles, ROWS):
        kept = np.union1d(envelope(run[name], points), ends_of_parts(part))
        rows = broken_at_gaps(kept, part)
        style = {"width": 1.1, "yaxis": row, "showlegend": False}
        data.append(line(drawn(t, rows), drawn(run[name], rows), title, colour, **style))
    quality_markers = _quality_markers(run, t, ROWS[len(channels) - 1])
    layout = stacked_layout(titles, t_title) | {"showlegend": bool(quality_markers)}
    thinned = (
        f"{thousands(len(run))} samples, drawn as minimum and maximum of equal segments, so that all peaks remain."
        if len(run) > points
        else ""
    )
    kept_out = (
        " Marked: " + ", ".join(f"{m['name']}" for m in quality_markers) + "." if quality_markers else ""
    )
    return Figure(
        [Panel([*data, *quality_markers], layout, max(200, 116 * len(channels) + 50), explore=explore)],
        f"{capitalised(protocol_name(run))} against time.",
        [_rows_text(run), thinned + kept_out, run_caption(run)],
        source_label(run),
    )


def _rows_text(run: Run) -> str:
    return (
        "The plateaus are holds that last until the output settles (§5.2.1)."
        if 2 * sum(step.verdict == "settled" for step in run.steps) > len(run.steps)
        else ""
    )


def _quality_markers(run: Run, t: Array, y_axis: str) -> list[Trace]:
    quality, position = np.nan_to_num(run["quality"]).astype(int), run["position"]
    traces = []
    for flag, name, symbol in _QUALITY_MARKERS:
        hit = np.flatnonzero(quality & flag)
        if hit.size:
            shown = hit[:: max(1, hit.size // POINTS + 1)]
            words = f"{thousands(hit.size)} {name} samples"
            traces.append(dots(t[shown], position[shown], words, BAD, symbol=symbol, size=7, yaxis=y_axis))
    late = [
        s for s in run.steps if s.verdict == "timed_out" and s.t_end_s is not None and s.position is not None
    ]
    if late and run.has("t_s"):
        first, size = (
            run["t_s"][np.isfinite(run["t_s"])][0],
            time_unit(float(np.ptp(run["t_s"][np.isfinite(run["t_s"])])))[0],
        )
        ends = [(s.end_s - first) / size for s in late]
        words = f"{len(late)} steps that did not settle in time"
        here = [s.position if s.position is not None else np.nan for s in late]
        traces.append(dots(ends, here, words, BAD, symbol="circle-open", size=9, yaxis=y_axis))
    return traces


def initialisation_figure(run: Run) -> Figure | None:
    """The decaying sinusoid of §5.2.2: the steady temperature of the current, and the temperature of the wire.

    None for runs without a sinusoid (a one-wire rig initialises by cooling).
    """
    step = next((s for s in run.steps if s.branch == "decay"), None)
    rows = run.rows(step) if step else slice(0, 0)
    gain = _gain_K_per_A2(run)
    if rows.start == rows.stop or gain is None:
        return None
    t, t_title = time_axis(run)
    current, wire = run["current_command_A"][rows], run["input"][rows]
    steady = gain * np.sign(current) * current**2
    kept, also = envelope(steady), envelope(wire)
    data = [
        line(t[rows][kept], steady[kept], "steady temperature of the current", CURRENT, width=1.2),
        line(t[rows][also], wire[also], "wire temperature", INK, width=1.6),
    ]
    cycles = int(np.sum((wire[1:] > 0) & (wire[:-1] <= 0)))
    last = float(np.nanmax(np.abs(wire[-max(1, wire.size // max(1, cycles)) :])))
    layout = {"xaxis": axis(t_title), "yaxis": axis(input_title(run))}
    return Figure(
        [Panel(data, layout, 430)],
        "Initialisation: steady temperature of the current and temperature of the wire.",
        [
            f"In {cycles} cycles the amplitude of the wire's temperature decays from {np.nanmax(wire):.0f} to "
            f"{last:.0f} {run.input_unit}. The amplitude is smaller than that of the steady temperature of "
            f"the current ({np.nanmax(steady):.0f} {run.input_unit} at first), because of the time constant. The "
            "black curve must decay evenly to reach the anhysteretic state (§5.2.2).",
            run_caption(run),
        ],
        source_label(run),
    )


def _gain_K_per_A2(run: Run) -> float | None:
    try:
        actuator = recorded_actuator(run)
        return actuator.gain_K_per_A2 if actuator else None
    except SmarigError:
        return None

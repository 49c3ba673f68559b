"""Figures of one run: its channels against time, and its hysteresis graph. Knows no model."""

from typing import Any

import numpy as np

from smarig.record import Run
from smarig.report.figure import Figure, Panel, axis, dots, line
from smarig.report.style import COOLING, CURRENT, GREY, HEATING, INK, POSITION, TEMPERATURE
from smarig.report.words import conditions, input_axis, output_axis, thinned

_LANES = (
    ("current_A", "current (A)", CURRENT),
    ("voltage_V", "voltage (V)", GREY),
    ("temperature_degC", "measured temperature (°C)", HEATING),
    ("input", "input", TEMPERATURE),
    ("position", "position", POSITION),
)


def time_series(run: Run) -> Figure:
    """Every measured channel in a lane of its own, over hours or samples."""
    timed = run.has("t_s")
    clock = (run["t_s"] - np.nanmin(run["t_s"])) / 60 if timed else run["tick"]
    lanes = [(name, label, colour) for name, label, colour in _LANES if run.has(name) and np.ptp(_known(run[name])) > 0]
    traces, layout = [], {"xaxis": axis("time since the run began (min)" if timed else "sample number")}
    height, gap = 1 / max(len(lanes), 1), 0.035
    for k, (name, label, colour) in enumerate(lanes):
        number = "" if k == 0 else str(k + 1)
        x, y = thinned(clock, run[name])
        traces.append(line(x, y, label, colour, yaxis=f"y{number}", xaxis="x", width=1.2, showlegend=False))
        words = {"input": input_axis(run), "position": output_axis(run)}.get(name, label)
        layout[f"yaxis{number}"] = axis(_short(words), domain=[k * height, (k + 1) * height - gap])
    layout["xaxis"]["anchor"] = "y"
    caption = [conditions(run), _marks(run), _input_note(run)]
    return Figure([Panel(traces, layout, 130 * max(len(lanes), 1) + 90)], "Record.", caption, run.twin)


def hysteresis_graph(run: Run) -> Figure:
    """Settled points joined in their order, rising and falling told apart (§5.2.1, step 6)."""
    inputs, outputs = run.points()
    steps = bool(run.settled)
    x, y = (inputs, outputs) if steps else thinned(inputs, outputs, 6000)
    rising = np.diff(x, prepend=x[:1]) > 0
    traces = [line(x, y, "path", "#c3c9d1", width=1)]
    for mask, name, colour, symbol in (
        (rising, "input rising", HEATING, "triangle-up"),
        (~rising, "input falling", COOLING, "triangle-down"),
    ):
        traces.append(dots(x[mask], y[mask], name, colour, symbol=symbol, size=7 if steps else 3))
    late = [s for s in run.settled if s.verdict == "timed_out"]
    if late:
        at = [s.target for s in late], [s.position for s in late]
        traces.append(dots(*at, "did not settle", INK, symbol="x-open", size=11))
    layout = {"xaxis": axis(input_axis(run)), "yaxis": axis(output_axis(run))}
    what = "Settled points joined in the order of measurement." if steps else "All samples in their order."
    return Figure([Panel(traces, layout, 460)], "Hysteresis.", [what, conditions(run), _input_note(run)], run.twin)


def swing(run: Run) -> Figure:
    """Initialisation: the temperature the wire reaches, by the heating model along the measured current."""
    minutes = (run["t_s"] - run["t_s"][0]) / 60
    steady = _steady(run)
    traces: list[dict[str, Any]] = [
        line(*thinned(minutes, steady), "steady state of the current", "#c3c9d1", width=1),
        line(*thinned(minutes, run["input"]), "wire", TEMPERATURE),
    ]
    layout = {"xaxis": axis("time (min)"), "yaxis": axis(_short(input_axis(run)))}
    high, low = float(np.nanmax(run["input"])), float(np.nanmin(run["input"]))
    reach = f"The wire swings between {low:+.0f} and {high:+.0f} {run.input_unit}.".replace("-", "−")
    return Figure([Panel(traces, layout, 340)], "Initialisation.", [reach, conditions(run)], run.twin)


def _steady(run: Run) -> np.ndarray:
    """Steady input of the measured current (5.3), scaled by what the record itself reaches when held."""
    current = run["current_A"]
    square = np.sign(current) * current**2
    held = np.abs(np.gradient(run["input"])) < 0.01
    use = held & (np.abs(square) > 0.2 * np.nanmax(np.abs(square)))
    gain = float(np.median(run["input"][use] / square[use])) if use.any() else np.nan
    return gain * square


def _known(values: np.ndarray) -> np.ndarray:
    return values[np.isfinite(values)]


def _short(label: str) -> str:
    quantity, _, unit = label.partition(" (")
    words = quantity.replace("wire temperature above ambient", "wire T − ambient").replace(", T1 - T2", ", T₁ − T₂")
    return f"{words} ({unit}" if unit else words


def _marks(run: Run) -> str:
    """Honest numbers: what was marked."""
    quality = run["quality"].astype(int)
    found = [
        f"{int(count)} samples {word}"
        for bit, word in ((1, "retried"), (2, "stale"), (4, "saturated"), (8, "after a trip"))
        if (count := np.count_nonzero(quality & bit))
    ]
    late = sum(s.verdict == "timed_out" for s in run.steps)
    found += [f"{late} of {len(run.steps)} steps did not settle"] if late else []
    return f"Marked: {', '.join(found)}." if found else "No sample is marked as retried, stale or saturated."


def _input_note(run: Run) -> str:
    source = run.meta.get("input", {}).get("from")
    return f"The input is not measured: {source}." if source else ""

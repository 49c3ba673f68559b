"""The figures of a study: measured and predicted loops of held-out runs, within the family of all loads."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.identification import RunVerification
from smarig.record import Run
from smarig.replay import recorded_conditions
from smarig.report import (
    Figure,
    Panel,
    axis,
    display_unit,
    dots,
    input_title,
    line,
    number,
    output_title,
    path,
    style,
)
from smarig.study.data_split import LOAD
from smarig.study.held_out_parts import BranchError, worst_place
from smarig.study.study_result import StudyResult

_PALE = 0.45
_FAMILY_DASHES = ("solid", "dash", "dashdot")  # neighbouring shades alone cannot be told apart
_FEW = 300  # readings: so many are drawn as dots
_MOST_CURVES = 25
_MOST_PANELS = 4


def shown_run(result: StudyResult) -> RunVerification | None:
    """The held-out run that a page shows first: that with the place of the largest error."""
    if result.evaluation is None:
        return None
    runs, place = result.evaluation.best.held_out, worst_place(result.branches)
    return next((r for r in runs if place and r.run == place.run), runs[0])


def loop_figure(result: StudyResult) -> Figure | None:
    """The held-out run with the largest error, and the model; for several loads, within the family of all."""
    run = shown_run(result)
    if run is None:
        return None
    family = _family(result, run) if result.split and result.split.kind == "load" else []
    own = worst_place([b for b in result.branches if b.run == run.run])
    marked = own if result.verdict != "good" and result.function is None else None
    title, caption = _words(result, run, marked, family=bool(family))
    traces = loop_traces(run, _load(result, run), marked)
    if result.function is not None:
        curve = line(result.function.u, result.function.y, "curve", style.MODEL, width=1.6, dash="dash")
        traces = [t for t in traces if t["name"] == "measured"] + [curve]
        title, caption = (
            "Measured output and a curve without hysteresis.",
            [
                f"A function of the input {'as it acts late' if result.function.lag_s else 'alone'}.",
                *caption[1:2],
            ],
        )
    panel = Panel([*family, *traces], _layout(result), 350)
    return Figure([panel], title, caption, "")


def other_loops(result: StudyResult) -> Figure | None:
    """The held-out runs that the first figure does not show; None if there are none."""
    best, first = (result.evaluation.best, shown_run(result)) if result.evaluation else (None, None)
    others = [r for r in best.held_out if r is not first] if best else []
    if not others:
        return None
    panels = [Panel(loop_traces(r), _layout(result), 340) for r in others[:_MOST_PANELS]]
    more = f"{len(others) - _MOST_PANELS} further runs are not drawn." if len(others) > _MOST_PANELS else ""
    names = ", ".join(run_title(r) for r in others[:_MOST_PANELS])
    return Figure(panels, "Other held-out runs.", [f"{names}.", more], "", 460)


def heating_figure(runs: Sequence[Run]) -> Figure | None:
    """The temperature against time of records without an output; None without a clock."""
    shown = [r for r in runs if r.has("t_s") and r.has("temperature_degC")][:_MOST_PANELS]
    if not shown:
        return None
    shades = style.colours(len(shown))
    data = []
    for run, shade in zip(shown, shades):
        t, temperature = run["t_s"], run["temperature_degC"]
        known = np.flatnonzero(np.isfinite(t) & np.isfinite(temperature))
        keep = known[path(t[known], temperature[known])]
        data.append(line(t[keep], temperature[keep], run.name, shade, width=1.3))
    layout = {"xaxis": axis("Time (s)"), "yaxis": axis("Temperature (°C)")}
    return Figure([Panel(data, layout, 420)], "Measured temperature.", ["As recorded."], "")


def run_title(r: RunVerification) -> str:
    """The name of a verified run without its folder."""
    return r.run.rsplit("/", 1)[-1].removesuffix(".run.sqlite")


def _layout(result: StudyResult) -> dict:
    run = result.tables[0].run
    return {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}


def _words(
    result: StudyResult, run: RunVerification, marked: BranchError | None, *, family: bool
) -> tuple[str, list[str]]:
    split = result.split
    fitted = split is not None and split.kind == "none"
    title = "Measured and fitted output." if fitted else "Measured and predicted output."
    several = result.evaluation is not None and len(result.evaluation.best.held_out) > 1
    which = (
        f"Run {run_title(run)}, of the held-out runs that with the largest error."
        if several and not family
        else ""
    )
    silent = not np.isfinite(run.predicted).all() and not _scattered(run.counted)
    dotted = "Dotted: readings without a prediction." if silent else ""
    thick = "Thick: where the error is largest." if marked else ""
    return title, [which, split.reason if split else "", dotted, thick]


def _load(result: StudyResult, run: RunVerification) -> str:
    """The load of a held-out run as text, "" if loads are not compared."""
    if result.split is None or result.split.kind != "load":
        return ""
    return next((load_text(r) or r.name for r in result.split.held_out if str(r.path) == run.run), "")


def load_of(run: Run) -> float:
    """The recorded load of a run in its unit; NaN if none is."""
    load = recorded_conditions(run).get(LOAD)
    return np.nan if load is None else float(load.value)


def load_text(run: Run) -> str:
    """The recorded load of a run with its unit; "" if none is."""
    load = recorded_conditions(run).get(LOAD)
    return f"{number(float(load.value))}{spaced(display_unit(load.unit))}" if load is not None else ""


def _family(result: StudyResult, shown: RunVerification) -> list[dict]:
    """The measured loops of the fitted loads, coloured in the order of the load."""
    runs = [r for r in result.split.train if str(r.path) != shown.run] if result.split else []
    runs.sort(key=load_of)
    traces = []
    for run, shade, dash in zip(runs, style.colours(len(runs)), cycle(_FAMILY_DASHES)):
        known = np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))
        keep = known[path(run["input"][known], run["position"][known])]
        name = f"{load_text(run) or run.name}, fitted"
        traces.append(line(run["input"][keep], run["position"][keep], name, shade, width=1.2, dash=dash))
    return traces


def loop_traces(r: RunVerification, title: str = "", marked: BranchError | None = None) -> list[dict]:
    """The measured loop and the model over it, as continuous paths; ``marked``: where the error is largest."""
    if not r.counted.all() and _scattered(r.counted):  # curves of a selection: each is a path of its own
        return _curves(r)
    shown = np.where(r.counted, r.predicted, np.nan)
    keep = np.union1d(path(r.input, r.measured), path(r.input, shown))
    u, y = r.input[keep], r.measured[keep]
    silent = ~np.isfinite(shown[keep])
    names = (f"measured, {title}", f"model, {title}") if title else ("measured", "model")
    look = {"width": 2.0} if title else {"width": 1.7, "opacity": _PALE}  # it must stand out from a family
    traces = [line(u, np.where(silent, np.nan, y), names[0], style.INK, **look)]
    if silent.any():
        rows = silent | np.roll(silent, 1) | np.roll(silent, -1)  # up to the rest of the loop
        traces.append(
            line(u, np.where(rows, y, np.nan), "without a prediction", style.INK, width=1.2, dash="dot")
        )
    if r.input.size <= _FEW:
        traces.append(dots(r.input, r.measured, "readings", style.INK, size=4))
    traces.append(line(u, shown[keep], names[1], style.MODEL, width=1.4))
    if marked is not None:
        rows = np.zeros(r.input.size, dtype=bool)
        rows[marked.worst_rows] = True
        traces.append(line(u, np.where(rows, shown, np.nan)[keep], "largest error", style.BAD, width=3.2))
    return traces


def _scattered(counted: NDArray[np.bool_]) -> bool:
    return int(np.sum(np.diff(counted.astype(int)) != 0)) > 4


def _curves(r: RunVerification) -> list[dict]:
    """Some of the selected curves, apart from each other; the model dashed, so that both can be seen."""
    edges = np.flatnonzero(np.diff(r.counted.astype(int)) != 0) + 1
    parts = [p for p in np.split(np.arange(r.counted.size), edges) if r.counted[p[0]]]
    chosen = [parts[k] for k in np.unique(np.linspace(0, len(parts) - 1, _MOST_CURVES).astype(int))]
    gap = np.array([np.nan])

    def joined(values: Array) -> Array:
        return np.concatenate([np.concatenate([values[p], gap]) for p in chosen])

    u = joined(r.input)
    return [
        line(u, joined(r.measured), "measured", style.INK, width=2.2, opacity=_PALE),
        line(u, joined(r.predicted), "model", style.MODEL, width=1.1, dash="dash"),
    ]

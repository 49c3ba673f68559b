"""Figures of runs overlaid: hysteresis, differences from the first run, and time series."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from smarig.core import spaced
from smarig.record import Run
from smarig.report.components.decimate import POINTS, envelope, path
from smarig.report.components.figure import (
    Figure,
    Panel,
    Trace,
    axis,
    dots,
    error_ground,
    line,
)
from smarig.report.components.html import Html, joined, tag
from smarig.report.components.numbers import number
from smarig.report.components.run_description import (
    conditions_text,
    count_size,
    display_unit,
    input_title,
    loop_axes,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import COMPARED, DASHES, SYMBOLS, colours
from smarig.report.runs.run_alignment import AlignedRun
from smarig.report.runs.run_family import FamilyVariable
from smarig.report.runs.sample_path import sample_path
from smarig.report.runs.time_figures import ROWS, stacked_layout, time_unit

_MOST_MARKS = 150  # largest number of points with a mark each
_SHEET_PX = 350  # leaves room for the rest of a sheet
_MOST_MARKED = 8  # runs with marks and their own sentence


def overlay_figure(runs: Sequence[AlignedRun], variable: FamilyVariable) -> Figure:
    """Output against input of all runs, on common axes and with a common zero; dark to bright over ``variable``."""
    data: list[Trace] = []
    marked = len(runs) <= _MOST_MARKED
    for k in variable.order if not marked else range(len(runs)):
        each = runs[k]
        u, y = each.run["input"], each.run["position"]
        kept = sample_path(u, y, count_size(each.run))
        points = each.run.points()
        if kept.size < points[0].size:
            (u, y), kept = points, np.arange(points[0].size)
        kept = kept[path(u[kept], y[kept])]
        data.append(_line(k, each, u[kept], y[kept] + each.offset))
        if marked and 0 < len(each.run.settled) <= _MOST_MARKS:
            style = {"symbol": SYMBOLS[k], "size": 5, "showlegend": False}
            data.append(dots(points[0], points[1] + each.offset, each.name, each.colour, **style))
    layout = loop_axes(runs[0].run)
    return Figure(
        [Panel(data, layout, 520)],
        "Hysteresis of the runs, overlaid.",
        [
            "Lines: the path of the samples"
            + ("; marks: settled points." if any(each.run.settled for each in runs) else "."),
            f"Colours, dark to bright: {variable.title.lower()}." if is_ordered(runs) else "",
            offsets_text(runs),
            runs_text(runs),
        ],
        source_label(*(each.run for each in runs)),
    )


def sheet_figure(runs: Sequence[AlignedRun], variable: FamilyVariable) -> Figure:
    """The overlaid loops and their differences in order, small enough for a sheet of paper."""
    loops, differences = overlay_figure(runs, variable), differences_figure(runs)
    panels = [loops.panels[0], *(differences.panels[:1] if differences else [])]
    words = [*loops.caption, f"Second panel: differences. {differences.caption[-1]}" if differences else ""]
    return Figure(
        [replace(panel, height=_SHEET_PX) for panel in panels],
        "Hysteresis of the runs, overlaid, and their differences.",
        words,
        loops.label,
        460,
    )


def differences_figure(runs: Sequence[AlignedRun]) -> Figure | None:
    """Each run − the first, against the input and in order; None if no run has a step in common with the first."""
    others = [(k, each) for k, each in enumerate(runs) if k and each.difference.size]
    if not others:
        return None
    noise = max((each.noise for _, each in others if each.noise), default=None)
    title = f"Run − {runs[0].name} ({display_unit(runs[0].run.unit)})"
    words = (
        f"Band: ± 2 σ of a difference, σ = {number(noise)}{spaced(display_unit(runs[0].run.unit))}."
        if noise
        else ""
    )
    panels = [
        _difference_panel(others, noise, title, "Step, in order of measurement", in_order=True),
        _difference_panel(others, noise, title, input_title(runs[0].run), in_order=False),
    ]
    return Figure(
        panels,
        f"Differences from {runs[0].name} at each common step.",
        [
            "Only steps with the same preceding inputs in both runs are compared: "
            + "; ".join(
                f"{e.name}: n = {e.difference.size}, rms {number(e.rms)}, at most "
                f"{number(e.max_abs)}{spaced(e.run.unit)}"
                for _, e in others
            )
            + ".",
            words or "The noise of a difference is unknown, because no run repeated a state.",
        ],
        source_label(*(each.run for each in runs)),
        440,
    )


def _difference_panel(
    others: Sequence[tuple[int, AlignedRun]], noise: float | None, title: str, x_title: str, *, in_order: bool
) -> Panel:
    spread = [np.arange(e.difference.size, dtype=float) + 1 if in_order else e.input for _, e in others]
    data = error_ground(np.concatenate(spread), noise, "± 2 σ of a difference")
    for x, (k, each) in zip(spread, others):
        marks = {
            "mode": "markers",
            "marker": {"color": each.colour, "size": 6, "symbol": SYMBOLS[k % len(SYMBOLS)]},
        }
        data.append(_line(k, each, x, each.difference, **marks))
    return Panel(data, {"xaxis": axis(x_title), "yaxis": axis(title)}, 380)


def time_overlay_figure(runs: Sequence[AlignedRun]) -> Figure | None:
    """Current, input and output of each run against the time since its start; None if no run has times."""
    timed = [(k, each) for k, each in enumerate(runs) if each.run.has("t_s")]
    rows = [
        (name, title)
        for name, title in (
            ("current_A", "Current (A)"),
            ("input", input_title(runs[0].run)),
            ("position", output_title(runs[0].run)),
        )
        if any(each.run.has(name) for _, each in timed)
    ]
    if not timed or not rows:
        return None
    spans = [float(np.ptp(each.run["t_s"][np.isfinite(each.run["t_s"])])) for _, each in timed]
    size, unit = time_unit(max(spans))
    data: list[Trace] = []
    layout = stacked_layout([title for _, title in rows], f"Time since the start of each run ({unit})")
    for r, (name, _) in enumerate(rows):
        data += [_timed(k, each, name, size, r) for k, each in timed if each.run.has(name)]
    return Figure(
        [Panel(data, layout, 170 * len(rows) + 60)],
        "Time series of the runs, overlaid.",
        ["Time is measured from the first sample of each run."],
        source_label(*(each.run for each in runs)),
    )


def _timed(k: int, each: AlignedRun, name: str, size: float, row: int) -> Trace:
    t, values = each.run["t_s"], each.run[name]
    kept = envelope(values, POINTS)
    shift = each.offset if name == "position" else 0.0
    begin = t[np.isfinite(t)][0]
    where = {"yaxis": ROWS[row], "showlegend": row == 0, "legendgroup": each.name}
    return _line(k, each, (t[kept] - begin) / size, values[kept] + shift, **where)


def _line(k: int, each: AlignedRun, x: Any, y: Any, **more: Any) -> Trace:
    dash = "solid" if each.colour != COMPARED[k % len(COMPARED)] else DASHES[k]
    return line(x, y, each.name, each.colour, dash=dash, width=1.3, **more)


def is_ordered(runs: Sequence[AlignedRun]) -> bool:
    """Whether the colours of the runs stand for their order over a variable."""
    return len(runs) > 2 and runs[0].colour not in COMPARED


def with_colours(runs: Sequence[AlignedRun], variable: FamilyVariable) -> list[AlignedRun]:
    """The runs with their colours: dark to bright over a load or time of three runs and more, else distinct ones."""
    if len(runs) <= len(COMPARED) and (len(runs) < 3 or not variable.unit):
        return [replace(each, colour=COMPARED[k]) for k, each in enumerate(runs)]
    shades = dict(zip(variable.order, colours(len(runs))))
    return [replace(each, colour=shades[k]) for k, each in enumerate(runs)]


def offsets_text(runs: Sequence[AlignedRun]) -> str:
    """Sentences on how the zeros of the encoder were aligned."""
    unit = display_unit(runs[0].run.unit)
    fitted = [f"{e.name} {number(e.offset)}{spaced(unit)}" for e in runs if e.offset_kind == "fitted"]
    unknown = [e.name for e in runs if e.offset_kind == "unknown"]
    sentences = []
    if cold := [e.name for e in runs if e.offset_kind == "power-up"]:
        sentences.append(
            f"Zeroed at power-up with the wire in the same state as that of {runs[0].name}, so not shifted: "
            f"{', '.join(cold)}."
        )
    if fitted:
        sentences.append(
            f"Each session has its own zero, so one additive offset per run was fitted to the common steps: "
            f"{', '.join(fitted)}."
        )
    if zeroed := [e.name for e in runs if e.offset_kind == "cold"]:
        sentences.append(
            f"Zeroed cold by initialise, as {runs[0].name}, and farther apart than two zeros can be, so not shifted: "
            f"{', '.join(zeroed)}."
        )
    if unknown:
        sentences.append(
            f"Drawn with their own zero, because no step is common with the first run: {', '.join(unknown)}."
        )
    return " ".join(sentences) or "All runs share one encoder zero. None was shifted."


def runs_text(runs: Sequence[AlignedRun]) -> Html:
    """Caption text on each run with its colour; common properties appear once."""
    if len(runs) > _MOST_MARKED:
        return joined([f"{len(runs)} runs."])
    return runs_caption([(each.colour, each.name, each.run) for each in runs])


def runs_caption(runs: Sequence[tuple[str, str, Run]]) -> Html:
    """Caption text on runs given as (colour, name, run)."""
    captions = [[run_caption(run).removesuffix("."), *conditions_text(run).split(", ")] for _, _, run in runs]
    shared = [part for part in captions[0] if all(part in other for other in captions)]
    own = ["; ".join(part for part in parts if part not in shared) for parts in captions]
    each = [
        joined([coloured(colour, name), f": {words}. " if words else ". "])
        for (colour, name, _), words in zip(runs, own)
    ]
    return joined([*each, f"All: {'; '.join(shared)}." if shared else ""])


def coloured_name(k: int, name: str) -> Html:
    """The name of the k-th compared item, with its colour."""
    return coloured(COMPARED[k], name)


def coloured(colour: str, name: str) -> Html:
    """A name with a swatch of its colour."""
    swatch = tag("span", class_="swatch", style=f"color:{colour}", aria_hidden="true")
    return tag("span", swatch, name, class_="named")

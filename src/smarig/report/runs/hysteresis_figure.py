"""The figure of output against input: settled points joined in order, with the direction (Figs. 5.7 to 5.13).

Runs without steps (reversal curves, thermal cycles) are drawn from their samples.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import spaced
from smarig.record import FORC_PROTOCOL, Run
from smarig.report.components.decimate import path
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.components.numbers import number, thousands
from smarig.report.components.run_description import (
    count_size,
    input_title,
    output_title,
    protocol_name,
    run_caption,
    source_label,
)
from smarig.report.components.style import BAD, COOLING, HEATING, INK, colours

Array = NDArray[np.float64]
_GROUPS = 8  # number of distinguishable colours
_MOST = 200  # largest number of settled points with a mark each


def hysteresis_figure(run: Run) -> Figure:
    """The hysteresis graph of any run with an input and an output."""
    settled = run.settled
    if len(settled) >= 2:
        data, words = _step_traces(run)
    else:
        data, words = _sample_traces(run)
    layout: dict[str, Any] = {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}
    size = count_size(run)
    resolution = f"Resolution {size:.3g}{spaced(run.unit)}." if size else ""
    return Figure(
        [Panel(data, layout, 450)],
        f"Hysteresis of the {protocol_name(run)} run.",
        [words, resolution, run_caption(run)],
        source_label(run),
    )


def direction_traces(
    u: Array, y: Array, *, width: float = 1.3, names: tuple[str, str] = ("rising input", "falling input")
) -> list[Trace]:
    """Points joined in order, rising and falling in two colours, with an arrow in the middle of each long segment."""
    du = np.diff(u)
    long = np.hypot(du / (np.ptp(u) or 1), np.diff(y) / (np.ptp(y) or 1)) > 0.06
    traces = []
    for chosen, name, colour in ((du > 0, names[0], HEATING), (du <= 0, names[1], COOLING)):
        k = np.flatnonzero(chosen)
        if not k.size:
            continue
        gap = np.full(k.size, np.nan)
        joined_u, joined_y = (
            np.stack([u[k], u[k + 1], gap], 1).ravel(),
            np.stack([y[k], y[k + 1], gap], 1).ravel(),
        )
        traces.append(line(joined_u, joined_y, name, colour, width=width))
        k = k[long[k]]
        gap = np.full(k.size, np.nan)
        mid_u, mid_y = (np.stack([v[k], (v[k] + 1.2 * v[k + 1]) / 2.2, gap], 1).ravel() for v in (u, y))
        sizes = {"size": [0, 9, 0] * k.size, "angleref": "previous", "line": {"width": 0}}
        traces.append(
            dots(mid_u, mid_y, name, colour, symbol="arrow", marker=sizes, showlegend=False, hoverinfo="skip")
        )
    return traces


def _step_traces(run: Run) -> tuple[list[Trace], str]:
    u, y = run.points()
    verdicts = np.array([step.verdict for step in run.settled])
    good = verdicts == "settled"
    data = direction_traces(u, y)
    single = all(s.n <= 1 for s in run.settled)
    what = "one reading, as recorded" if single else "the mean output over the settle window of one hold"
    if u.size <= _MOST:
        labels = [f"{s.branch} · step {s.index}" for s in run.settled]
        shown = [words for words, keep in zip(labels, good) if keep]
        data.append(
            dots(
                u[good],
                y[good],
                f"{int(good.sum())} {'readings' if single else 'settled points'}",
                INK,
                size=4.5,
                text=_safe(shown),
            )
        )
    words = f"Each point is {what}. Lines join the points in order."
    if not good.all():
        late = int(np.sum(~good))
        data.append(
            dots(u[~good], y[~good], f"{late} points not settled", BAD, symbol="circle-open", size=11)
        )
        words += f" Circles: {late} of {u.size} points that did not settle in time."
    return data, words


def _sample_traces(run: Run) -> tuple[list[Trace], str]:
    u, y = run["input"], run["position"]
    known = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
    curves = _curves(run, known)
    shades = colours(len(curves))
    data = []
    for (name, rows), shade in zip(curves, shades):
        x, z = np.where(rows >= 0, u[rows], np.nan), np.where(rows >= 0, y[rows], np.nan)
        data.append(line(x, z, name, shade, width=1.1))
    order = "reversal input" if _reversal(run) else "order of measurement"
    thinned = sum(rows.size for _, rows in curves) < known.size
    words = f"{thousands(known.size)} readings, coloured by {order} from dark to bright."
    return data, words + (
        " The drawing is thinned but keeps all extremes of input and output." if thinned else ""
    )


def _reversal(run: Run) -> bool:
    return run.info.protocol == FORC_PROTOCOL


def _curves(run: Run, known: NDArray[np.intp]) -> list[tuple[str, NDArray[np.intp]]]:
    """Named groups of row indices, −1 for a gap."""
    if not known.size:
        return []
    step = run["step"][known]
    numbers = np.unique(step[step >= 0])
    if not _reversal(run) or not numbers.size:
        groups = np.array_split(known, min(_GROUPS, max(1, known.size // 20)))
        return [
            (f"readings {g[0] + 1} to {g[-1] + 1}", g[path(run["input"][g], run["position"][g], 1500)])
            for g in groups
        ]
    named = []
    for some in np.array_split(numbers, min(_GROUPS, numbers.size)):
        pieces = [known[step == number] for number in some]
        starts = [float(run["input"][p[0]]) for p in pieces]
        least = max(60, 6000 // max(1, numbers.size))
        thin = [p[path(run["input"][p], run["position"][p], least)] for p in pieces]
        rows = np.concatenate([np.append(p, -1) for p in thin])
        named.append(
            (f"reversal at {number(starts[0], 4)} to {number(starts[-1], 4)}{spaced(run.input_unit)}", rows)
        )
    return named


def _safe(words: list[str]) -> list[str]:
    return [w.replace("&", "&amp;").replace("<", "&lt;") for w in words]

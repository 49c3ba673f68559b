"""The figure of output against input: the path through the samples, and the settled points (Figs. 5.7 to 5.13).

Runs without samples of the motion are drawn from their settled points, joined in order.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.record import FORC_PROTOCOL, Run
from smarig.report.components.decimate import path
from smarig.report.components.figure import Figure, Panel, Trace, dots, line, plotly_escaped
from smarig.report.components.numbers import number, thousands
from smarig.report.components.run_description import (
    count_size,
    loop_axes,
    protocol_name,
    run_caption,
    source_label,
)
from smarig.report.components.style import BAD, COOLING, HEATING, INK, colours
from smarig.report.runs.sample_path import drawn, ends_of_parts, sample_path, uninterrupted_parts

_GROUPS = 8  # number of distinguishable colours
_MOST = 200  # largest number of settled points with a mark each
_SHORTEST_SWEEP = 0.3  # of the ranges: shorter sweeps have no arrow
_MEAN = "the mean output over the settle window of one hold"


def hysteresis_figure(run: Run, *, explore: bool = True) -> Figure:
    """The hysteresis graph of any run with an input and an output; ``explore`` as in Panel."""
    settled = run.settled
    if len(settled) >= 2:
        data, words = _step_traces(run)
    else:
        data, words = _sample_traces(run)
    layout: dict[str, Any] = loop_axes(run)
    size = count_size(run)
    resolution = f"Resolution {size:.3g}{spaced(run.unit)}." if size else ""
    return Figure(
        [Panel(data, layout, 420, explore=explore)],
        f"Hysteresis of the {protocol_name(run)} run.",
        [words, resolution, run_caption(run)],
        source_label(run),
    )


def direction_traces(
    u: Array,
    y: Array,
    *,
    width: float = 1.3,
    names: tuple[str, str] = ("rising input", "falling input"),
    part: NDArray[np.intp] | None = None,
) -> list[Trace]:
    """A path in two colours, rising and falling input, with an arrow in the middle of each long sweep.

    ``part``: the number of the uninterrupted part of each point; no line joins two parts.
    """
    du = np.diff(u)
    joined = np.diff(part) == 0 if part is not None else np.ones(du.size, dtype=bool)
    traces = []
    for chosen, name, colour in ((du > 0, names[0], HEATING), (du <= 0, names[1], COOLING)):
        k = np.flatnonzero(chosen & joined)
        if not k.size:
            continue
        sweeps = np.split(k, np.flatnonzero(np.diff(k) > 1) + 1)
        rows = np.concatenate([[*sweep, sweep[-1] + 1, -1] for sweep in sweeps])
        traces.append(line(drawn(u, rows), drawn(y, rows), name, colour, width=width))
        ends = [_arrow_rows(u, y, sweep) for sweep in sweeps]
        rows = np.concatenate([np.array([], dtype=int), *(end for end in ends if end is not None)])
        if rows.size:
            sizes = {"size": [0, 9, 0] * (rows.size // 3), "angleref": "previous", "line": {"width": 0}}
            look = {"symbol": "arrow", "marker": sizes, "showlegend": False, "hoverinfo": "skip"}
            traces.append(dots(drawn(u, rows), drawn(y, rows), name, colour, **look))
    return traces


def _arrow_rows(u: Array, y: Array, sweep: NDArray[np.intp]) -> NDArray[np.intp] | None:
    """Rows of the two ends of an arrow in the middle of a sweep, and a gap; None if the sweep is short."""
    rows = np.append(sweep, sweep[-1] + 1)
    x, z = u[rows] / (np.ptp(u) or 1), y[rows] / (np.ptp(y) or 1)
    travelled = np.cumsum(np.hypot(np.diff(x, prepend=x[0]), np.diff(z, prepend=z[0])))
    if travelled[-1] < _SHORTEST_SWEEP:
        return None
    head = max(int(np.searchsorted(travelled, travelled[-1] / 2)), 1)
    return np.array([rows[max(head - 4, 0)], rows[head], -1])


def _step_traces(run: Run) -> tuple[list[Trace], str]:
    u, y = run.points()
    good = np.array([step.verdict for step in run.settled]) == "settled"
    single = all(s.n <= 1 for s in run.settled)
    kept = np.array([], dtype=int) if single else sample_path(run["input"], run["position"], count_size(run))
    if kept.size > u.size:
        part = uninterrupted_parts(run)
        kept = np.union1d(kept, _known(run, ends_of_parts(part)))
        data = direction_traces(run["input"][kept], run["position"][kept], part=part[kept])
        words = f"Lines: the path through all samples. Each point is {_MEAN}."
    else:
        data = direction_traces(u, y)
        words = f"Each point is {'one reading, as recorded' if single else _MEAN}. Lines join the points in order."
    if u.size <= _MOST:
        labels = [f"{s.branch} · step {s.index}" for s in run.settled]
        shown = [plotly_escaped(words) for words, keep in zip(labels, good) if keep]
        name = f"{int(good.sum())} {'readings' if single else 'settled points'}"
        data.append(dots(u[good], y[good], name, INK, size=4.5, text=shown))
    if not good.all():
        late = int(np.sum(~good))
        data.append(
            dots(u[~good], y[~good], f"{late} points not settled", BAD, symbol="circle-open", size=11)
        )
        words += f" Circles: {late} of {u.size} points that did not settle in time."
    return data, words


def _known(run: Run, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of the rows at which input and output are known."""
    return rows[np.isfinite(run["input"][rows] + run["position"][rows])]


def _sample_traces(run: Run) -> tuple[list[Trace], str]:
    u, y = run["input"], run["position"]
    known = _known(run, np.arange(len(run)))
    curves = _curves(run, known)
    shades = colours(len(curves))
    data = []
    for (name, rows), shade in zip(curves, shades):
        data.append(line(drawn(u, rows), drawn(y, rows), name, shade, width=1.1))
    order = "reversal input" if _reversal(run) else "order of measurement"
    thinned = sum(np.count_nonzero(rows >= 0) for _, rows in curves) < known.size
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
        part = uninterrupted_parts(run)
        return [(f"readings {g[0] + 1} to {g[-1] + 1}", _thinned(run, g, part)) for g in groups]
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


def _thinned(run: Run, rows: NDArray[np.intp], part: NDArray[np.intp]) -> NDArray[np.intp]:
    """Rows of a path with nearly the same shape, −1 at a gap of the record."""
    pieces = np.split(rows, np.flatnonzero(np.diff(part[rows])) + 1)
    thin = [p[path(run["input"][p], run["position"][p], 1500)] for p in pieces]
    return np.concatenate([np.append(p, -1) for p in thin])[:-1]

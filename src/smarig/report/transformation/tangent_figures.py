"""Figures of transformation temperatures: a full loop with its tangents, and trends over cycles and over stress."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from smarig.core import Array, spaced
from smarig.identification import Estimate
from smarig.report.components.decimate import path
from smarig.report.components.figure import Figure, Panel, Trace, axis, cross, dots, error_bars, line
from smarig.report.components.run_description import (
    display_unit,
    loop_axes,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import COMPARED, COOLING, DASHES, FAINT, GREY, HEATING, INK, SYMBOLS
from smarig.transformation import (
    CORNERS,
    DECADE,
    TEMPERATURES,
    BranchTangents,
    CycleFigures,
    Drawn,
    RunFigures,
    StressSlope,
)

Gap = tuple[float, float]
_BEYOND = 0.12  # of its length: how far a tangent is drawn beyond its corners
_MOST_BEHIND = 4000  # readings of the other cycles, thinned
_LABELS = {"A_s": "A<sub>s</sub>", "A_f": "A<sub>f</sub>", "M_s": "M<sub>s</sub>", "M_f": "M<sub>f</sub>"}


def tangent_figure(run: RunFigures) -> Figure:
    """The last whole cycle of a run with its tangents, before the other readings of the run."""
    cycle = [c for c in run.cycles if c.whole][-1]
    gaps = [gap for branch in (cycle.heating, cycle.cooling) if branch for gap in branch.gaps]
    data = [_behind(run, gaps), *_branch_traces(cycle), *_corner_traces(cycle, run)]
    layout = loop_axes(run.run) | {"yaxis": axis(_output_title(run))}
    others = len(run.cycles) - 1
    behind = f"Grey: all readings, {others + 1} cycles." if others else "Grey: all readings."
    return Figure(
        [Panel(data, layout, 480)],
        f"Cycle {cycle.number} of {run.name} with its tangents.",
        [
            "Dashed: the tangents to both plateaus and to the steepest part of each branch, of one choice of their "
            "readings. Crosses: where they meet, as the mean over all choices; bars: 95 % intervals of this cycle, "
            "which contain the choice.",
            "A line is interrupted where readings are missing." if gaps else "",
            behind,
            run_caption(run.run),
        ],
        source_label(run.run),
    )


def _output_title(run: RunFigures) -> str:
    """What the vertical axis shows: the output, or its logarithm."""
    title = output_title(run.run)
    return f"Logarithm (base 10) of {title[:1].lower()}{title[1:]}" if run.record.unit == DECADE else title


def _behind(run: RunFigures, gaps: Sequence[Gap]) -> Trace:
    kept = path(run.record.u, run.record.y, _MOST_BEHIND)
    u, y = _interrupted(run.record.u[kept], run.record.y[kept], gaps)
    return line(u, y, "all readings", FAINT, width=1, hoverinfo="skip")


def _interrupted(u: Array, y: Array, gaps: Sequence[Gap]) -> tuple[Array, Array]:
    """The path (n,) with NaN between two points that have a gap between them."""
    low, high = np.minimum(u[:-1], u[1:]), np.maximum(u[:-1], u[1:])
    across = np.zeros(low.size, dtype=bool)
    for begin, end in gaps:
        across |= (low <= begin) & (high >= end)
    at = np.flatnonzero(across) + 1
    return np.insert(u, at, np.nan), np.insert(y, at, np.nan)


def _branch_traces(cycle: CycleFigures) -> Iterator[Trace]:
    for direction, colour in (("heating", HEATING), ("cooling", COOLING)):
        branch: BranchTangents = getattr(cycle, direction)
        kept = path(branch.u, branch.y)
        yield line(*_interrupted(branch.u[kept], branch.y[kept], branch.gaps), direction, colour, width=1.8)
        lines = list(_tangents(branch))
        u = np.concatenate([[*ends, np.nan] for ends, _ in lines])
        y = np.concatenate([[*levels, np.nan] for _, levels in lines])
        yield line(u, y, f"tangents, {direction}", INK, dash="dash", width=1.1, hoverinfo="skip")


def _tangents(branch: BranchTangents) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The ends (u, y) of each tangent: plateaus from the end of the branch, the steep part between its corners."""
    corners = [c for c in (branch.low, branch.high) if c]
    size = float(np.ptp(branch.u))
    for corner, end in ((branch.low, branch.u.min()), (branch.high, branch.u.max())):
        if corner:
            way = corner.value - float(end)
            u = np.array([float(end), corner.value + np.sign(way) * _BEYOND * min(abs(way), 0.3 * size)])
            yield u, corner.plateau.a + corner.plateau.b * u
    levels = [c.output for c in corners] or [float(branch.y[0]), float(branch.y[-1])]
    if len(levels) == 1:
        levels.append(2 * branch.steep.y - levels[0])
    low, high = min(levels), max(levels)
    y = np.array([low - _BEYOND * (high - low), high + _BEYOND * (high - low)])
    yield branch.steep.u + branch.steep.du_dy * (y - branch.steep.y), y


def _corner_traces(cycle: CycleFigures, run: RunFigures) -> Iterator[Trace]:
    for name in TEMPERATURES:
        if name not in cycle.figures:
            continue
        direction, side = CORNERS[name]
        corner = getattr(getattr(cycle, direction), side)
        low, high = cycle.figures[name].ci95
        bars = error_bars([corner.value], [low], [high], color=GREY, thickness=1.4, width=4)
        value = f"{round(corner.value, 1) + 0.0:.1f}".replace("-", "−")  # zero has no sign
        words = f"{value}{spaced(display_unit(run.record.input_unit))}"
        yield cross(
            corner.value,
            corner.output,
            name,
            HEATING if direction == "heating" else COOLING,
            size=9,
            error_x=bars,
            mode="markers+text",
            text=[f"{_LABELS[name]} {words}"],
            textposition=_placement(direction, getattr(cycle, direction)),
            showlegend=False,
        )


def _placement(direction: str, branch: BranchTangents) -> str:
    """Outside the loop: right of the heating branch, left of the cooling branch, away from their plateaus."""
    above = (branch.y[-1] > branch.y[0]) != (direction == "heating")
    return f"{'top' if above else 'bottom'} {'right' if direction == 'heating' else 'left'}"


_COLOURS = {"A_s": COMPARED[4], "A_f": COMPARED[1], "M_s": COMPARED[0], "M_f": COMPARED[5]}
_FEWEST_CYCLES = 3


def cycles_figure(run: RunFigures) -> Figure | None:
    """The temperatures and the stroke of each cycle with their intervals; None for fewer than three cycles."""
    if len(run.cycles) < _FEWEST_CYCLES:
        return None
    data = [
        t for name in TEMPERATURES for t in estimate_traces(name, [(c.number, c.figures) for c in run.cycles])
    ]
    data += [
        line(
            *_fitted(run, name), "", _COLOURS[name], dash="dash", width=1, showlegend=False, hoverinfo="skip"
        )
        for name in TEMPERATURES
        if name in run.drift
    ]
    stroke = list(estimate_traces("stroke", [(c.number, c.figures) for c in run.cycles]))
    return Figure(
        [
            Panel(data, {"xaxis": axis("Cycle"), "yaxis": axis(_title(run))}, 430),
            Panel(
                stroke,
                {"xaxis": axis("Cycle"), "yaxis": axis(f"Stroke ({display_unit(run.record.unit)})")},
                430,
            ),
        ],
        f"Temperatures and stroke of each cycle of {run.name}.",
        [
            "Bars: 95 % intervals of one cycle, which contain the choice of the tangents' readings. Dashed: the drift."
        ],
        source_label(run.run),
    )


def stress_figure(runs: Sequence[RunFigures], slopes: Sequence[StressSlope]) -> Figure | None:
    """The temperatures against the stress, with the fitted lines; None without one."""
    if not slopes:
        return None
    data: list[Trace] = []
    for name in TEMPERATURES:
        points = [(r.stress_MPa, r.means) for r in runs if r.stress_MPa is not None]
        data += estimate_traces(name, points)
    for s in slopes:
        x = np.array(s.stress_range_MPa)
        sign = 1.0 if s.load == "tension" else -1.0
        y = s.at_zero + s.dT_dstress_K_per_MPa * x
        data.append(
            line(sign * x, y, "", _COLOURS[s.temperature], dash=DASHES[1], width=1.2, showlegend=False)
        )
    return Figure(
        [Panel(data, {"xaxis": axis("Stress (MPa)"), "yaxis": axis(_title(runs[0]))}, 430)],
        "Transformation temperatures against stress.",
        ["Bars: 95 % intervals. Dashed: T = T₀ + |σ|/C, whose slope is 1/C."],
        source_label(*(r.run for r in runs)),
    )


def estimate_traces(
    name: str, points: Sequence[tuple[float, Mapping[str, Drawn] | Mapping[str, Estimate]]]
) -> Iterator[Trace]:
    """The marks of one figure over a variable, with its 95 % intervals; none if no point has it."""
    own = [(x, figures[name]) for x, figures in points if name in figures]
    if not own:
        return
    values = np.array([d.value for _, d in own])
    ends = np.array([d.ci95 for _, d in own])
    bars = error_bars(values, ends[:, 0], ends[:, 1], thickness=1, width=2)
    symbol = SYMBOLS[TEMPERATURES.index(name)] if name in TEMPERATURES else SYMBOLS[0]
    colour = _COLOURS.get(name, COMPARED[6])
    trace = dots([x for x, _ in own], values, "", colour, symbol=symbol, size=6, error_y=bars)
    yield trace | {"name": _LABELS.get(name, "stroke")}


def _fitted(run: RunFigures, name: str) -> tuple[list[float], list[float]]:
    numbers = [c.number for c in run.cycles if name in c.figures]
    middle, slope = float(np.mean(numbers)), run.drift[name].value
    ends = [float(min(numbers)), float(max(numbers))]
    return ends, [run.means[name].value + slope * (k - middle) for k in ends]


def _title(run: RunFigures) -> str:
    above = "Temperature above ambient" if run.record.above_ambient else "Temperature"
    return f"{above} ({display_unit(run.record.input_unit)})"

"""Transformation temperatures over cycles, and over stress with the fitted lines."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from smarig.identification import Estimate
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.components.style import COMPARED, DASHES, SYMBOLS
from smarig.transformation import TEMPERATURES, Drawn, RunFigures, StressSlope

_LABELS = {"A_s": "A<sub>s</sub>", "A_f": "A<sub>f</sub>", "M_s": "M<sub>s</sub>", "M_f": "M<sub>f</sub>"}
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
    bars = {
        "type": "data",
        "symmetric": False,
        "array": (ends[:, 1] - values).tolist(),
        "arrayminus": (values - ends[:, 0]).tolist(),
        "thickness": 1,
        "width": 2,
    }
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

"""Wiping-out and congruency: two curves superposed, and their difference against its noise (Figs. 5.7 to 5.10)."""

import numpy as np

from smarig.identification.representation import Representation
from smarig.record import Run
from smarig.report.conditions import input_title, label_of, output_title, place
from smarig.report.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.style import FIRST, GREY, INK, SECOND

_NAMES = {
    "wiping_out": ("segment A", "segment B", "Wiping-out: segment B over segment A."),
    "congruency": ("minor loop A", "minor loop B", "Congruency: two minor loops over the same inputs."),
}


def representation_figure(test: Representation, run: Run) -> Figure:
    """Both curves on the left, second minus first with the noise band on the right."""
    first, second, title = _NAMES[test.name]
    relative = test.name == "congruency"
    y_title = f"{output_title(run)}{', from the lower corner' if relative else ''}"
    # Congruency's points are stored branch by branch; a loop is falling, then rising, so they join as they stand.
    curves = [
        line(test.input, test.first, first, FIRST, mode="lines+markers", width=2),
        line(test.input, test.second, second, SECOND, mode="lines+markers", width=1.4, dash="dash"),
    ]
    curves[1]["marker"] = {"symbol": "circle-open", "size": 9}
    layout = {"xaxis": axis(input_title(run)), "yaxis": axis(y_title)}
    shift = (
        f" The corners lie {test.offset:.3g} {test.unit} apart; Preisach memory allows that, only the shape must agree."
        if relative
        else ""
    )
    return Figure(
        [Panel(curves, layout), _difference(test, run, f"{second} − {first}")],
        title,
        [
            f"Left: both curves; right: their difference ({test.input.size} pairs of points) against the input. Band: ± 2 "
            f"standard deviations of a difference by the points' own noise ({test.noise:.2g} {test.unit})"
            + (f"; dotted: ± 1 count ({test.per_count:.3g} {test.unit})." if test.per_count else ".")
            + shift,
            place(run),
        ],
        label_of(run),
        440,
    )


def _difference(test: Representation, run: Run, title: str) -> Panel:
    low, high = float(test.input.min()), float(test.input.max())
    data: list[Trace] = [dots(test.input, test.second - test.first, "difference", INK, size=7)]
    data.append(band(low, high, 2 * test.noise, "± 2 σ of the noise"))
    reach = 1.15 * max(test.max_abs, 2.2 * test.noise, test.per_count)
    for k, level in enumerate((test.per_count, -test.per_count) if test.per_count else ()):
        data.append(line([low, high], [level] * 2, "± 1 count", GREY, dash="dot", width=1, showlegend=k == 0))
    layout = {
        "xaxis": axis(input_title(run)),
        "yaxis": axis(f"{title} ({test.unit})", range=[-reach, reach]),
    }
    return Panel(data, layout)


def band(low: float, high: float, half: float, name: str) -> Trace:
    """A grey band of ± half from low to high."""
    edge = np.array([low, high, high, low, low])
    return line(
        edge,
        [-half, -half, half, half, -half],
        name,
        GREY,
        width=0,
        fill="toself",
        fillcolor="rgba(107,114,128,.18)",
        hoverinfo="skip",
    )

"""Wiping-out and congruency: two curves superposed, and their difference against its noise (Figs. 5.7 to 5.10)."""

import numpy as np

from smarig.identification import Representation
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.components.run_description import input_title, output_title, run_caption, source_label
from smarig.report.components.style import FIRST, GREY, INK, SECOND

_NAMES = {
    "wiping_out": ("segment A", "segment B", "Wiping-out: segment B over segment A."),
    "congruency": ("minor loop A", "minor loop B", "Congruency: two minor loops over the same inputs."),
}


def representation_figure(test: Representation, run: Run) -> Figure:
    """Both curves on the left, second minus first with the noise band on the right."""
    first, second, title = _NAMES[test.name]
    relative = test.name == "congruency"
    y_title = f"{output_title(run)}{', from the lower corner' if relative else ''}"
    # A minor loop's points are its falling, then its rising branch: the last one is the corner they begin at.
    k = np.arange(test.input.size) if not relative else np.append(-1, np.arange(test.input.size))
    curves = [
        line(test.input[k], test.first[k], first, FIRST, mode="lines+markers", width=2),
        line(test.input[k], test.second[k], second, SECOND, mode="lines+markers", width=1.4, dash="dash"),
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
            f"First panel: both curves; second: their difference ({test.input.size} pairs of points) against the "
            f"input. Band: ± 2 standard deviations of a difference by the points' own noise "
            f"({test.noise:.2g} {test.unit})"
            + f".{count_text(test.per_count, _half_range(test), test.unit)}{shift}",
            run_caption(run),
        ],
        source_label(run),
        440,
    )


def _half_range(test: Representation) -> float:
    return 1.2 * max(test.max_abs, 2 * test.noise)


def _difference(test: Representation, run: Run, title: str) -> Panel:
    low, high = float(test.input.min()), float(test.input.max())
    half_range = _half_range(test)
    data: list[Trace] = [
        noise_band(low, high, 2 * test.noise, "± 2 σ of the noise"),
        *count_lines(low, high, test.per_count, half_range),
        dots(test.input, test.second - test.first, "difference", INK, size=7),
    ]
    if test.per_count and test.per_count < 3 * half_range:
        half_range = max(half_range, 1.2 * test.per_count)
    return Panel(
        data,
        {
            "xaxis": axis(input_title(run)),
            "yaxis": axis(f"{title} ({test.unit})", range=[-half_range, half_range]),
        },
    )


def count_lines(low: float, high: float, count: float, half_range: float) -> list[Trace]:
    """Dotted lines at ± 1 count, where they would not squeeze what is shown up to ± reach."""
    if not 0 < count < 3 * half_range:
        return []
    return [
        line([low, high], [level] * 2, "± 1 count", GREY, dash="dot", width=1, showlegend=level > 0)
        for level in (count, -count)
    ]


def count_text(count: float, half_range: float, unit: str) -> str:
    """The same in words; off the scale where the lines are left out."""
    if not count:
        return ""
    return f" {'Dotted: ±' if count < 3 * half_range else 'Off the scale:'} 1 count ({count:.3g} {unit})."


def noise_band(low: float, high: float, half: float, name: str) -> Trace:
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

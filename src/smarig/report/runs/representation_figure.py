"""Figures of wiping-out and congruency: two curves, and their difference with its noise (Figs. 5.7 to 5.10)."""

import numpy as np

from smarig.core import spaced
from smarig.identification import Representation
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line, zero_line
from smarig.report.components.run_description import input_title, output_title, run_caption, source_label
from smarig.report.components.style import FIRST, GREY, INK, SECOND

_NAMES = {
    "wiping_out": ("segment A", "segment B", "Wiping-out: segments A and B."),
    "congruency": ("minor loop A", "minor loop B", "Congruency: two minor loops between the same inputs."),
}


def representation_figure(test: Representation, run: Run) -> Figure:
    """Both curves in the first panel, second − first with the noise band in the second."""
    first, second, title = _NAMES[test.name]
    relative = test.name == "congruency"
    y_title = f"{output_title(run)}{', relative to the lower corner' if relative else ''}"
    # The points of a minor loop are its falling branch, then its rising branch, which ends at the upper corner.
    k = np.arange(test.input.size) if not relative else np.append(-1, np.arange(test.input.size))
    curves = [
        line(test.input[k], test.first[k], first, FIRST, mode="lines+markers", width=2),
        line(test.input[k], test.second[k], second, SECOND, mode="lines+markers", width=1.4, dash="dash"),
    ]
    curves[1]["marker"] = {"symbol": "circle-open", "size": 9}
    layout = {"xaxis": axis(input_title(run)), "yaxis": axis(y_title)}
    shift = (
        f" The corners of the two loops differ by {test.offset:.3g}{spaced(test.unit)}. Congruency "
        "permits that; only the "
        "shapes must agree."
        if relative
        else ""
    )
    return Figure(
        [Panel(curves, layout), _difference(test, run, f"{second} − {first}")],
        title,
        [
            f"First panel: both curves. Second panel: their difference ({test.input.size} pairs of points) against the "
            f"input{_left_out(test)}. Bars: ± 2 σ of each difference, in the mean σ = {test.noise:.2g}"
            f"{spaced(test.unit)}. The test weighs each point by its own σ"
            + f".{count_text(test.per_count, _half_range(test), test.unit)}{shift}",
            run_caption(run),
        ],
        source_label(run),
        440,
    )


def _half_range(test: Representation) -> float:
    difference = np.abs(test.second - test.first - test.common)
    return 1.1 * float(np.max(difference + 2 * test.spread))


def _left_out(test: Representation) -> str:
    """What the noise of the corner adds to all points alike."""
    if not test.common:
        return ""
    return (
        f", without the {test.common:.2g}{spaced(test.unit)} that the noise of the corner adds to all points"
    )


def _difference(test: Representation, run: Run, title: str) -> Panel:
    low, high = float(test.input.min()), float(test.input.max())
    half_range = _half_range(test)
    data: list[Trace] = [
        zero_line(low, high),
        *count_lines(low, high, test.per_count, half_range),
        dots(
            test.input,
            test.second - test.first - test.common,
            "difference ± 2 σ",
            INK,
            size=6,
            error_y={
                "type": "data",
                "array": (2 * test.spread).tolist(),
                "color": GREY,
                "thickness": 1.2,
                "width": 3,
            },
        ),
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
    """Dotted lines at ± 1 count, unless they are far outside ± ``half_range``."""
    if not 0 < count < 3 * half_range:
        return []
    return [
        line([low, high], [level] * 2, "± 1 count", GREY, dash="dot", width=1, showlegend=level > 0)
        for level in (count, -count)
    ]


def count_text(count: float, half_range: float, unit: str) -> str:
    """A sentence on the lines at ± 1 count, or on the count size if they are outside the axis."""
    if not count:
        return ""
    size = f"1 count ({count:.3g}{spaced(unit)})"
    return f" Dotted: ± {size}." if count < 3 * half_range else f" {size} is off the scale."

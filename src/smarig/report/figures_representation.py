"""Figures of the two tests of representation (§5.3): curves superposed, and their difference with its noise."""

import numpy as np

from smarig.identification.representation import Representation
from smarig.report.figure import Figure, Panel, axis, dots, line
from smarig.report.style import FIRST, INK, SECOND

_NAMES = {
    "wiping_out": ("Wiping-out (Figs 5.7, 5.8).", "segment A", "segment B"),
    "congruency": ("Congruency (Figs 5.9, 5.10).", "loop A", "loop B"),
}


def superposed(test: Representation, twin: bool) -> Figure:
    """First and second curve over the input; their difference point by point, with ±3 × noise."""
    title, first, second = _NAMES[test.name]
    left = Panel(
        [
            line(test.input, test.first, first, FIRST, mode="lines+markers", marker={"size": 9, "symbol": "circle-open"}),
            line(test.input, test.second, second, SECOND, mode="lines+markers", marker={"size": 5}, dash="dot"),
        ],
        {"xaxis": axis("wire temperature above ambient (K)"), "yaxis": axis(_output(test))},
        380,
    )
    order = np.arange(1, test.input.size + 1)
    edge = 3 * test.noise
    band = {"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "y0": -edge, "y1": edge, "layer": "below"}
    right = Panel(
        [dots(order, test.second - test.first, "difference", INK, size=7, showlegend=False)],
        {
            "xaxis": axis("point, in the order of measurement"),
            "yaxis": axis(f"{second} − {first} ({test.unit})", range=_around(test, edge)),
            "shapes": [band | {"fillcolor": "#e3e7ec", "line": {"width": 0}}],
        },
        380,
    )
    shifted = (
        f"Both loops are drawn from their lower corner; the corners lie {test.offset:.3g} {test.unit} apart."
        if test.name == "congruency"
        else ""
    )
    caption = [test.verdict, shifted, f"Grey: ± 3 × noise of a difference; n = {test.input.size} pairs.", test.meaning]
    return Figure([left, right], title, caption, twin, 460)


def _output(test: Representation) -> str:
    word = "angle" if test.unit == "deg" else "displacement"
    return f"{word} from the lower corner ({test.unit})" if test.name == "congruency" else f"{word} ({test.unit})"


def _around(test: Representation, edge: float) -> list[float]:
    reach = 1.3 * max(edge, test.max_abs)
    return [-reach, reach]

"""Rivals: the explanations that competed last, and the candidates that gain most by themselves.

Knows nothing of the data that they explain.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from smarig.diagnosis.critique import Score
from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.verdict import TEMPERATURE
from smarig.report.candidate_rows import GENERIC, NAMED, called, layout_of_rows, nats, places, singles
from smarig.report.conditions import label_of
from smarig.report.diagnosed import Array, place_of
from smarig.report.figure import Figure, Panel, Trace, packed


def rivals_figure(d: Diagnosis) -> Figure:
    """Explanations of the last level by nats behind the best; single candidates by gain beyond chance."""
    panels, behind = [_bars(singles(d))], ""
    if d.levels:
        level = d.levels[-1]
        lead = [level.lead(k) for k in range(len(level.explanations))]
        panels.insert(0, _behind([" + ".join(r.names) for r in level.explanations], lead))
        behind = (
            "First panel: the explanations that competed last, all parameters fitted, by how many nats (units of log "
            f"likelihood) they fit worse than the best; {TEMPERATURE:g} nats cost a factor e in probability. "
            "Second panel, by another measure (the noise as believed before any effect was in):"
        )
    each = "each candidate by itself" if behind else "Each candidate by itself"
    return Figure(
        panels,
        "Rivals: what else could explain it.",
        [
            behind,
            f"{each} on the first critique, weak and in proportion: gain in log likelihood beyond the median of its "
            "gain on nulls. Blue: an effect of the catalogue; vermilion: a smooth function of a variable, which names "
            "no cause. Axes: linear near 0, logarithmic beyond.",
            *place_of(d),
        ],
        label_of(*d.story.runs),
        460,
    )


def _behind(names: Sequence[str], lead: Sequence[float]) -> Panel:
    rows = places(len(names))
    texts = ["best" if v <= 0 else nats(v) for v in lead]
    data = [_bar(lead, rows, NAMED, texts)]
    return Panel(
        data, layout_of_rows(names, rows, "Nats behind the best explanation", [0.0, *lead]), _high(len(names))
    )


def _bars(scores: Sequence[Score]) -> Panel:
    rows = places(len(scores))
    net = [s.net for s in scores]
    colour = [GENERIC if s.candidate.generic else NAMED for s in scores]
    data = [_bar(net, rows, colour, [nats(v) for v in net])]
    names = [called(s) for s in scores]
    return Panel(
        data, layout_of_rows(names, rows, "Gain beyond chance (nats)", [0.0, *net]), _high(len(names))
    )


def _bar(values: Sequence[float], rows: Array, colour: Any, texts: Sequence[str]) -> Trace:
    return {
        "type": "bar",
        "orientation": "h",
        "x": packed(np.arcsinh(values)),
        "y": packed(rows),
        "text": list(texts),
        "textposition": "outside",
        "cliponaxis": False,
        "marker": {"color": colour},
        "width": 0.6,
        "hoverinfo": "text",
        "showlegend": False,
    }


def _high(rows: int) -> int:
    return 110 + 30 * rows

"""Detection: the gain of every candidate against its own nulls and against the threshold of all.

Knows nothing of what is concluded from it.
"""

from collections.abc import Sequence

import numpy as np

from smarig.diagnosis.critique.critique import MIN_SPREAD_NATS, CandidateScore
from smarig.diagnosis.diagnose import Diagnosis
from smarig.report.candidate_rows import GENERIC, NAMED, candidate_name, nats_text, rows_layout
from smarig.report.diagnosis_predictions import Array, diagnosis_caption
from smarig.report.figure import Figure, Panel, Trace, dots, line
from smarig.report.run_description import source_label
from smarig.report.style import GREY, INK

_MARK_PX = 24  # high is the mark that nothing was measured: a legend stands above it


def detection_figure(d: Diagnosis) -> Figure:
    """Every candidate's gain, standardised by its own null, against the threshold of their largest."""
    testable = sorted((s for s in d.first.scores if s.candidate.traces.shape[1]), key=lambda s: s.standard)
    top, rows = d.first.threshold, np.arange(float(len(testable)))
    data: list[Trace] = [
        _vertical_band(0, 1, len(testable)),
        line(
            np.arcsinh([top, top]),
            [-0.7, len(testable) - 0.3],
            f"threshold, α = {d.alpha:g}",
            INK,
            dash="dash",
        ),
        _scores(testable, rows, generic=False),
        _scores(testable, rows, generic=True),
    ]
    title = "Gain (1: 95 % point of own null)"
    layout = rows_layout(
        [candidate_name(s) for s in testable], rows, title, [-1.0, top, *(s.standard for s in testable)]
    )
    layout |= {
        "showlegend": True,
        "legend": {"orientation": "h", "x": 0, "y": 1 + _MARK_PX / (17 * len(testable)), "yanchor": "bottom"},
    }
    above = sum(s.standard > top for s in testable)
    return Figure(
        [Panel(data, layout, 130 + 17 * len(testable), wide=True)],
        "Detection: is anything wrong at all?",
        [
            f"Each of {len(testable)} candidates by its gain over the base model, (g − median)/(95 % point − "
            "median) of "
            f"its own gains on {d.nulls} nulls: the base model's timeline simulated again with noise and nothing "
            "injected. "
            f"Band: from a null's median (0) to its 95 % point (1; at least {MIN_SPREAD_NATS:g} nats, units of "
            "log likelihood).",
            f"Dashed: {top:.3g}, which the largest of all candidates exceeds in {100 * d.alpha:g} % of nulls, so many "
            f"candidates do not make a false alarm likelier. Above it: {above}. p = {d.first.p_value:.2g}, "
            f"where {1 / (d.nulls + 1):.2g} is the least that {d.nulls} nulls can resolve.",
            "Axis: linear near 0, logarithmic beyond.",
            *diagnosis_caption(d),
        ],
        source_label(*d.timeline.runs),
    )


def _scores(testable: Sequence[CandidateScore], rows: Array, *, generic: bool) -> Trace:
    """The named or the generic candidates as dots, with their numbers to hover over."""
    mine = [(s, row) for s, row in zip(testable, rows.tolist()) if s.candidate.generic is generic]
    words = [f"{candidate_name(s)}: {s.standard:.3g} of its null, {nats_text(s.net)} nats" for s, _ in mine]
    name, colour = ("depends on a variable", GENERIC) if generic else ("effect of the catalogue", NAMED)
    x, y = [np.arcsinh(s.standard) for s, _ in mine], [row for _, row in mine]
    return dots(x, y, name, colour, size=8, text=words, hoverinfo="text")


def _vertical_band(low: float, high: float, rows: int) -> Trace:
    x = np.arcsinh([low, high, high, low, low])
    y = np.array([-0.7, -0.7, rows - 0.3, rows - 0.3, -0.7])
    fill = {"fill": "toself", "fillcolor": "rgba(107,114,128,.18)", "hoverinfo": "skip"}
    return line(x, y, "null: median to 95 %", GREY, width=0, **fill)

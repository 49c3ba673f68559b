"""Detection figures: the gain of each candidate relative to its null data and to the threshold, and similar effects."""

from collections.abc import Sequence

import numpy as np
from scipy.cluster.hierarchy import leaves_list, linkage
from scipy.spatial.distance import squareform

from smarig.diagnosis import (
    CALIBRATION_BOXES,
    IMITATION_THRESHOLD,
    MIN_SPREAD_NATS,
    CandidateScore,
    Diagnosis,
    VisibilityTable,
    p_text,
)
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line, packed
from smarig.report.components.run_description import source_label
from smarig.report.components.style import GREY, INK, SEQUENCE
from smarig.report.diagnosis.candidate_rows import GENERIC, NAMED, candidate_name, nats_text, rows_layout
from smarig.report.diagnosis.diagnosis_predictions import Array, diagnosis_caption

_MARK_PX = 24  # height of the label of simulated data; the legend is above it


def detection_figure(d: Diagnosis) -> Figure:
    """The gain of each candidate, standardised by its null data, with the threshold for the largest gain."""
    testable = sorted((s for s in d.first.scores if s.candidate.traces.shape[1]), key=lambda s: s.standard)
    top, rows = d.first.alarm_threshold, np.arange(float(len(testable)))
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
    title = "Gain (1: 95 % point of its nulls)"
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
        "Detection: does any candidate exceed the threshold?",
        [
            f"The gain g of each of {len(testable)} candidates over the base model, as (g − median)/(95 % point − "
            f"median). Median and 95 % point are those of the candidate's gains on {d.nulls} null data sets, which are "
            "simulated from the base model with noise and without effects. "
            f"Band: from the median (0) to the 95 % point (1; at least {MIN_SPREAD_NATS:g} nats, units of log "
            "likelihood).",
            f"Dashed: {top:.3g}, the threshold that the largest gain exceeds in {100 * d.alpha:g} % of "
            f"{CALIBRATION_BOXES} simulated wires without an effect, whose density is misfitted as well. "
            "The rate of false alarms therefore does not depend on the number of candidates. "
            f"Above it: {above}. p {p_text(d.first.calibrated_p)}.",
            "Axis: linear near 0, logarithmic beyond.",
            *diagnosis_caption(d),
        ],
        source_label(*d.timeline.runs),
    )


def _scores(testable: Sequence[CandidateScore], rows: Array, *, generic: bool) -> Trace:
    """The named or the generic candidates as dots, with their numbers as hover text."""
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


def similar_effects_figure(v: VisibilityTable, d: Diagnosis) -> Figure | None:
    """The share of each effect's evidence that other effects could explain; None with fewer than two effects."""
    shown = [k for k, delta in enumerate(v.delta) if delta > 0]
    if len(shown) < 2:
        return None
    share = v.imitated[np.ix_(shown, shown)]
    order = _cluster_order(share)
    share, names = share[np.ix_(order, order)], [v.names[shown[k]] for k in order]
    texts = [
        [f"{100 * s:.0f}" if s >= 0.3 and i != j else "" for j, s in enumerate(row)]
        for i, row in enumerate(share)
    ]
    data: list[Trace] = [
        {
            "type": "heatmap",
            "z": packed(share, single=True),
            "x": names,
            "y": names,
            "zmin": 0,
            "zmax": 1,
            "colorscale": SEQUENCE,
            "text": texts,
            "texttemplate": "%{text}",
            "textfont": {"size": 10},
            "xgap": 1,
            "ygap": 1,
            "colorbar": {"title": {"text": "share", "side": "right"}, "thickness": 12},
            "hovertemplate": "%{x} explains %{z:.2f} of the evidence of %{y}<extra></extra>",
        }
    ]
    layout = {
        "xaxis": axis("… could be explained by this effect", tickangle=-60, ticks="", showgrid=False),
        "yaxis": axis("Evidence of this effect …", autorange="reversed", ticks="", showgrid=False),
    }
    return Figure(
        [Panel(data, layout, 200 + 24 * len(names), wide=True, min_width_px=240 + 20 * len(names))],
        "Similar effects: the share of an effect's evidence in these data that another effect could explain.",
        [
            "0: nothing in common; 1: not distinguishable by these data. Numbers: per cent, from 30 %. "
            f"Effects with {100 * IMITATION_THRESHOLD:.0f} % or more form one group. Computed for weak effects, after "
            "removal of everything that a new density could explain, and without the readings except for their noise "
            "level.",
            *diagnosis_caption(d),
        ],
        source_label(*d.timeline.runs),
    )


def _cluster_order(share: Array) -> list[int]:
    dissimilarity = 1 - np.clip((share + share.T) / 2, 0, 1)
    np.fill_diagonal(dissimilarity, 0.0)
    return leaves_list(
        linkage(squareform(dissimilarity, checks=False), "average", optimal_ordering=True)
    ).tolist()

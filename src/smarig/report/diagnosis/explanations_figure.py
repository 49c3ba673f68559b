"""The figure of competing explanations and of the single candidates with the largest gains."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from smarig.diagnosis import CandidateScore, Diagnosis, lead_scale_nats
from smarig.report.components.figure import Figure, Panel, Trace, packed
from smarig.report.components.run_description import source_label
from smarig.report.diagnosis.candidate_rows import (
    GENERIC,
    NAMED,
    candidate_name,
    nats_text,
    row_positions,
    rows_layout,
    top_candidates,
)
from smarig.report.diagnosis.diagnosis_predictions import Array, diagnosis_caption


def explanations_figure(d: Diagnosis) -> Figure:
    """Explanations of the last level by nats behind the best; single candidates by gain above chance."""
    panels, explanations_text = [_candidates_panel(top_candidates(d))], ""
    if d.levels:
        level = d.levels[-1]
        lead = [level.lead(k) for k in range(len(level.explanations))]
        panels.insert(0, _explanations_panel([" + ".join(r.names) for r in level.explanations], lead))
        explanations_text = (
            "First panel: the explanations of the last level with all parameters fitted, and how many nats (units of "
            f"log likelihood) they fit worse than the best one; {lead_scale_nats(level.gain):.2g} nats are a factor e "
            "in the score. Second panel (with the noise estimated without effects):"
        )
    each = "each single candidate" if explanations_text else "Each single candidate"
    return Figure(
        panels,
        "Competing explanations.",
        [
            explanations_text,
            f"{each} in the first critique, linearised at weak strength: gain in log likelihood above the median of "
            "its gains on null data. Blue: an effect of the catalogue; vermilion: a smooth function of a variable, "
            "which does not name a cause. Axes: linear near 0, logarithmic beyond.",
            *diagnosis_caption(d),
        ],
        source_label(*d.timeline.runs),
        460,
    )


def _explanations_panel(names: Sequence[str], lead: Sequence[float]) -> Panel:
    rows = row_positions(len(names))
    texts = ["best" if v <= 0 else nats_text(v) for v in lead]
    data = [_bar(lead, rows, NAMED, texts)]
    return Panel(
        data,
        rows_layout(names, rows, "Nats behind the best explanation", [0.0, *lead]),
        _panel_height_px(len(names)),
    )


def _candidates_panel(scores: Sequence[CandidateScore]) -> Panel:
    rows = row_positions(len(scores))
    net = [s.net for s in scores]
    colour = [GENERIC if s.candidate.generic else NAMED for s in scores]
    data = [_bar(net, rows, colour, [nats_text(v) for v in net])]
    names = [candidate_name(s) for s in scores]
    return Panel(
        data, rows_layout(names, rows, "Gain above chance (nats)", [0.0, *net]), _panel_height_px(len(names))
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


def _panel_height_px(rows: int) -> int:
    return 110 + 30 * rows

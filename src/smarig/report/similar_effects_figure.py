"""Look-alikes: how much of an effect's evidence another effect could take, as a map. Knows no reading."""

import numpy as np
from scipy.cluster.hierarchy import leaves_list, linkage
from scipy.spatial.distance import squareform

from smarig.diagnosis.critique.visibility import IMITATION_THRESHOLD, VisibilityTable
from smarig.diagnosis.diagnose import Diagnosis
from smarig.report.diagnosis_predictions import Array, diagnosis_caption
from smarig.report.figure import Figure, Panel, Trace, axis, packed
from smarig.report.run_description import source_label
from smarig.report.style import SEQUENCE


def similar_effects_figure(v: VisibilityTable, d: Diagnosis) -> Figure | None:
    """Which effect could take how much of another's evidence, look-alikes side by side; None below two effects."""
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
            "colorbar": {"title": {"text": "share imitated", "side": "right"}, "thickness": 12},
            "hovertemplate": "%{x} takes %{z:.2f} of the evidence of %{y}<extra></extra>",
        }
    ]
    layout = {
        "xaxis": axis("… could be taken by this effect", tickangle=-60, ticks="", showgrid=False),
        "yaxis": axis("Evidence of this effect …", autorange="reversed", ticks="", showgrid=False),
    }
    return Figure(
        [Panel(data, layout, 200 + 24 * len(names), wide=True, min_width_px=240 + 20 * len(names))],
        "Look-alikes: how much of an effect's evidence in these data another effect could take.",
        [
            "0: nothing in common; 1: not distinguishable by these data. Numbers: per cent, from 30. "
            f"From {100 * IMITATION_THRESHOLD:.0f} % on they count as one group. Computed before any reading was "
            "looked at, but for "
            "the size of the noise, at weak strength, after all that a new density could explain.",
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

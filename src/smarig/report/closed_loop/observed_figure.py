"""The position of an observer beside the encoder's, with its interval and the ambiguous spans."""

import numpy as np

from smarig.record import Run
from smarig.report.closed_loop.closed_loop_figures import stacked_layout
from smarig.report.closed_loop.observed_position import ObservedPosition
from smarig.report.components.decimate import POINTS, envelope
from smarig.report.components.figure import Figure, Panel, line
from smarig.report.components.run_description import display_unit, output_title, run_caption, source_label
from smarig.report.components.style import CURRENT, GREY, INK, POSITION
from smarig.report.runs.time_figures import time_unit

INTERVAL = "rgba(107,114,128,.18)"


def observed_figure(run: Run, found: ObservedPosition) -> Figure:
    """Two rows on one time axis: both positions with the set-point, and observed − encoder with ± its interval."""
    size, unit = time_unit(float(found.t_s[-1]))
    t, miss = found.t_s / size, found.position - found.encoder
    drawn = np.linspace(0, t.size - 1, min(POINTS, t.size)).astype(int)
    outline = np.concatenate([drawn, drawn[::-1]])
    edge = np.concatenate([found.half[drawn], -found.half[drawn[::-1]]])
    both = envelope(found.position, POINTS)
    encoder, missed = envelope(found.encoder, POINTS), envelope(miss, POINTS)
    data = [
        line(t[encoder], found.encoder[encoder], "encoder", GREY, width=1.2),
        line(t[both], found.position[both], "observed", POSITION, width=1.2),
        line(t[[0, -1]], [found.wanted, found.wanted], "set-point", INK, width=1.3, dash="dot"),
        line(
            *(t[outline], edge, "95 % interval", GREY),
            width=0,
            fill="toself",
            fillcolor=INTERVAL,
            hoverinfo="skip",
            yaxis="y2",
        ),
        line(t[missed], miss[missed], "observed − encoder", INK, width=1.2, yaxis="y2", showlegend=False),
    ]
    if found.ambiguous.any():
        spans = np.where(found.ambiguous, 0.0, np.nan)[drawn]
        data.append(line(t[drawn], spans, "ambiguous", CURRENT, width=4, yaxis="y2"))
    titles = (output_title(run), f"Observed − encoder ({display_unit(run.unit)})")
    return Figure(
        [Panel(data, stacked_layout(titles, (0.55, 0.45), f"Time since the loop was closed ({unit})"), 480)],
        "Position from the resistance, which closed the loop, and from the encoder, which only recorded.",
        [
            "Grey: the 95 % interval of the observer. Orange: spans where a resistance alone tells no position.",
            run_caption(run),
        ],
        source_label(run),
    )

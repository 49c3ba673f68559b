"""The position of an observer beside the encoder's, for a loop closed by the resistance: its errors and its figure."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control import OBSERVED
from smarig.core import Array, root_mean_square
from smarig.record import Run
from smarig.report.components.decimate import POINTS, envelope
from smarig.report.components.figure import Figure, Panel, line
from smarig.report.components.run_description import display_unit, output_title, run_caption, source_label
from smarig.report.components.style import BAND, CURRENT, GREY, INK, POSITION
from smarig.report.runs.time_figures import stacked_layout, time_unit


@dataclass(frozen=True, eq=False)
class ObservedPosition:
    """Values (n,) of the samples in closed loop: time since it was closed, position of observer and of encoder.

    Both positions are on the encoder's scale; ``half`` is half of the 95 % interval. ``wanted`` is the set-point.
    """

    t_s: Array
    position: Array
    half: Array
    ambiguous: NDArray[np.bool_]
    encoder: Array
    wanted: float

    def to_json(self) -> dict[str, Any]:
        """Errors in the rig's unit; the encoder counts as the truth. Shares of the samples."""
        miss = self.position - self.encoder
        known = np.isfinite(miss)
        if not known.any():
            return {"n": self.t_s.size, "ambiguous": float(np.mean(self.ambiguous))}
        late = known & (self.t_s >= self.t_s[-1] / 2)
        return {
            "n": int(known.sum()),
            "ambiguous": float(np.mean(self.ambiguous)),
            "observer_rms": root_mean_square(miss[known]),
            "observer_max": float(np.abs(miss[known]).max()),
            "coverage_95": float(np.mean(np.abs(miss[known]) <= self.half[known])),
            "median_half": float(np.median(self.half)),
            "error_rms": root_mean_square((self.encoder - self.wanted)[known]),
            "steady_error": float(np.mean((self.encoder - self.wanted)[late])),
            "observed_error_rms": root_mean_square((self.position - self.wanted)[known]),
        }


def observed_position(run: Run, closed_s: float, data: dict[str, Any]) -> ObservedPosition | None:
    """From the marks after the loop was closed at ``closed_s`` with this data; None without them."""
    marks = [e.data for e in run.events if e.kind == "mark" and e.text == OBSERVED and e.t_s >= closed_s]
    if not marks or "wanted_observed" not in data:
        return None
    t_s, position, half, ambiguous = (
        np.concatenate([np.asarray(mark[name], dtype=float) for mark in marks])
        for name in ("at_s", "position", "half", "ambiguous")
    )
    if not t_s.size or not t_s.size == position.size == half.size == ambiguous.size:
        return None
    wanted = float(data["wanted_position"])
    position = position + wanted - float(data["wanted_observed"])
    rows = np.clip(np.searchsorted(run["t_s"], t_s - 1e-6), 0, len(run) - 1)
    encoder = np.where(np.abs(run["t_s"][rows] - t_s) < 1e-3, run["position"][rows], np.nan)
    return ObservedPosition(t_s - closed_s, position, half, ambiguous > 0, encoder, wanted)


def observed_text(found: ObservedPosition, unit: str) -> str:
    """The result in words."""
    f = found.to_json()
    ambiguous = f"The resistance is ambiguous in {100 * f['ambiguous']:.1f} % of the samples."
    if "observer_rms" not in f:
        return f"Feedback: resistance. No encoder to compare with. {ambiguous}"
    return (
        f"Feedback: resistance. Observed minus encoder: rms {f['observer_rms']:.3g} {unit}, largest "
        f"{f['observer_max']:.3g} {unit}; within the 95 % interval (median ±{f['median_half']:.2g} {unit}) "
        f"{100 * f['coverage_95']:.1f} %. Position by the encoder minus set-point: rms {f['error_rms']:.3g} {unit}, "
        f"mean of the second half {f['steady_error']:.3g} {unit}; by the observer "
        f"rms {f['observed_error_rms']:.3g} {unit}. "
        f"{ambiguous}"
    )


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
            fillcolor=BAND,
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
        [Panel(data, stacked_layout(titles, f"Time since the loop was closed ({unit})", (0.55, 0.45)), 480)],
        "Position from the resistance, which closed the loop, and from the encoder, which only recorded.",
        [
            "Grey: the 95 % interval of the observer. Orange: spans where a resistance alone tells no position.",
            run_caption(run),
        ],
        source_label(run),
    )

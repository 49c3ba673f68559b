"""The figure of the trade-off between held-out error and the negative part of μ (thesis, Tables 5.1 and 5.2)."""

from collections.abc import Mapping

from smarig.core import spaced
from smarig.identification import INTERVAL_LEVEL, Identification, SurfaceChoice, Verification
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, error_bars, line, log_axis
from smarig.report.components.html import Html, joined
from smarig.report.components.run_description import run_caption, source_label
from smarig.report.components.style import GOOD, GREY, surface_colour
from smarig.report.models.identification_plot_data import density_report_of
from smarig.report.models.model_tables import M_P, pooled_rms

Coordinates = dict[str, tuple[float, float]]
_MARGIN_SHARE = 0.12  # of the largest share, on both sides


def tradeoff_figure(
    choice: SurfaceChoice,
    found: Mapping[str, Identification],
    held_out: Mapping[str, Verification],
    run: Run,
) -> Figure:
    """Errors on held-out curves with intervals and on held-out runs against ∬μ⁻/∬|μ|, one mark per kind of model."""
    shares = {name: 100 * share for name, share in choice.negative_share.items() if name in found}
    by_curve: Coordinates = {name: (share, choice.held_out_rms[name]) for name, share in shares.items()}
    run_rms = {name: pooled_rms(held_out.get(name)) for name in shares}
    by_run: Coordinates = {name: (shares[name], rms) for name, rms in run_rms.items() if rms is not None}
    in_M_P = {name for name in shares if density_report_of(found[name]).M_P}
    panels = [_panel(by_curve, in_M_P, f"rms on held-out curves ({run.unit})", choice.held_out_interval)]
    if by_run:
        panels.append(_panel(by_run, in_M_P, f"rms on the held-out run ({run.unit})"))
    return Figure(
        panels,
        "Prediction error and negative part of μ, one mark for each kind of model.",
        [
            "Abscissa: the negative part of μ, ∬μ⁻/∬|μ|, in the fit to all curves. Ordinate: the error on held-out "
            "data. The best corner is at the lower left. Filled marks are in",
            joined([M_P, "."]),
            f"First panel: {choice.curves} curves, held out in groups; bars: {100 * INTERVAL_LEVEL:.0f} % intervals by "
            f"resampling the curves{_held_out_text(by_run, held_out)}.",
            *_conclusion(by_curve, in_M_P, run),
            run_caption(run),
        ],
        source_label(run),
        460,
    )


def _held_out_text(by_run: Coordinates, held_out: Mapping[str, Verification]) -> str:
    if not by_run:
        return ""
    return f"; second panel: the held-out run, {held_out[next(iter(by_run))].points} points"


def _conclusion(by_curve: Coordinates, in_M_P: set[str], run: Run) -> tuple[str | Html, ...]:
    """A sentence on the smallest errors with and without μ ≥ 0."""
    best = min(by_curve, key=lambda name: by_curve[name][1])
    least = f"The smallest error on held-out curves is {by_curve[best][1]:.3g}{spaced(run.unit)} ({best})"
    allowed = [name for name in by_curve if name in in_M_P]
    if not allowed:
        return (least + "; none of these kinds is in", joined([M_P, "."]))
    safe = min(allowed, key=lambda name: by_curve[name][1])
    if safe == best:
        return (least + ", and this kind is in", joined([M_P, "."]))
    return (
        least + "; the smallest in",
        joined([M_P, f" is {by_curve[safe][1]:.3g}{spaced(run.unit)} ({safe})."]),
    )


def _panel(
    places: Coordinates,
    in_M_P: set[str],
    title: str,
    intervals: Mapping[str, tuple[float, float]] | None = None,
) -> Panel:
    half_range = max(max(share for share, _ in places.values()), 0.1)
    errors = [v for name, (_, rms) in places.items() for v in (rms, *(intervals or {}).get(name, ()))]
    low, high = 0.56 * max(min(errors), 1e-12), 1.6 * max(*errors, 1e-12)
    data: list[Trace] = [
        line([0, 0], [low, high], "μ ≥ 0", GOOD, width=1.2, dash="dot", hoverinfo="skip"),
    ]
    for name, (share, rms) in places.items():
        data.append(_mark(name, share, rms, name in in_M_P, (intervals or {}).get(name)))
    corner = {
        "x": 0.12,
        "y": 0.02,
        "xref": "paper",
        "yref": "paper",
        "xanchor": "left",
        "yanchor": "bottom",
        "showarrow": False,
        "text": "best corner",
        "font": {"color": GOOD, "size": 12},
    }
    layout = {
        "xaxis": axis(
            "Negative part of μ (%)",
            range=[-_MARGIN_SHARE * half_range, (1 + 3 * _MARGIN_SHARE) * half_range],
        ),
        "yaxis": log_axis(title, low, high),
        "annotations": [corner],
        "showlegend": False,
    }
    return Panel(data, layout, 420)


def _mark(name: str, share: float, rms: float, filled: bool, ends: tuple[float, float] | None) -> Trace:
    colour = surface_colour(name)
    bars = {}
    if ends is not None:
        bars = {"error_y": error_bars([rms], [ends[0]], [ends[1]], color=GREY, thickness=1.2, width=5)}
    return dots(
        [share],
        [rms],
        name,
        colour,
        size=13,
        symbol="circle" if filled else "circle-open",
        mode="markers+text",
        text=[name],
        textposition="middle right",
        marker={"line": {"width": 2.5, "color": colour}},
        hovertemplate="%{y:.3g} rms, %{x:.2f} % negative<extra>" + name + "</extra>",
        **bars,
    )

"""The part of a study's page on curves of heat flow: the curves with baselines and tangents, and their figures."""

from collections.abc import Iterator

import numpy as np

from smarig.core import spaced
from smarig.record import Run
from smarig.report import (
    Figure,
    Html,
    Panel,
    axis,
    bullets,
    display_unit,
    dots,
    figure_name,
    input_title,
    interval_text,
    line,
    output_title,
    paragraph,
    path,
    source_label,
    style,
    tag,
    to_uncertainty,
)
from smarig.report import table as html_table
from smarig.study.heat_flow_sentences import rate_text
from smarig.transformation import (
    HEAT_FIGURES,
    Calorimetry,
    CalorimetryCycle,
    HeatFlowPeak,
    HeatFlowScan,
)

_COLOURS = {"heating": style.HEATING, "cooling": style.COOLING}
_SIDES = {
    "heating": {"low": "A_s", "peak": "A_p", "high": "A_f"},
    "cooling": {"low": "M_f", "peak": "M_p", "high": "M_s"},
}
_PALE = 0.6  # curves, below their tangents
_BEYOND = 0.12  # of its height: how far a tangent is drawn beyond the baseline
_MARGIN = 0.12  # of the range of the curve: room for the labels
_MOST_PANELS = 4


def heat_flow_figure(found: Calorimetry, run: Run) -> Figure:
    """The curves of each cycle with baselines, tangents and the six temperatures."""
    shown = found.cycles[:_MOST_PANELS]
    panels = [Panel(_traces(found, cycle), _layout(found, cycle, run), 460) for cycle in shown]
    more = (
        f"{len(found.cycles) - len(shown)} further cycles are not drawn."
        if len(found.cycles) > len(shown)
        else ""
    )
    return Figure(
        panels,
        "Heat flow with baselines and tangents.",
        [
            "Dashed: the baseline of each peak, and the tangents at its steepest places, of one choice of their "
            "readings. Crosses: the temperatures, as the mean over all choices; bars: 95 % intervals.",
            more,
        ],
        source_label(run),
        560,
    )


def heat_flow_table(found: Calorimetry) -> Html:
    """A row of temperatures and latent heats for each cycle, with their intervals."""
    heads = [tag("span", _figure_name(name), *_unit(found, name)) for name in HEAT_FIGURES]
    rows = [(str(c.number), *(_cell(c, name) for name in HEAT_FIGURES)) for c in found.cycles]
    return html_table(
        ("Cycle", *heads), rows, "Transformation temperatures by ASTM F2004, with 95 % intervals."
    )


def heat_flow_notes(found: Calorimetry) -> Iterator[Html]:
    """How the figures were found, the rates, and why some are missing."""
    yield paragraph(
        "A",
        tag("sub", "s"),
        ", A",
        tag("sub", "f"),
        ", M",
        tag("sub", "s"),
        " and M",
        tag("sub", "f"),
        " are where the tangents at the steepest places of a peak meet the baseline before and after it, extrapolated; "
        "A",
        tag("sub", "p"),
        " and M",
        tag("sub", "p"),
        " are where the curve is farthest from its baseline. The latent heat is the area between curve and baseline "
        "over time. The intervals contain the noise and the choice of the readings of baselines and tangents.",
    )
    unused = [f"Not used: {u.sentence(display_unit(found.input_unit))}" for u in found.unused]
    rates = [text for c in found.cycles if (text := rate_text(c))]
    yield bullets([*rates, *unused])


def _figure_name(name: str) -> Html | str:
    words = {"heating_heat": "Heat, heating", "cooling_heat": "Heat, cooling"}
    return words.get(name) or figure_name(name)


def _unit(found: Calorimetry, name: str) -> list[str]:
    unit = display_unit(found.unit_of(name))
    return [f" ({unit})"] if unit else []


def _cell(cycle: CalorimetryCycle, name: str) -> Html | str:
    if name not in cycle.figures:
        return "–"
    drawn = cycle.figures[name]
    low, high = drawn.ci95
    interval = interval_text(low, high)
    return tag("span", tag("b", to_uncertainty(drawn.value, (high - low) / 2)), tag("br"), interval)


def _layout(found: Calorimetry, cycle: CalorimetryCycle, run: Run) -> dict:
    several = f"Cycle {cycle.number}: " if len(found.cycles) > 1 else ""
    values = np.concatenate([scan.y for scan in cycle.scans])
    room = _MARGIN * float(np.ptp(values))
    title = f"{several}{output_title(run)}, exothermic {found.exothermic}"
    ends = [float(values.min()) - room, float(values.max()) + room]
    return {"xaxis": axis(input_title(run)), "yaxis": axis(title, range=ends)}


def _traces(found: Calorimetry, cycle: CalorimetryCycle) -> list[dict]:
    traces = []
    for scan in cycle.scans:
        keep = path(scan.u, scan.y)
        traces.append(
            line(
                scan.u[keep], scan.y[keep], scan.direction, _COLOURS[scan.direction], width=2.4, opacity=_PALE
            )
        )
    with_peak = [scan for scan in cycle.scans if scan.peak is not None]
    for scan in with_peak:
        if scan.peak is not None:
            traces += _construction(scan, scan.peak, with_peak[0].direction)
            traces += _marks(found, cycle, scan, scan.peak)
    return traces


def _construction(scan: HeatFlowScan, peak: HeatFlowPeak, first: str) -> list[dict]:
    """The baseline and the tangents of one choice of readings; those of the ``first`` direction are in the legend."""
    u, y = [peak.u, [np.nan]], [scan.sign * peak.baseline, [np.nan]]
    for tangent in peak.tangents.values():
        foot, top = tangent.foot[1], peak.top
        levels = np.array([foot - _BEYOND * (top - foot), top])
        u.append([*(tangent.steep.u + tangent.steep.du_dy * (levels - tangent.steep.y)), np.nan])
        y.append([*(scan.sign * levels), np.nan])
    drawn = line(
        np.concatenate(u), np.concatenate(y), "baselines and tangents", style.INK, dash="dash", width=1.1
    )
    return [drawn | {"showlegend": scan.direction == first}]


def _marks(
    found: Calorimetry, cycle: CalorimetryCycle, scan: HeatFlowScan, peak: HeatFlowPeak
) -> Iterator[dict]:
    """A cross with its label at each temperature, on the side of the curve where there is room."""
    up = scan.sign > 0
    for side, name in _SIDES[scan.direction].items():
        if name not in cycle.figures:
            continue
        drawn = cycle.figures[name]
        low, high = drawn.ci95
        level = peak.top if side == "peak" else float(np.interp(drawn.value, peak.u, peak.baseline))
        across = {"low": "left", "peak": "center", "high": "right"}[side]
        value = f"{round(drawn.value, 1) + 0.0:.1f}".replace("-", "−")  # zero has no sign
        yield dots(
            [drawn.value],
            [scan.sign * level],
            name,
            _COLOURS[scan.direction],
            symbol="x-thin",
            size=9,
            marker={"line": {"width": 2, "color": _COLOURS[scan.direction]}},
            error_x={
                "type": "data",
                "symmetric": False,
                "array": [max(high - drawn.value, 0.0)],
                "arrayminus": [max(drawn.value - low, 0.0)],
                "color": style.GREY,
                "thickness": 1.4,
                "width": 4,
            },
            mode="markers+text",
            text=[f"{name[0]}<sub>{name[2]}</sub> {value}{spaced(display_unit(found.input_unit))}"],
            textposition=f"{'top' if up else 'bottom'} {across}",
            showlegend=False,
        )

"""The closed-loop section of a comparison page.

Errors are comparable only for the same reference or set-point, so loops are grouped by it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from smarig.control import SETTLING_BAND_COUNTS
from smarig.record import Run
from smarig.report.certificate.certificate_page import with_subscripts
from smarig.report.closed_loop.closed_loop_text import zero_below_resolution
from smarig.report.closed_loop.loop_comparison_figures import (
    ComparedLoop,
    ComparedRegulation,
    ComparedTracking,
    group_by_reference,
    group_by_setpoint,
    preisach_plane_figure,
    regulation_overlay_figure,
    tracking_overlay_figure,
)
from smarig.report.closed_loop.loop_result import RegulationResult, TrackingResult, closed_loop_result
from smarig.report.closed_loop.regulation_plane_figure import B_ELL
from smarig.report.closed_loop.velocity_result import RATIO
from smarig.report.components.html import Html, joined, notice, paragraph, table, tag
from smarig.report.components.numbers import duration, number, signed
from smarig.report.components.page import Section
from smarig.report.components.run_description import display_unit
from smarig.report.runs.run_comparison_figures import coloured_name

_MISSING = "–"


def loops_section(runs: Mapping[str, Run], first: int) -> list[Section]:
    """One section of closed-loop runs by name, none without any; ``first`` is the colour index of the first run."""
    result = [
        (k, name, run, closed_loop_result(run)) for k, (name, run) in enumerate(runs.items(), start=first)
    ]
    tracked = [ComparedLoop(k, name, run, f) for k, name, run, f in result if isinstance(f, TrackingResult)]
    held = [ComparedLoop(k, name, run, f) for k, name, run, f in result if isinstance(f, RegulationResult)]
    unreadable = [name for _, name, _, f in result if f is None]
    parts = [*_tracking_parts(tracked), *_regulation_parts(held)]
    if unreadable:
        words = f"The closed-loop data of these runs cannot be read: {', '.join(unreadable)}."
        parts.append(notice("warning", paragraph(words)))
    return [Section("Closed loops", "Closed loops", parts)] if parts else []


# --- along references -------------------------------------------------------------------------------------


def _tracking_parts(loops: Sequence[ComparedTracking]) -> list[Any]:
    groups, parts = group_by_reference(loops), []
    if len(groups) > 1:
        words = (
            f"These runs tracked {len(groups)} different references. Errors along different references do not compare "
            "controllers, so each table below contains runs of one reference."
        )
        parts.append(notice("warning", paragraph(words)))
    for group in groups:
        follow = group[0].result.reference
        parts += [
            tag("h3", f"Reference {follow.name}, {duration(follow.duration_s)}"),
            _tracking_table(group),
            *_lead_time_note(group),
            tracking_overlay_figure(group) or paragraph("No loop was closed long enough to draw it."),
        ]
    return parts


def _tracking_table(loops: Sequence[ComparedTracking]) -> Html:
    unit, held = display_unit(loops[0].run.unit), loops[0].result.reference.held
    header: list[Any] = [
        "Run",
        "Controller",
        f"Error, rms ({unit})",
        "rms (counts)",
        f"Largest ({unit})",
        "Largest (counts)",
    ]
    if held:
        header += ["Steps settled", "Settled after (s), median", "Overshoot (counts), largest"]
    fed_back = any(each.result.velocity for each in loops)
    if fed_back:
        header += [with_subscripts(f"Velocity, {RATIO}"), with_subscripts("k_e (Thm 8.2)")]
    header += ["Energy (J)", "Peak temperature (K)"]
    skip_s = max(each.result.skip_s for each in loops)
    words = "Errors are from readings and include encoder noise. Temperatures are predicted, above ambient."
    if skip_s:
        words += f" Errors exclude the first {skip_s:g} s, the approach to the first point."
    if held:
        words += f" Settled: within {SETTLING_BAND_COUNTS:g} counts for 5 s; the median is over the steps that settled."
    if fed_back:
        words += " Velocity feedback does not feed back the position."
    rows = [_tracking_row(each, held=held, fed_back=fed_back) for each in loops]
    return table(header, rows, words, stacked=True)


def _tracking_row(each: ComparedTracking, *, held: bool, fed_back: bool) -> tuple[Any, ...]:
    f, count, velocity = each.result.measures, each.count, each.result.velocity
    start = (coloured_name(each.k, each.name), each.result.controller)
    if f is None:
        return (*start, *[_MISSING] * (6 + 3 * held + 2 * fed_back))
    errors = (number(f.rms), number(f.rms / count), number(f.largest), number(f.largest / count))
    steps: tuple[str, ...] = ()
    if held:
        settled = [s for s in f.settle_s if np.isfinite(s)]
        median = number(float(np.median(settled))) if settled else "never"
        over = number(max(f.overshoot) / count) if f.overshoot else _MISSING
        steps = (f"{len(settled)} of {len(f.settle_s)}", median, over)
    ratios: tuple[str, ...] = ()
    if fed_back:
        ratios = (number(velocity.ratio), number(velocity.k_e)) if velocity else (_MISSING, _MISSING)
    return (*start, *errors, *steps, *ratios, number(f.energy_J), number(f.peak_K))


def _lead_time_note(loops: Sequence[ComparedTracking]) -> list[Html]:
    """A note if the controllers have different preview times, which explains part of their differences."""
    lead_times = [(each.name, each.lead_s) for each in loops if each.lead_s is not None]
    if len({lead for _, lead in lead_times}) < 2:
        return []
    ahead = ", ".join(f"{name} {lead:g} s" for name, lead in lead_times)
    words = (
        f"The preview times (lead_s) differ: {ahead}. A controller with preview starts before the reference moves. "
        "This explains part of the differences."
    )
    if loops[0].result.reference.held:
        words += " Motion before the next step counts as an error of the present step, not as its overshoot."
    return [paragraph(words)]


# --- at set-points ----------------------------------------------------------------------------------------


def _regulation_parts(loops: Sequence[ComparedRegulation]) -> list[Any]:
    groups, parts = group_by_setpoint(loops), []
    if len(groups) > 1:
        words = (
            "These runs differ in set-point or disturbance. Transients are compared only among runs with the same "
            "set-point and disturbance."
        )
        parts.append(notice("warning", paragraph(words)))
    for group in groups:
        parts += [tag("h3", _setpoint_title(group[0])), _regulation_table(group)]
        measures = [regulation_overlay_figure(group), preisach_plane_figure(group)]
        parts += [f for f in measures if f] or [paragraph("No loop was closed long enough to draw it.")]
    return parts


def _setpoint_title(each: ComparedRegulation) -> str:
    y, disturbance_K = each.result.setpoint_data["setpoint"], each.result.disturbance_K
    against = f", disturbed by {signed(disturbance_K)} K" if disturbance_K else ", without disturbance"
    return f"Set-point {number(y, 4)} {display_unit(each.run.unit)}{against}"


def _regulation_table(loops: Sequence[ComparedRegulation]) -> Html:
    unit = display_unit(loops[0].run.unit)
    known = [t for t in (each.result.transient for each in loops) if t]
    least = min(known, default=None)
    header = (
        "Run",
        "Start",
        f"Set-point ({unit})",
        joined(["Predicted distance from ", B_ELL, " (%)"]),
        "Reached (%)",
        f"After the approach ({unit})",
        f"Largest transient ({unit})",
        "Transient (counts)",
        "Transient / smallest",
        "At the end (counts)",
        "Verdict",
    )
    words = joined(
        [
            "Distances from ",
            B_ELL,
            " are shares of the plane. Transient: the largest error of the readings after the disturbance starts, also "
            "as a ratio to the smallest transient. At the end: mean error ± standard deviation. Signed values are "
            "measured − reference.",
        ]
    )
    return table(header, [_regulation_row(each, least) for each in loops], words, stacked=True)


def _regulation_row(each: ComparedRegulation, least: float | None) -> tuple[Any, ...]:
    result, count = each.result, each.count
    area = result.setpoint_data.get("area_K2")
    predicted_share = number(100 * result.setpoint_data["predicted_distance_K2"] / area) if area else _MISSING
    reached = number(100 * result.distance_K2 / area) if area and result.distance_K2 is not None else _MISSING
    error, most, end = result.output_error, result.transient, result.end
    return (
        coloured_name(each.k, each.name),
        result.setpoint_data["start"],
        number(result.setpoint_data["setpoint"], 4),
        predicted_share,
        reached,
        _MISSING if error is None else signed(zero_below_resolution(error, count)),
        number(most),
        number(most / count) if most is not None and count else _MISSING,
        number(most / least) if most is not None and least else _MISSING,
        f"{signed(round(end.mean / count, 1))} ± {number(end.std / count, 2)}" if end and count else _MISSING,
        (end.verdict if end else "") or _MISSING,
    )

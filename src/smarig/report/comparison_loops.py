"""The section of a comparison that only closed loops have: how well each went, beside those asked for the same.

What was asked must be the same for errors to be compared, so loops are in groups by it. Refuses to know controllers
and models.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from smarig.control.tracking.measures import WITHIN_COUNTS
from smarig.record import Run
from smarig.report.closed_loop import Regulated, TrackedRun, closed_loop
from smarig.report.closed_loop_words import tangible
from smarig.report.compared_loops import (
    ComparedLoop,
    RegulatedLoop,
    TrackedLoop,
    by_reference,
    by_setpoint,
)
from smarig.report.conditions import exact_unit
from smarig.report.figures_compared_loops import held_over_time, in_the_plane, tracked_over_time
from smarig.report.figures_comparison import named
from smarig.report.figures_regulation import B_ELL
from smarig.report.html import Html, joined, notice, paragraph, table, tag
from smarig.report.numbers import duration, number, signed
from smarig.report.page import Section

_NONE = "–"


def loops_section(runs: Mapping[str, Run], first: int) -> list[Section]:
    """One section of closed-loop runs by name, none without any; ``first`` is the place of the first one's colour."""
    found = [(k, name, run, closed_loop(run)) for k, (name, run) in enumerate(runs.items(), start=first)]
    tracked = [ComparedLoop(k, name, run, f) for k, name, run, f in found if isinstance(f, TrackedRun)]
    held = [ComparedLoop(k, name, run, f) for k, name, run, f in found if isinstance(f, Regulated)]
    unread = [name for _, name, _, f in found if f is None]
    parts = [*_tracked(tracked), *_held(held)]
    if unread:
        words = f"What the record says of its closed loop cannot be read: {', '.join(unread)}."
        parts.append(notice("warning", paragraph(words)))
    return [Section("Closed loops", "Closed loops", parts)] if parts else []


# --- along references -------------------------------------------------------------------------------------


def _tracked(loops: Sequence[TrackedLoop]) -> list[Any]:
    groups, parts = by_reference(loops), []
    if len(groups) > 1:
        words = (
            f"These runs followed {len(groups)} different references. Errors along different references say nothing of "
            "the controllers, so only runs of one reference are set beside each other."
        )
        parts.append(notice("warning", paragraph(words)))
    for group in groups:
        follow = group[0].found.reference
        parts += [
            tag("h3", f"Along {follow.name}, {duration(follow.duration_s)}"),
            _tracked_table(group),
            *_ahead(group),
            tracked_over_time(group) or paragraph("No loop was closed for long enough to be drawn."),
        ]
    return parts


def _tracked_table(loops: Sequence[TrackedLoop]) -> Html:
    unit, held = exact_unit(loops[0].run.unit), loops[0].found.reference.held
    header = [
        "Run",
        "Controller",
        f"Error, rms ({unit})",
        "rms (counts)",
        f"Largest ({unit})",
        "Largest (counts)",
    ]
    if held:
        header += ["Steps settled", "Settled after (s), median", "Overshoot (counts), largest"]
    header += ["Energy (J)", "Peak temperature (K)"]
    skip_s = max(each.found.skip_s for each in loops)
    words = "Errors are those of readings, encoder noise included; temperatures are predicted, above ambient."
    if skip_s:
        words += f" Errors from {skip_s:g} s on: the way to the first point is no tracking."
    if held:
        words += f" Settled: within {WITHIN_COUNTS:g} counts and 5 s there; the median is over the steps that settled."
    return table(header, [_tracked_row(each, held=held) for each in loops], words, stacked=True)


def _tracked_row(each: TrackedLoop, *, held: bool) -> tuple[Any, ...]:
    f, count = each.found.figures, each.count
    start = (named(each.k, each.name), each.found.controller)
    if f is None:
        return (*start, *[_NONE] * (9 if held else 6))
    errors = (number(f.rms), number(f.rms / count), number(f.largest), number(f.largest / count))
    steps: tuple[str, ...] = ()
    if held:
        settled = [s for s in f.settle_s if np.isfinite(s)]
        median = number(float(np.median(settled))) if settled else "never"
        over = number(max(f.overshoot) / count) if f.overshoot else _NONE
        steps = (f"{len(settled)} of {len(f.settle_s)}", median, over)
    return (*start, *errors, *steps, number(f.energy_J), number(f.peak_K))


def _ahead(loops: Sequence[TrackedLoop]) -> list[Html]:
    """That not all controllers look ahead alike, which is part of what differs between them."""
    told = [(each.name, each.lead_s) for each in loops if each.lead_s is not None]
    if len({lead for _, lead in told}) < 2:
        return []
    ahead = ", ".join(f"{name} {lead:g} s" for name, lead in told)
    words = (
        f"Not all look ahead alike (lead_s): {ahead}. A controller that acts on what will be wanted begins before the "
        "reference moves; part of the difference is that."
    )
    if loops[0].found.reference.held:
        words += (
            " What it moves before the next step counts as error of the step before, not as its overshoot."
        )
    return [paragraph(words)]


# --- at set-points ----------------------------------------------------------------------------------------


def _held(loops: Sequence[RegulatedLoop]) -> list[Any]:
    groups, parts = by_setpoint(loops), []
    if len(groups) > 1:
        words = (
            "These runs did not all hold the same set-point against the same disturbance: transients are compared only "
            "among those that did."
        )
        parts.append(notice("warning", paragraph(words)))
    for group in groups:
        parts += [tag("h3", _asked(group[0])), _held_table(group)]
        figures = [held_over_time(group), in_the_plane(group)]
        parts += [f for f in figures if f] or [paragraph("No loop was closed for long enough to be drawn.")]
    return parts


def _asked(each: RegulatedLoop) -> str:
    y, push_K = each.found.facts["setpoint"], each.found.push_K
    against = f", disturbed by {signed(push_K)} K" if push_K else ", not disturbed"
    return f"Held at {number(y, 4)} {exact_unit(each.run.unit)}{against}"


def _held_table(loops: Sequence[RegulatedLoop]) -> Html:
    unit = exact_unit(loops[0].run.unit)
    known = [t for t in (each.found.transient for each in loops) if t]
    least = min(known, default=None)
    header = (
        "Run",
        "Start",
        f"Set-point ({unit})",
        joined(["Foretold distance from ", B_ELL, " (%)"]),
        "Reached (%)",
        f"After the approach ({unit})",
        f"Largest transient ({unit})",
        "Transient (counts)",
        "Over the smallest",
        "At the end (counts)",
        "Verdict",
    )
    words = joined(
        [
            "Distances from ",
            B_ELL,
            " are shares of the plane. Transient: the largest error of the readings from the disturbance on, also over "
            "the smallest of them. At the end: mean error ± rms about it. What has a sign is measured less wanted.",
        ]
    )
    return table(header, [_held_row(each, least) for each in loops], words, stacked=True)


def _held_row(each: RegulatedLoop, least: float | None) -> tuple[Any, ...]:
    found, count = each.found, each.count
    area = found.facts.get("area_K2")
    foretold = number(100 * found.facts["predicted_distance_K2"] / area) if area else _NONE
    reached = number(100 * found.distance_K2 / area) if area and found.distance_K2 is not None else _NONE
    error, most, end = found.output_error, found.transient, found.end
    return (
        named(each.k, each.name),
        found.facts["start"],
        number(found.facts["setpoint"], 4),
        foretold,
        reached,
        _NONE if error is None else signed(tangible(error, count)),
        number(most),
        number(most / count) if most is not None and count else _NONE,
        number(most / least) if most is not None and least else _NONE,
        f"{signed(round(end.mean / count, 1))} ± {number(end.spread / count, 2)}" if end and count else _NONE,
        (end.verdict if end else "") or _NONE,
    )

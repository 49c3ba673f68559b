"""Velocity feedback on a run's page: the measured ratio and k_e over time, and the hypotheses of Thm 8.2."""

from typing import Any

import numpy as np

from smarig.record import Run
from smarig.report.certificate.certificate_page import HOLDS_TEXT, with_subscripts
from smarig.report.closed_loop.closed_loop_figures import loop_hysteresis_figure
from smarig.report.closed_loop.loop_result import TrackingResult
from smarig.report.closed_loop.velocity_result import RATIO, VelocityResult, VelocitySignals, velocity_verdict
from smarig.report.components.decimate import POINTS, envelope
from smarig.report.components.figure import Figure, Panel, Trace, line
from smarig.report.components.html import Html, cards, joined, notice, paragraph, table, tag
from smarig.report.components.numbers import number, signed
from smarig.report.components.run_description import (
    display_unit,
    input_title,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import CURRENT, GREY, INK, MODEL, POSITION, TEMPERATURE
from smarig.report.runs.time_figures import ROWS, stacked_layout, time_unit

_SHARES = (0.25, 0.22, 0.19, 0.15, 0.19)  # of the height, from above


def velocity_parts(run: Run, found: TrackingResult, velocity: VelocityResult) -> list[Any]:
    """The parts of the section; ``found`` has at least two samples."""
    return [
        _cards(run, found, velocity),
        _verdict(velocity),
        velocity_figure(run, found, velocity),
        _hypotheses_table(velocity),
        loop_hysteresis_figure(run, found.loop),
    ]


def _verdict(velocity: VelocityResult) -> Html:
    broken = [h.name for h in velocity.failing if h.holds is False]
    words = f" This loop violates: {', '.join(broken)}." if broken else ""
    kind = "good" if velocity.within and velocity.better_than_rest else "warning"
    return notice(
        kind, paragraph(tag("b", with_subscripts(velocity_verdict(velocity))), with_subscripts(words))
    )


def _cards(run: Run, found: TrackingResult, velocity: VelocityResult) -> Html:
    f, gain, unit = found.measures, display_unit(velocity.gain_unit), display_unit(run.unit)
    raw = f"wire at rest {number(velocity.rest_ratio)}, unfiltered velocity {number(velocity.raw_ratio)}"
    law = joined(
        [
            f"δ = {number(velocity.delta)} {gain}, γ = {number(velocity.gamma)} {gain}, ",
            with_subscripts("u_o"),
            f" = {number(velocity.offset_K)} K",
        ]
    )
    clipped = "–" if velocity.clipped_share is None else f"{number(100 * velocity.clipped_share)} %"
    peak = "" if f is None else f"peak {number(f.peak_K)} K above ambient, predicted"
    off = found.loop.position[-1] - found.loop.wanted[-1]
    items = [
        ("Measured ratio", number(velocity.ratio), joined([with_subscripts(RATIO), "; ", raw])),
        (with_subscripts("k_e (Thm 8.2)"), number(velocity.k_e), "proved for the operator, not for this rig"),
        ("Controller", found.controller, law),
        ("Samples at a limit", clipped, peak),
        (
            "Position at the end",
            f"{signed(float(off))} {unit}",
            "from the reference; the position is not fed back",
        ),
    ]
    return cards(items)


def velocity_figure(run: Run, found: TrackingResult, velocity: VelocityResult) -> Figure:
    """ṙ and the measured velocity, the ratio up to each time with k_e, position, current and temperature."""
    loop = found.loop
    signals = VelocitySignals.of(found.reference, loop.t_s, loop.position, velocity)
    second, t_unit = time_unit(float(loop.t_s[-1]))
    t, unit = loop.t_s / second, display_unit(run.unit)
    rows = (
        ((signals.velocity, "measured", POSITION, "solid"), (signals.rate, "reference", INK, "dot")),
        ((signals.rest_ratio, "wire at rest", GREY, "dash"), (signals.ratio, "ratio", INK, "solid")),
        ((loop.position, "measured", POSITION, "solid"), (loop.wanted, "reference", INK, "dot")),
        ((loop.current_A, "current", CURRENT, "solid"),),
        ((loop.input_K, "predicted temperature", TEMPERATURE, "solid"),),
    )
    data: list[Trace] = []
    for row, y_axis in zip(rows, ROWS):
        for values, name, colour, dash in row:
            kept = envelope(values, POINTS)
            legend = y_axis == "y" or name == "wire at rest"
            style = {"width": 1.2, "dash": dash, "yaxis": y_axis, "showlegend": legend}
            data.append(line(t[kept], values[kept], name, colour, **style))
    titles = (f"Velocity ({unit}/s)", "Ratio up to t", output_title(run), "Current (A)", input_title(run))
    layout = stacked_layout(titles, f"Time since the loop was closed ({t_unit})", _SHARES)
    if velocity.k_e is not None:
        bound = [velocity.k_e, velocity.k_e]
        data.append(line([t[0], t[-1]], bound, "kₑ", MODEL, width=1.5, dash="dash", yaxis="y2"))
    low, high = _decades(signals, velocity)
    layout["yaxis2"] |= {"type": "log", "range": [low, high], "dtick": 1 if high - low > 1.5 else "D2"}
    return Figure(
        [Panel(data, layout, 860)],
        f"Velocity feedback: controller {found.controller}, reference {found.reference.name}.",
        [
            f"Velocity: differences of the readings through the loop's filter of {velocity.filter_s:g} s.",
            joined(["Ratio: ", with_subscripts(RATIO), " from the closing of the loop to each time."]),
            "Grey: the ratio of a wire at rest.",
            "The position is not fed back, so a position error remains.",
            f"The reference rises from zero in the first {number(velocity.lead_in_s)} s."
            if velocity.lead_in_s
            else "",
            f"n = {loop.t_s.size} samples in closed loop;",
            run_caption(run),
        ],
        source_label(run),
    )


def _decades(signals: VelocitySignals, velocity: VelocityResult) -> tuple[float, float]:
    """Range of the ratio's axis as powers of ten: k_e and both ratios without the first tenth of the samples."""
    rows = (signals.ratio, signals.rest_ratio)
    shown = np.concatenate([row[row.size // 10 :] for row in rows] + [[velocity.k_e or 1.0]])
    shown = shown[np.isfinite(shown) & (shown > 0)]
    return float(np.log10(shown.min() / 1.6)), float(np.log10(shown.max() * 1.6))


def _hypotheses_table(velocity: VelocityResult) -> Html:
    rows = [
        (with_subscripts(h.name), HOLDS_TEXT[h.holds], with_subscripts(h.why)) for h in velocity.hypotheses
    ]
    words = "Hypotheses of Thm 8.2 on model, controller and rig, and whether this loop satisfies them."
    return table(("Hypothesis", "Verdict", "Why"), rows, words)

"""The sections of a run's page for closed loops: performance, figures over time and in the plane, certificate."""

import math
from typing import Any

from smarig.certificate import certificate
from smarig.control import SETTLING_BAND_COUNTS, VELOCITY_CONTROLLERS, default_numbers
from smarig.record import Run
from smarig.replay import Model
from smarig.report.certificate.certificate_page import certificate_parts, certificate_units, certified_model
from smarig.report.closed_loop.closed_loop_figures import (
    loop_hysteresis_figure,
    regulation_figure,
    tracking_figure,
)
from smarig.report.closed_loop.closed_loop_text import loop_assessment, zero_below_resolution
from smarig.report.closed_loop.loop_result import (
    RegulationResult,
    TrackingResult,
    closed_loop_result,
    is_closed_loop,
)
from smarig.report.closed_loop.observed_position import observed_figure, observed_text
from smarig.report.closed_loop.regulation_plane_figure import B_ELL, regulation_plane_figure
from smarig.report.closed_loop.velocity_sections import velocity_parts
from smarig.report.components.html import Html, cards, joined, notice, paragraph, table, tag
from smarig.report.components.numbers import counts, number, signed
from smarig.report.components.page import Section
from smarig.report.components.run_description import display_unit


def loop_sections(run: Run, certified: tuple[Model, str, str] | None = None) -> list[Section]:
    """The sections of a closed-loop run, none for other runs; ``certified``: a model, its file name and hash."""
    if not is_closed_loop(run):
        return []
    found = closed_loop_result(run)
    if found is None:
        parts = [notice("warning", paragraph("The run file's data on its closed loop cannot be read."))]
        return [Section("Closed loop", "Closed loop", parts)]
    parts = (
        _tracking_parts(run, found) if isinstance(found, TrackingResult) else _regulation_parts(run, found)
    )
    if not (isinstance(found, TrackingResult) and found.velocity is not None):
        parts = [loop_assessment(run, found).html(), *parts]
    return [Section("Closed loop", "Closed loop", parts), *_certificate_section(run, found, certified)]


def _tracking_parts(run: Run, found: TrackingResult) -> list:
    if found.measures is None or found.loop.t_s.size < 2:
        return [paragraph("The loop ended before any error was measured.")]
    if found.velocity is not None:
        return velocity_parts(run, found, found.velocity)
    return [
        tracking_figure(run, found),
        _tracking_cards(run, found),
        _steps_table(run, found),
        loop_hysteresis_figure(run, found.loop),
    ]


def _tracking_cards(run: Run, found: TrackingResult) -> Html:
    f, count, unit = found.measures, found.loop.count, display_unit(run.unit)
    if f is None:
        return Html("")
    after = f"after the first {found.skip_s:g} s, " if found.skip_s else ""
    return cards(
        [
            ("Error, rms", f"{number(f.rms)} {unit}", f"{number(f.rms / count)} counts; {after}n = {f.n}"),
            (
                "Largest error",
                f"{number(f.largest)} {unit}",
                f"{number(f.largest / count)} counts; {after}n = {f.n}",
            ),
            ("Controller", found.controller, f"reference: {found.reference.name}"),
            ("Energy", f"{number(f.energy_J)} J", f"in {number(f.seconds)} s"),
            ("Peak temperature", f"{number(f.peak_K)} K", "predicted, above ambient"),
        ]
    )


def _steps_table(run: Run, found: TrackingResult) -> Html:
    f, unit = found.measures, display_unit(run.unit)
    if f is None or not f.settle_s:
        return Html("")
    rows = [
        (
            str(k),
            number(goal, 4),
            number(settled) if math.isfinite(settled) else "never",
            number(over),
            number(over / found.loop.count),
        )
        for k, (goal, settled, over) in enumerate(
            zip(found.reference.position, f.settle_s, f.overshoot), start=1
        )
    ]
    header = ("Step", f"Target ({unit})", "Settled after (s)", f"Overshoot ({unit})", "Overshoot (counts)")
    words = (
        f"Settled: within {SETTLING_BAND_COUNTS:g} counts for 5 s. The values are from readings and include encoder "
        "noise."
    )
    return table(header, rows, words)


def _regulation_parts(run: Run, found: RegulationResult) -> list:
    held = regulation_figure(run, found)
    parts = [
        *([held] if held else []),
        _regulation_cards(run, found),
        *_observed_parts(run, found),
        regulation_plane_figure(run, found),
    ]
    if held is None or found.loop is None:
        return [*parts, paragraph("The run ended during the approach, before the loop was closed.")]
    return [*parts, loop_hysteresis_figure(run, found.loop, moves=False)]


def _observed_parts(run: Run, found: RegulationResult) -> list:
    """The observer of a loop without encoder: its errors in words, and its position beside the encoder's."""
    if found.observed is None:
        return []
    text = paragraph(observed_text(found.observed, display_unit(run.unit)))
    return [text, observed_figure(run, found.observed)]


def _regulation_cards(run: Run, found: RegulationResult) -> Html:
    setpoint_data, unit = found.setpoint_data, display_unit(run.unit)
    area = setpoint_data.get("area_K2")
    items = [
        ("Set-point", f"{number(setpoint_data['setpoint'], 4)} {unit}", f"start: {setpoint_data['start']}")
    ]
    if area:
        reached = number(100 * found.distance_K2 / area) if found.distance_K2 is not None else "–"
        items.append(
            (
                joined(["Distance from ", B_ELL]),
                f"{reached} %",
                f"of the plane; predicted {number(100 * setpoint_data['predicted_distance_K2'] / area)} %",
            )
        )
    size = found.loop.count if found.loop else 0.0
    if (error := found.output_error) is not None:
        note = f"{_counts_text(found, error, sign=True)}from the set-point, before the loop is closed"
        items.append(("After the approach", f"{signed(zero_below_resolution(error, size))} {unit}", note))
    if (most := found.transient) is not None:
        note = f"{_counts_text(found, most)}of the readings, after the disturbance starts"
        items.append(("Largest transient", f"{number(most)} {unit}", note))
    if (end := found.end) is not None:
        std = counts(end.std / end.count) if end.count else f"{number(end.std)} {unit}"
        mean = _counts_text(found, end.mean, sign=True)
        note = f"{mean}mean of the last {number(end.seconds)} s; standard deviation {std}"
        items.append(("At the end", f"{signed(zero_below_resolution(end.mean, end.count))} {unit}", note))
    return cards(items)


def _counts_text(found: RegulationResult, value: float, *, sign: bool = False) -> str:
    count = found.loop.count if found.loop else 0.0
    return f"{counts(value / count, sign=sign)}; " if count else ""


def _certificate_scope_notice(run: Run, found: TrackingResult | RegulationResult) -> Html:
    """A notice that no theorem covers the loop on this page; it precedes the table that states "covered"."""
    settings = run.info.settings
    if isinstance(found, TrackingResult) and found.velocity is not None:
        return notice(
            "warning",
            paragraph(
                tag("b", "This certificate covers the operator without delay, noise and quantisation. "),
                f"The loop on this page ({found.controller}) has all three. The table in the section Closed loop "
                "states which hypotheses it satisfies.",
            ),
        )
    name = found.controller if isinstance(found, TrackingResult) else str(settings.get("controller") or "pi")
    held = f"tracked {found.reference.name}" if isinstance(found, TrackingResult) else "held a set-point"
    return notice(
        "warning",
        paragraph(
            tag("b", "This certificate does not cover the loop on this page. "),
            f"The loop fed back the position (controller {name}, which {held}). Thm 8.2 and its table below concern "
            "velocity feedback, which this run did not use. Two statements apply to this run: whether the model's "
            "hysteresis is passive, and with what bias; and the last of the limits, on position loops.",
        ),
    )


def _certificate_section(
    run: Run, found: TrackingResult | RegulationResult, certified: tuple[Model, str, str] | None
) -> list[Section]:
    if certified is None:
        return []
    model, name, sha256 = certified
    used = run.info.settings.get("model_sha256")
    parts: list = [_certificate_scope_notice(run, found)]
    if used and used != sha256:
        words = f"This loop did not use {name}. It used {run.info.settings.get('model')}."
        parts.append(notice("warning", paragraph(words)))
    model_certificate = certificate(model.hysteresis, _controllers_run(run, found), certificate_units(model))
    parts += certificate_parts(model_certificate, certified_model(model, name, sha256))
    return [Section("Certificate of the model", "Certificate", parts)]


def _controllers_run(run: Run, found: TrackingResult | RegulationResult) -> dict[str, dict[str, Any]] | None:
    """The run's velocity controller with its settings; None (all controllers) if the run fed back the position."""
    if not isinstance(found, TrackingResult) or found.velocity is None:
        return None
    settings = run.info.settings
    numbers = default_numbers(VELOCITY_CONTROLLERS, found.controller)
    return {found.controller: {key: settings[key] for key in numbers if key in settings}}

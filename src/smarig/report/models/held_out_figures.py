"""Figures of a model on held-out data: the measured loops with it, and its errors over input and time."""

import numpy as np

from smarig.core import Array, root_mean_square, spaced
from smarig.identification import RunVerification
from smarig.record import Run
from smarig.replay import recorded_start
from smarig.report.components.decimate import simplified
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, error_ground, line
from smarig.report.components.run_description import (
    count_size,
    input_title,
    loop_axes,
    output_title,
    run_caption,
    source_label,
)
from smarig.report.components.style import BAD, EXTENDED, INK, MEASURED, MODEL, surface_colour
from smarig.report.models.evidence import Evidence
from smarig.report.models.identification_plot_data import resimulated
from smarig.report.runs.sample_path import sample_path

_PER_MOVE = 80  # inputs of the model between two settled points: fewer are chords across the bends
_DRIFT_SHARE, _DRIFT_ORDER = 0.5, 2  # of the square error; of the polynomial in time that explains it
_TOLERANCE, _MOST = 5e-4, 3000  # of the drawn path


def loop_figure(e: Evidence, training: Run) -> Figure | None:
    """Measured path and settled points with the chosen model; its errors on the first held-out run, if there is one."""
    if e.best is None or len(training.settled) < 2:
        return None
    panels = [Panel(_loops(e, training), loop_axes(training), 400, explore=True)]
    words = f"Grey: the path of the samples; dots: settled points; green: the {e.chosen} model with the same inputs."
    held_out = _held_out(e)
    if held_out is not None:
        verification, run = held_out
        extended = _extended_errors(e, verification)
        panels.append(_error_panel(verification, run, e.chosen, extended))
        floor = verification.noise_floor
        band = f"; band: ± 2 σ, noise floor of that run {floor:.2g}{spaced(run.unit)}" if floor else ""
        words += f" Second panel: measured − model on the held-out run, rms {verification.settled.rms:.3g}"
        words += f"{spaced(run.unit)}, n = {verification.settled.n}{band}."
        if extended is not None:
            rms = root_mean_square(extended)
            words += f" Pink: the extended model of the diagnosis, rms {rms:.3g}{spaced(run.unit)}."
        if _drifts(verification, run):
            words += " The errors are drawn over time, with which they change."
    return Figure(panels, "Measured loops and the model.", [words], source_label(training), 460)


def _loops(e: Evidence, run: Run) -> list[Trace]:
    inputs, outputs = run.points()
    drawn: list[Trace] = []
    kept = sample_path(run["input"], run["position"], count_size(run))
    if kept.size > inputs.size:
        drawn.append(line(run["input"][kept], run["position"][kept], "measured", MEASURED, width=2.4))
    assert e.best is not None  # noqa: S101 - checked by the caller
    u, y = resimulated(e.best, inputs, _PER_MOVE, initial=recorded_start(run) or "negative")
    shown = simplified(u, y, _TOLERANCE, _MOST)
    drawn.append(line(u[shown], y[shown], f"{e.chosen} model", MODEL, width=1.2))
    drawn.append(dots(inputs, outputs, "settled points", INK, size=4))
    return drawn


def _held_out(e: Evidence) -> tuple[RunVerification, Run] | None:
    found = e.verifications.get(e.chosen)
    runs = {str(run.path): run for run in e.runs.values()}
    for one in found.runs if found else ():
        if one.run in runs:
            return one, runs[one.run]
    return None


def _extended_errors(e: Evidence, found: RunVerification) -> Array | None:
    """Measured − model of the extended model at the same points; None without one, or if it counts other points."""
    d, chosen = e.diagnosis, e.verifications[e.chosen]
    if d is None or not d.extended or d.gain is None or d.gain.settled is None or len(chosen.runs) != 1:
        return None
    errors = d.gain.extended_error[d.gain.settled]
    return errors if errors.size == np.count_nonzero(found.counted) else None


def _drifts(found: RunVerification, run: Run) -> bool:
    """Whether a slow change with time makes up most of the errors: against the input, a drift is invisible."""
    t, _ = point_times(run, np.arange(found.input.size, dtype=float))
    t, error = t[found.counted], found.error[found.counted]
    if error.size <= 2 * _DRIFT_ORDER or not np.ptp(error):
        return False
    t = (t - t.mean()) / (np.ptp(t) or 1.0)
    rest = error - np.polyval(np.polyfit(t, error, _DRIFT_ORDER), t)
    return float(np.var(rest)) < (1 - _DRIFT_SHARE) * float(np.var(error))


def _error_panel(found: RunVerification, run: Run, chosen: str, extended: Array | None) -> Panel:
    """Errors against the input; over time if they drift."""
    x, title = found.input, input_title(run)
    if _drifts(found, run):
        x, title = point_times(run, np.arange(x.size, dtype=float))
    data = error_ground(x, found.noise_floor)
    name = "measured − model, held out" if extended is None else f"{chosen} model, held out"
    data.append(dots(x, found.error, name, INK, size=6))
    if extended is not None:
        data.append(dots(x[found.counted], extended, "extended model", EXTENDED, size=6))
    layout = {"xaxis": axis(title), "yaxis": axis(f"Measured − model ({run.unit})")}
    return Panel(data, layout, 400)


def validation_figure(verification: RunVerification, run: Run, surface: str) -> Figure:
    """Measured and model in order of time; the error against time and against the input."""
    order = np.arange(verification.input.size, dtype=float)
    t, t_title = point_times(run, order)
    colour = surface_colour(surface)
    data: list[Trace] = [
        line(t, verification.measured, "measured", INK, mode="lines+markers", width=1, dash="dot"),
        dots(
            t,
            verification.predicted,
            f"{surface} model",
            colour,
            symbol="circle-open",
            size=10,
            marker={"line": {"width": 2}},
        ),
    ]
    first = {"xaxis": axis(t_title), "yaxis": axis(output_title(run))}
    by_time = _residual(t, verification, run, t_title)
    by_input = _residual(verification.input, verification, run, input_title(run))
    e, unit = verification.settled, run.unit
    points = "settled points" if run.settled else "readings"
    floor = (
        f"; noise floor of this run {verification.noise_floor:.2g}{spaced(unit)} (band: ± 2 σ)"
        if verification.noise_floor
        else "; noise floor unknown"
    )
    zero = (
        "The zero of the output is that of the training runs. Nothing was fitted to this run."
        if verification.offset_kind == "known"
        else f"One additive offset ({verification.offset:.3g}{spaced(unit)}) was fitted because the "
        "zero of the output is not "
        "known."
    )
    return Figure(
        [Panel(data, first, 380, wide=True), by_time, by_input],
        f"The {surface} model on the held-out run.",
        [
            f"First panel: {e.n} {points} in order of time. Other panels: measured − model against time and "
            f"against the input. The error is {e.rms:.3g}{spaced(unit)} ({e.share_text}), at "
            f"most {e.max_abs:.3g}{spaced(unit)}{floor}. {zero}",
            run_caption(run),
        ],
        source_label(run),
        460,
    )


def point_times(run: Run, order: np.ndarray) -> tuple[np.ndarray, str]:
    ends = [step.t_end_s for step in run.settled]
    if len(ends) != order.size or not ends or any(end is None for end in ends) or not run.has("t_s"):
        return order, "Point, in order of measurement"
    begin = float(run["t_s"][np.isfinite(run["t_s"])][0])
    return (np.array(ends, dtype=float) - begin) / 60, "Time since the start of the run (min)"


def _residual(x: np.ndarray, verification: RunVerification, run: Run, title: str) -> Panel:
    data, error = error_ground(x, verification.noise_floor), verification.error
    late = np.array([step.verdict != "settled" for step in run.settled])
    data.append(dots(x, error, "measured − model", INK, size=6))
    if late.size == x.size and late.any():
        data.append(
            dots(x[late], error[late], f"{int(late.sum())} not settled", BAD, symbol="circle-open", size=11)
        )
    return Panel(data, {"xaxis": axis(title), "yaxis": axis(f"Measured − model ({run.unit})")}, 340)

"""The figure of a model on a held-out run: measured, predicted, and the error with the noise floor."""

import numpy as np

from smarig.core import spaced
from smarig.identification import RunVerification
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.components.run_description import input_title, output_title, run_caption, source_label
from smarig.report.components.style import BAD, GREY, INK, surface_colour
from smarig.report.runs.representation_figure import noise_band


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
    error = np.where(verification.counted, verification.measured - verification.predicted, np.nan)
    by_time = _residual(t, error, verification, run, t_title)
    by_input = _residual(verification.input, error, verification, run, input_title(run))
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


def _residual(x: np.ndarray, error: np.ndarray, verification: RunVerification, run: Run, title: str) -> Panel:
    data: list[Trace] = []
    if verification.noise_floor:
        data.append(
            noise_band(
                float(np.min(x)), float(np.max(x)), 2 * verification.noise_floor, "± 2 σ of the noise floor"
            )
        )
    data.append(line([np.min(x), np.max(x)], [0, 0], "zero", GREY, width=1, showlegend=False))
    late = np.array([step.verdict != "settled" for step in run.settled])
    data.append(dots(x, error, "measured − model", INK, size=6))
    if late.size == x.size and late.any():
        data.append(
            dots(x[late], error[late], f"{int(late.sum())} not settled", BAD, symbol="circle-open", size=11)
        )
    return Panel(data, {"xaxis": axis(title), "yaxis": axis(f"Measured − model ({run.unit})")}, 340)

"""The main figure of a characterisation: measured loops with the model, and its errors on held-out data."""

import numpy as np

from smarig.core import Array, root_mean_square, spaced
from smarig.identification import RunVerification
from smarig.record import Run
from smarig.replay import recorded_start
from smarig.report.components.decimate import simplified
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.components.run_description import count_size, input_title, output_title, source_label
from smarig.report.components.style import EXTENDED, GREY, INK, MEASURED, MODEL
from smarig.report.models.evidence import Evidence
from smarig.report.models.identification_plot_data import resimulated
from smarig.report.models.validation_figure import point_times
from smarig.report.runs.representation_figure import noise_band
from smarig.report.runs.sample_path import sample_path

_PER_MOVE = 80  # inputs of the model between two settled points: fewer are chords across the bends
_DRIFT_SHARE, _DRIFT_ORDER = 0.5, 2  # of the square error; of the polynomial in time that explains it
_TOLERANCE, _MOST = 5e-4, 3000  # of the drawn path


def loop_figure(e: Evidence, training: Run) -> Figure | None:
    """Measured path and settled points with the chosen model; its errors on the first held-out run, if there is one."""
    if e.best is None or len(training.settled) < 2:
        return None
    panels = [Panel(_loops(e, training), _axes(training), 400, explore=True)]
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


def _axes(run: Run) -> dict[str, object]:
    return {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}


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
    t, error = t[found.counted], (found.measured - found.predicted)[found.counted]
    if error.size <= 2 * _DRIFT_ORDER or not np.ptp(error):
        return False
    t = (t - t.mean()) / (np.ptp(t) or 1.0)
    rest = error - np.polyval(np.polyfit(t, error, _DRIFT_ORDER), t)
    return float(np.var(rest)) < (1 - _DRIFT_SHARE) * float(np.var(error))


def _error_panel(found: RunVerification, run: Run, chosen: str, extended: Array | None) -> Panel:
    """Errors against the input; over time if they drift."""
    error = np.where(found.counted, found.measured - found.predicted, np.nan)
    x, title = found.input, input_title(run)
    if _drifts(found, run):
        x, title = point_times(run, np.arange(x.size, dtype=float))
    low, high = float(np.min(x)), float(np.max(x))
    data: list[Trace] = []
    if found.noise_floor:
        data.append(noise_band(low, high, 2 * found.noise_floor, "± 2 σ of the noise floor"))
    data.append(line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False))
    name = "measured − model, held out" if extended is None else f"{chosen} model, held out"
    data.append(dots(x, error, name, INK, size=6))
    if extended is not None:
        data.append(dots(x[found.counted], extended, "extended model", EXTENDED, size=6))
    layout = {"xaxis": axis(title), "yaxis": axis(f"Measured − model ({run.unit})")}
    return Panel(data, layout, 400)

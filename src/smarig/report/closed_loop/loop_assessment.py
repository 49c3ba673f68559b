"""Whether a closed loop reached its goal: what was measured, pass or fail, and what to do."""

import numpy as np

from smarig.control import SETTLING_BAND_COUNTS, TrackingPerformance
from smarig.record import Run
from smarig.report.closed_loop.closed_loop_text import offset_text, size, unsteady_text
from smarig.report.closed_loop.loop_result import RegulationResult, TrackingResult
from smarig.report.components.assessment_box import Assessment
from smarig.report.components.numbers import duration, number

_COMPARE = "compare other controllers and gains on the same reference (smarig report RUN RUN)"


def loop_assessment(run: Run, found: TrackingResult | RegulationResult) -> Assessment:
    """The assessment of a loop, built from its figures. The goal is the settling band, in counts of the encoder."""
    if isinstance(found, RegulationResult):
        return _of_regulation(run, found)
    return _of_tracking(run, found)


def _of_tracking(run: Run, found: TrackingResult) -> Assessment:
    f, count = found.measures, found.loop.count
    name = f"{found.controller} along {found.reference.name}"
    if f is None or not count:
        return _unknown(f"Measured: {name}.", "No error was measured, so the loop is not judged.")
    after = f" after the first {found.skip_s:g} s" if found.skip_s else ""
    measured = (
        f"Measured: {name} for {duration(f.seconds)}{after}: error {size(f.rms, run.unit, count)} rms, at most "
        f"{size(f.largest, run.unit, count)}."
    )
    return _of_steps(run, f, count, measured) if f.settle_s else _of_motion(run, f, count, measured)


def _of_steps(run: Run, f: TrackingPerformance, count: float, measured: str) -> Assessment:
    band = size(SETTLING_BAND_COUNTS * count, run.unit, count)
    late = [k for k, settled in enumerate(f.settle_s, start=1) if not np.isfinite(settled)]
    over = f"overshoot at most {size(max(f.overshoot), run.unit, count)}"
    if not late:
        slowest = number(max(f.settle_s), 2)
        verdict = f"Pass: every step settled within {band}, the slowest after {slowest} s; {over}."
        return Assessment("good", measured, verdict, "The controller and its gains can be used as they are.")
    which = (
        f"step {late[0]}" if len(late) == 1 else f"{len(late)} of {len(f.settle_s)} steps (first: {late[0]})"
    )
    verdict = f"Fail: {which} did not settle within {band}; {over}."
    return Assessment("bad", measured, verdict, f"Hold each step longer, or {_COMPARE}.")


def _of_motion(run: Run, f: TrackingPerformance, count: float, measured: str) -> Assessment:
    goal = size(SETTLING_BAND_COUNTS * count, run.unit, count)
    if f.rms <= SETTLING_BAND_COUNTS * count:
        verdict = f"Pass: the rms error is within the goal of {goal}."
        return Assessment("good", measured, verdict, "The controller and its gains can be used as they are.")
    ratio = number(f.rms / (SETTLING_BAND_COUNTS * count), 2)
    verdict = f"Fail: the rms error is {ratio} times the goal of {goal}."
    return Assessment("bad", measured, verdict, f"Slow the reference down, or {_COMPARE}.")


def _of_regulation(run: Run, found: RegulationResult) -> Assessment:
    end, setpoint = found.end, number(found.setpoint_data["setpoint"], 4)
    where = f"Measured: a set-point of {setpoint} {run.unit}"
    if end is None:
        return _unknown(f"{where}.", "The loop was not closed long enough to judge it.")
    transient = (
        f", largest transient {size(found.transient, run.unit, end.count)}"
        if found.transient is not None
        else ""
    )
    off = offset_text(end.mean, run.unit, end.count)
    measured = f"{where}{transient}; mean error over the last {number(end.seconds)} s: {off}."
    if not end.verdict:
        return _unknown(
            measured, "The hold is too short, or its counts are unknown, so the loop is not judged."
        )
    band = size(SETTLING_BAND_COUNTS * end.count, run.unit, end.count)
    if end.verdict == "rests":
        verdict = f"Pass: the position rests at its set-point, within {band}."
        return Assessment("good", measured, verdict, "The set-point can be held with these gains.")
    advice = (
        "Hold longer: the controller is still at work."
        if end.current_trend and end.verdict == "rests off"
        else "Lower the gains if it oscillates; hold longer if it still moves; check the model if it rests elsewhere."
    )
    return Assessment("bad", measured, f"Fail: {unsteady_text(end, run.unit)}", advice)


def _unknown(measured: str, verdict: str) -> Assessment:
    return Assessment("warning", measured, verdict, "Run the loop longer.")

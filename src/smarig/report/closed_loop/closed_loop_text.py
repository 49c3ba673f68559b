"""Results of a closed loop in sentences, for the terminal and for pages, and whether it reached its goal."""

import numpy as np

from smarig.control import SETTLING_BAND_COUNTS, TrackingPerformance
from smarig.record import Run
from smarig.report.closed_loop.hold_end import HoldEnd
from smarig.report.closed_loop.loop_result import RegulationResult, TrackingResult
from smarig.report.closed_loop.observed_position import observed_text
from smarig.report.closed_loop.velocity_result import VelocityResult, velocity_verdict
from smarig.report.components.numbers import counts, duration, number, signed
from smarig.report.components.page_summary import Assessment
from smarig.report.components.run_description import display_unit


def loop_result_text(found: TrackingResult | RegulationResult, unit: str) -> str:
    """The result for a terminal."""
    return _tracking_text(found, unit) if isinstance(found, TrackingResult) else _regulation_text(found, unit)


def _tracking_text(found: TrackingResult, unit: str) -> str:
    f, count = found.measures, found.loop.count
    if f is None:
        return (
            f"{found.controller} along {found.reference.name}: the loop ended before any error was measured."
        )
    if found.velocity is not None:
        return _velocity_text(found, found.velocity, unit)
    after = f", after the first {found.skip_s:g} s" if found.skip_s else ""
    lines = [
        f"{found.controller} along {found.reference.name}: error {f.rms:.3g} {unit} rms ({f.rms / count:.2f} counts), "
        f"at most {f.largest:.3g} {unit} ({f.largest / count:.1f} counts){after}; {f.energy_J:.0f} J, "
        f"peak {f.peak_K:.0f} K above ambient."
    ]
    lines += [
        f"  step {k}: within {SETTLING_BAND_COUNTS:g} counts "
        + (f"after {settled:.1f} s" if np.isfinite(settled) else "never")
        + f", overshoot {over / count:.1f} counts."
        for k, (settled, over) in enumerate(zip(f.settle_s, f.overshoot), start=1)
    ]
    return "\n".join(lines)


def _velocity_text(found: TrackingResult, velocity: VelocityResult, unit: str) -> str:
    f, off = found.measures, float(found.loop.position[-1] - found.loop.wanted[-1])
    spent = f"; {f.energy_J:.0f} J, peak {f.peak_K:.0f} K above ambient" if f else ""
    clipped = (
        ""
        if velocity.clipped_share is None
        else f", {100 * velocity.clipped_share:.0f} % of the samples clipped"
    )
    broken = ", ".join(h.name for h in velocity.failing)
    return "\n".join(
        [
            f"{found.controller} along {found.reference.name}: {velocity_verdict(velocity)}",
            f"Unfiltered velocity: {number(velocity.raw_ratio)}{clipped}; δ = {number(velocity.delta)}, γ = "
            f"{number(velocity.gamma)} {velocity.gain_unit}, u_o = {number(velocity.offset_K)} K{spent}.",
            *([f"Hypotheses of Thm 8.2 that this loop violates: {broken}."] if broken else []),
            f"The position is not fed back: at the end {offset_text(off, unit, found.loop.count)} from its reference.",
        ]
    )


def _regulation_text(found: RegulationResult, unit: str) -> str:
    setpoint_data, lines = found.setpoint_data, []
    count = found.loop.count if found.loop else 0.0
    if setpoint_data.get("ell_K") is not None:
        shares = f"{100 * setpoint_data['predicted_distance_K2'] / setpoint_data['area_K2']:.2f} % of the plane (plan)"
        if found.distance_K2 is not None:
            shares += (
                f", {100 * found.distance_K2 / setpoint_data['area_K2']:.2f} % (from the measured current)"
            )
        lines.append(
            f"B_ℓ with ℓ = {setpoint_data['ell_K']:.1f} K, ψ(ℓ) = {setpoint_data['output']:.4g} {unit}; distance "
            f"from B_ℓ: {shares}."
        )
    else:
        lines.append(f"State on the {setpoint_data['start']} branch, input {setpoint_data['rest_K']:.1f} K.")
    if found.output_error is not None:
        lines.append(
            f"After the approach: {offset_text(found.output_error, unit, count)} from the set-point."
        )
    if found.transient is not None:
        largest = size(found.transient, unit, count)
        lines.append(f"Largest transient after the disturbance: {largest}.")
    if found.end is not None:
        lines += [hold_end_text(found.end, unit), *filter(None, [unsteady_text(found.end, unit)])]
    if found.observed is not None:
        lines.append(observed_text(found.observed, display_unit(unit)))
    return "\n".join(lines)


def offset_text(value: float, unit: str, count: float) -> str:
    """A difference with its sign, in the unit and in counts.

    >>> offset_text(-0.094, "mm", 0.047), offset_text(-5e-5, "mm", 0.047)
    ('−0.094 mm (−2.0 counts)', '0 mm (0.0 counts)')
    """
    difference = f"{signed(zero_below_resolution(value, count))} {display_unit(unit)}"
    return difference + (f" ({counts(value / count, sign=True)})" if count else "")


def zero_below_resolution(value: float, count: float) -> float:
    """A mean of readings, or 0 if it is below a twentieth of a count and would be printed as 0.0 counts.

    >>> zero_below_resolution(-5e-5, 0.047), zero_below_resolution(-5e-5, 0.0)
    (0.0, -5e-05)
    """
    return 0.0 if abs(value) < count / 20 else value


def size(value: float, unit: str, count: float) -> str:
    """A magnitude in the unit and in counts.

    >>> size(0.094, "mm", 0.047)
    '0.094 mm (2.0 counts)'
    """
    return f"{number(value)} {display_unit(unit)}" + (f" ({counts(value / count)})" if count else "")


def hold_end_text(end: HoldEnd, unit: str) -> str:
    """Mean error, standard deviation and current range at the end of a hold."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    return (
        f"Last {number(end.seconds)} s: mean error {offset_text(end.mean, unit, end.count)}, standard deviation "
        f"{size(end.std, unit, end.count)}; current {least} to {most} A."
    )


def unsteady_text(end: HoldEnd, unit: str) -> str:
    """A sentence on a loop that has not settled, or settled off its set-point; "" if it settled there or unknown."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    peak_to_peak = size(end.peak_to_peak, unit, end.count)
    begin, now = (least, most) if end.current_trend == "raises" else (most, least)
    trend = f" while the controller still {end.current_trend} the current, from {begin} A to {now} A"
    rests, still = ("stands", trend) if end.current_trend else ("settled", "")
    between = f"; the current is between {least} A and {most} A"
    return {
        "swings": f"The position oscillates at the end of the hold: {peak_to_peak} peak to peak{between}.",
        "moves": f"The position still moves at the end of the hold: {peak_to_peak} in {number(end.seconds)} s"
        f"{between}.",
        "rests off": f"The position {rests} {size(abs(end.mean), unit, end.count)} from the set-point{still}.",
    }.get(end.verdict, "")


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

"""What a closed loop did, in sentences: for a terminal, and those that a page shares with it. Computes nothing."""

import numpy as np

from smarig.control import SETTLING_BAND_COUNTS
from smarig.report.closed_loop.hold_end import HoldEnd
from smarig.report.closed_loop.loop_result import RegulationResult, TrackingResult
from smarig.report.closed_loop.velocity_result import VelocityResult, velocity_verdict
from smarig.report.components.numbers import counts, number, signed
from smarig.report.components.run_description import display_unit


def loop_result_text(found: TrackingResult | RegulationResult, unit: str) -> str:
    """The result for a terminal."""
    return _tracking_text(found, unit) if isinstance(found, TrackingResult) else _regulation_text(found, unit)


def _tracking_text(found: TrackingResult, unit: str) -> str:
    f, count = found.measures, found.loop.count
    if f is None:
        return f"{found.controller} along {found.reference.name}: ended before anything could be measured."
    if found.velocity is not None:
        return _velocity_text(found, found.velocity, unit)
    after = f", from {found.skip_s:g} s on" if found.skip_s else ""
    lines = [
        f"{found.controller} along {found.reference.name}: error {f.rms:.3g} {unit} rms ({f.rms / count:.2f} counts), "
        f"at most {f.largest:.3g} {unit} ({f.largest / count:.1f} counts){after}; {f.energy_J:.0f} J, "
        f"peak {f.peak_K:.0f} K above ambient."
    ]
    lines += [
        f"  step {k}: within {SETTLING_BAND_COUNTS:g} counts "
        + (f"after {settled:.1f} s" if np.isfinite(settled) else "never")
        + f", {over / count:.1f} counts beyond."
        for k, (settled, over) in enumerate(zip(f.settle_s, f.overshoot), start=1)
    ]
    return "\n".join(lines)


def _velocity_text(found: TrackingResult, velocity: VelocityResult, unit: str) -> str:
    f, off = found.measures, float(found.loop.position[-1] - found.loop.wanted[-1])
    spent = f"; {f.energy_J:.0f} J, peak {f.peak_K:.0f} K above ambient" if f else ""
    clipped = (
        "" if velocity.clipped_share is None else f", {velocity.clipped_share:.0%} of the samples clipped"
    )
    broken = ", ".join(h.name for h in velocity.failing)
    return "\n".join(
        [
            f"{found.controller} along {found.reference.name}: {velocity_verdict(velocity)}",
            f"Unfiltered velocity: {number(velocity.raw_ratio)}{clipped}; δ = {number(velocity.delta)}, γ = "
            f"{number(velocity.gamma)} {velocity.gain_unit}, u_o = {number(velocity.offset_K)} K{spent}.",
            *([f"Hypotheses of Thm 8.2 that this loop does not keep: {broken}."] if broken else []),
            f"The position is not fed back: at the end {offset_text(off, unit, found.loop.count)} from its path.",
        ]
    )


def _regulation_text(found: RegulationResult, unit: str) -> str:
    setpoint_data, lines = found.setpoint_data, []
    count = found.loop.count if found.loop else 0.0
    if setpoint_data.get("ell_K") is not None:
        shares = (
            f"{setpoint_data['predicted_distance_K2'] / setpoint_data['area_K2']:.2%} of the plane predicted"
        )
        if found.distance_K2 is not None:
            shares += f", {found.distance_K2 / setpoint_data['area_K2']:.2%} by the measured current"
        lines.append(
            f"B_ℓ with ℓ = {setpoint_data['ell_K']:.1f} K, ψ(ℓ) = {setpoint_data['output']:.4g} {unit}; distance "
            f"{shares}."
        )
    else:
        lines.append(f"On the {setpoint_data['start']} branch, resting at {setpoint_data['rest_K']:.1f} K.")
    if found.output_error is not None:
        lines.append(f"After the approach {offset_text(found.output_error, unit, count)} from the set-point.")
    if found.transient is not None:
        largest = size(found.transient, unit, count)
        lines.append(f"Largest transient of the readings from the disturbance on: {largest}.")
    if found.end is not None:
        lines += [hold_end_text(found.end, unit), *filter(None, [unsteady_text(found.end, unit)])]
    return "\n".join(lines)


def offset_text(value: float, unit: str, count: float) -> str:
    """A difference, its sign told either way: above or below what was wanted.

    >>> offset_text(-0.094, "mm", 0.047), offset_text(-5e-5, "mm", 0.047)
    ('−0.094 mm (−2.0 counts)', '0 mm (0.0 counts)')
    """
    difference = f"{signed(zero_below_resolution(value, count))} {display_unit(unit)}"
    return difference + (f" ({counts(value / count, sign=True)})" if count else "")


def zero_below_resolution(value: float, count: float) -> float:
    """A mean of readings, 0 where it is below a twentieth of a count, which is printed as none.

    >>> zero_below_resolution(-5e-5, 0.047), zero_below_resolution(-5e-5, 0.0)
    (0.0, -5e-05)
    """
    return 0.0 if abs(value) < count / 20 else value


def size(value: float, unit: str, count: float) -> str:
    """How large something is, whichever way.

    >>> size(0.094, "mm", 0.047)
    '0.094 mm (2.0 counts)'
    """
    return f"{number(value)} {display_unit(unit)}" + (f" ({counts(value / count)})" if count else "")


def hold_end_text(end: HoldEnd, unit: str) -> str:
    """Mean and spread of the last stretch, and the current it took."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    return (
        f"In the last {number(end.seconds)} s {offset_text(end.mean, unit, end.count)} from the set-point on average, "
        f"{size(end.std, unit, end.count)} rms about that; current {least} to {most} A."
    )


def unsteady_text(end: HoldEnd, unit: str) -> str:
    """That a loop does not rest, or rests off its set-point; "" where it rests there, or nothing can be said."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    peak_to_peak = size(end.peak_to_peak, unit, end.count)
    between = f", the current between {least} A and {most} A"
    return {
        "swings": f"It does not rest: it swings by {peak_to_peak}{between}.",
        "moves": f"It does not rest: it still moves, by {peak_to_peak} in {number(end.seconds)} s{between}.",
        "rests off": f"It rests {size(abs(end.mean), unit, end.count)} off.",
    }.get(end.verdict, "")

"""What a closed loop did, in sentences: for a terminal, and those that a page shares with it. Computes nothing."""

import numpy as np

from smarig.control.tracking.measures import WITHIN_COUNTS
from smarig.report.closed_loop import Regulated, TrackedRun
from smarig.report.conditions import exact_unit
from smarig.report.loop_end import LoopEnd
from smarig.report.numbers import counts, number, signed


def in_words(found: TrackedRun | Regulated, unit: str) -> str:
    """The result for a terminal."""
    return _tracked(found, unit) if isinstance(found, TrackedRun) else _regulated(found, unit)


def _tracked(found: TrackedRun, unit: str) -> str:
    f, count = found.figures, found.loop.count
    if f is None:
        return f"{found.controller} along {found.reference.name}: ended before anything could be measured."
    after = f", from {found.skip_s:g} s on" if found.skip_s else ""
    lines = [
        f"{found.controller} along {found.reference.name}: error {f.rms:.3g} {unit} rms ({f.rms / count:.2f} counts), "
        f"at most {f.largest:.3g} {unit} ({f.largest / count:.1f} counts){after}; {f.energy_J:.0f} J, "
        f"peak {f.peak_K:.0f} K above ambient."
    ]
    lines += [
        f"  step {k}: within {WITHIN_COUNTS:g} counts "
        + (f"after {settled:.1f} s" if np.isfinite(settled) else "never")
        + f", {over / count:.1f} counts beyond."
        for k, (settled, over) in enumerate(zip(f.settle_s, f.overshoot), start=1)
    ]
    return "\n".join(lines)


def _regulated(found: Regulated, unit: str) -> str:
    facts, lines = found.facts, []
    count = found.loop.count if found.loop else 0.0
    if facts.get("ell_K") is not None:
        shares = f"{facts['predicted_distance_K2'] / facts['area_K2']:.2%} of the plane foretold"
        if found.distance_K2 is not None:
            shares += f", {found.distance_K2 / facts['area_K2']:.2%} by the measured current"
        lines.append(
            f"B_ℓ with ℓ = {facts['ell_K']:.1f} K, ψ(ℓ) = {facts['output']:.4g} {unit}; distance {shares}."
        )
    else:
        lines.append(f"On the {facts['start']} branch, resting at {facts['rest_K']:.1f} K.")
    if found.output_error is not None:
        lines.append(f"After the approach {off(found.output_error, unit, count)} from the set-point.")
    if found.transient is not None:
        largest = size(found.transient, unit, count)
        lines.append(f"Largest transient of the readings from the disturbance on: {largest}.")
    if found.end is not None:
        lines += [end_words(found.end, unit), *filter(None, [rest_words(found.end, unit)])]
    return "\n".join(lines)


def off(value: float, unit: str, count: float) -> str:
    """A difference, its sign told either way: above or below what was wanted.

    >>> off(-0.094, "mm", 0.047), off(-5e-5, "mm", 0.047)
    ('−0.094 mm (−2.0 counts)', '0 mm (0.0 counts)')
    """
    told = f"{signed(tangible(value, count))} {exact_unit(unit)}"
    return told + (f" ({counts(value / count, sign=True)})" if count else "")


def tangible(value: float, count: float) -> float:
    """A mean of readings, 0 where it is below a twentieth of a count, which is printed as none.

    >>> tangible(-5e-5, 0.047), tangible(-5e-5, 0.0)
    (0.0, -5e-05)
    """
    return 0.0 if abs(value) < count / 20 else value


def size(value: float, unit: str, count: float) -> str:
    """How large something is, whichever way.

    >>> size(0.094, "mm", 0.047)
    '0.094 mm (2.0 counts)'
    """
    return f"{number(value)} {exact_unit(unit)}" + (f" ({counts(value / count)})" if count else "")


def end_words(end: LoopEnd, unit: str) -> str:
    """Mean and spread of the last stretch, and the current it took."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    return (
        f"In the last {number(end.seconds)} s {off(end.mean, unit, end.count)} from the set-point on average, "
        f"{size(end.spread, unit, end.count)} rms about that; current {least} to {most} A."
    )


def rest_words(end: LoopEnd, unit: str) -> str:
    """That a loop does not rest, or rests off its set-point; "" where it rests there, or nothing can be said."""
    least, most = (number(round(current, 3)) for current in end.current_A)
    swing = size(end.swing, unit, end.count)
    between = f", the current between {least} A and {most} A"
    return {
        "swings": f"It does not rest: it swings by {swing}{between}.",
        "moves": f"It does not rest: it still moves, by {swing} in {number(end.seconds)} s{between}.",
        "rests off": f"It rests {size(abs(end.mean), unit, end.count)} off.",
    }.get(end.verdict, "")

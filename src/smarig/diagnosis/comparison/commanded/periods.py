"""Periods where the fit of a periodic effect may start: those at which a sine of the temperature explains most.

    Δy_i = Σ_k J_ik (a sin ωt_k + b cos ωt_k),    J: slopes of an output to the inputs that it remembers

A fit that starts at a wrong period stays there. These traces cost no simulation, so all periods are tried.
"""

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.effect_traces import WEAK_SHARE, Candidate
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies
from smarig.plant import Effect
from smarig.replay import predict

EQUAL_NATS = 2.0  # behind the best: of periods that explain as much, the longest is the smoothest
PERIODS = 80  # tried, evenly in the logarithm, from a few steps to several records


def with_best_period(subject: CommandedProblem, candidate: Candidate, smooth: Discrepancies) -> Candidate:
    """A periodic effect of the temperature with one more trace, at the best period; another candidate as it is."""
    kind = candidate.kind
    names = [p.name for p in kind.parameters if p.period_of]
    if not names:
        return candidate
    period_h, phase = _best(subject, smooth)
    values = {names[0]: period_h, "phase": phase, kind.primary.name: WEAK_SHARE * kind.primary.typical}
    bounded = {p.name: float(np.clip(values[p.name], p.lower, p.upper)) for p in kind.parameters}
    variant: Effect = kind(**bounded)
    base = subject.base
    changed = predict(subject.timeline, base.plant_model, [variant]).stacked(subject.timeline)
    trace = changed - base.prediction.stacked(subject.timeline)
    return candidate.with_trace(variant, trace)


def _best(subject: CommandedProblem, smooth: Discrepancies) -> tuple[float, float]:
    """(period in h, phase in turns) of the longest of the sines that gain most, in closed form for each period."""
    readings, timeline = smooth.readings, subject.timeline
    per_kelvin = (readings.covariance.slope / subject.base.plant_model.stroke)[:, None]
    longest = 4 * timeline.duration_h
    shortest = max(4 * float(np.median(timeline.hold_s)) / 3600, longest / 400)
    rooms = {r.kind: r.t_s for r in timeline.other_readings if r.kind == "room"}
    found = []
    for period_h in np.geomspace(shortest, longest, PERIODS).tolist():
        normal, product = np.zeros((2, 2)), np.zeros(2)
        for p in smooth.ranking:
            if p.kinds[0] in rooms:
                trace = _waves(rooms["room"], period_h)
            elif p.kinds[0] == "settled":
                trace = per_kelvin * np.asarray(readings.slopes @ _waves(readings.times, period_h))
            else:
                continue
            normal += trace.T @ p.precision @ trace
            product += trace.T @ (p.precision @ p.y)
        size = np.linalg.lstsq(normal, product, rcond=1e-9)[0]
        found.append(
            (float(size @ product), period_h, float(np.arctan2(size[1], size[0]) / (2 * np.pi)) % 1.0)
        )
    top = max(gain for gain, _, _ in found)
    return next(one[1:] for one in reversed(found) if one[0] > top - 2 * EQUAL_NATS)


def _waves(t_s: Array, period_h: float) -> Array:
    """Sine and cosine (n, 2) less their values at the start."""
    angle = 2 * np.pi * t_s / (3600 * period_h)
    return np.column_stack([np.sin(angle), np.cos(angle) - 1.0])

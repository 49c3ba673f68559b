"""Performance of a closed loop from its columns: errors, settling of steps, energy, peak temperature."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.control.tracking.reference import Reference
from smarig.core import Array, UsageError, root_mean_square
from smarig.plant import Actuator

SETTLING_BAND_COUNTS = 2.0
SETTLED_FOR_S = 5.0  # time that the position must stay in the band


@dataclass(frozen=True)
class TrackingPerformance:
    """Figures of one loop; positions in the rig's unit, over samples after ``skip_s``.

    ``settle_s`` (k,) for each step of a held reference: time until the position is within 2 counts for 5 s, NaN if
    never; ``overshoot`` (k,) beyond the target. Both end where a controller with preview starts the next step.
    ``energy_J`` = ∫ i²R dt, ``peak_K`` above ambient.
    """

    rms: float
    largest: float
    settle_s: tuple[float, ...]
    overshoot: tuple[float, ...]
    energy_J: float
    peak_K: float
    seconds: float
    n: int


def tracking_performance(
    reference: Reference,
    t_s: ArrayLike,
    position: ArrayLike,
    current_A: ArrayLike,
    input_K: ArrayLike,
    actuator: Actuator,
    per_count: float,
    *,
    skip_s: float = 0.0,
    ahead_s: float = 0.0,
) -> TrackingPerformance:
    """Performance from columns (n,) with t_s from the closing of the loop; the controller has a preview ``ahead_s``."""
    t, y, i, u = (np.asarray(c, dtype=float) for c in (t_s, position, current_A, input_K))
    if t.size < 2:
        raise UsageError("The performance of a closed loop needs at least two samples.")
    error = y - np.array([reference.at(v) for v in t.tolist()])
    evaluated = error[t >= skip_s] if np.any(t >= skip_s) else error
    dt = float(np.median(np.diff(t)))
    steps = _steps(reference, t, y, per_count, ahead_s) if reference.held else ()
    return TrackingPerformance(
        rms=root_mean_square(evaluated),
        largest=float(np.abs(evaluated).max()),
        settle_s=tuple(s for s, _ in steps),
        overshoot=tuple(o for _, o in steps),
        energy_J=float(np.sum(i**2) * actuator.resistance_ohm * dt),
        peak_K=float(np.abs(u).max()),
        seconds=float(t[-1] - t[0]),
        n=evaluated.size,
    )


def _steps(
    reference: Reference, t: Array, y: Array, per_count: float, ahead_s: float
) -> tuple[tuple[float, float], ...]:
    """(settling time, overshoot) of each step; the last point of a reference is its end, not a step."""
    found = []
    last = len(reference.t_s) - 2
    for k, (start, goal) in enumerate(zip(reference.t_s[:-1], reference.position[:-1])):
        end = reference.t_s[k + 1] - (ahead_s if k < last else 0.0)
        inside = (t >= start) & (t < end)
        if inside.sum() < 2:
            continue
        time, deviation = t[inside] - start, y[inside] - goal
        direction = math.copysign(1.0, -deviation[0])
        found.append(
            (_settled_after(time, deviation, per_count), max(0.0, float(np.max(direction * deviation))))
        )
    return tuple(found)


def _settled_after(time: Array, deviation: Array, per_count: float) -> float:
    """The first time after which the position is within 2 counts for 5 s, or to the end of the step."""
    near = np.abs(deviation) <= SETTLING_BAND_COUNTS * per_count
    for k in np.flatnonzero(near).tolist():
        stays = time >= time[k]
        stays &= time <= time[k] + SETTLED_FOR_S
        if near[stays].all():
            return float(time[k])
    return math.nan

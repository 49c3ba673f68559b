"""The period with which a channel swings, where a fit of a periodic effect may start."""

import numpy as np

from smarig.core import Array
from smarig.replay import Timeline

MIN_SHARE = 0.5  # of the channel's variance: noise alone has no such period
PER_CYCLE = 8  # frequencies tried for each additional cycle in the record


def recorded_period_h(timeline: Timeline, kind: str) -> float | None:
    """The strongest period (h) of a kind of readings, by Lomb–Scargle; None if there is none or it is weak."""
    readings = next((r for r in timeline.other_readings if r.kind == kind), None)
    if readings is None or len(readings) < 8 or not np.ptp(readings.value):
        return None
    t_h = readings.t_s / 3600
    duration_h = float(np.ptp(t_h))
    cycles = np.arange(0.5, len(readings) / 2, 1 / PER_CYCLE)
    power = explained_shares(t_h, readings.value, 2 * np.pi * cycles / duration_h)
    best = int(np.argmax(power))
    return duration_h / float(cycles[best]) if power[best] >= MIN_SHARE else None


def explained_shares(t: Array, y: Array, omega: Array) -> Array:
    """The share of the variance of y (n,) that a least-squares fit of 1, cos ωt and sin ωt explains, for each ω (k,).

    This is the generalised Lomb–Scargle periodogram (Zechmeister and Kürster, Astron. Astrophys. 496, 577, 2009, eqs.
    4 to 15). scipy.signal has it too, but takes most of a second to import.
    """
    y = y - y.mean()
    phase = omega[:, None] * t
    cos, sin = np.cos(phase), np.sin(phase)
    cos -= cos.mean(axis=1, keepdims=True)
    sin -= sin.mean(axis=1, keepdims=True)
    # rotated by the angle that makes the two orthogonal, so that one of them may vanish
    cc, ss, cs = (np.einsum("kn,kn->k", a, b) for a, b in ((cos, cos), (sin, sin), (cos, sin)))
    angle = 0.5 * np.arctan2(2 * cs, cc - ss)
    c, s = np.cos(angle), np.sin(angle)
    along, across = c * (cos @ y) + s * (sin @ y), c * (sin @ y) - s * (cos @ y)
    long, short = c**2 * cc + 2 * c * s * cs + s**2 * ss, c**2 * ss - 2 * c * s * cs + s**2 * cc
    least = 1e-12 * t.size
    return (along**2 / np.maximum(long, least) + across**2 / np.maximum(short, least)) / float(y @ y)

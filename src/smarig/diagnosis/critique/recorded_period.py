"""The period with which a channel swings, where a fit of a periodic effect may start."""

import numpy as np
from scipy.signal import lombscargle

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
    centred = readings.value - readings.value.mean()
    power = lombscargle(t_h, centred, 2 * np.pi * cycles / duration_h, normalize=True, floating_mean=True)
    best = int(np.argmax(power))
    return duration_h / float(cycles[best]) if power[best] >= MIN_SHARE else None

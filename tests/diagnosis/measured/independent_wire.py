"""A wire of a few thousand random relays, driven by a temperature. It shares no code with what diagnoses it.

Thresholds are drawn, not gridded, and the output falls when the wire gets hot, as strain does.
"""

import numpy as np

from benchmarks.boxes.relay_worlds import imported_run

RELAYS = 3000


class RelayWire:
    """Relays that switch to hot above ``up`` and back below ``down``, in °C at 0 MPa."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.down = rng.normal(48.0, 5.0, RELAYS)
        self.up = self.down + rng.gamma(4.0, 3.0, RELAYS)
        self.share = rng.dirichlet(np.full(RELAYS, 0.5))

    def strain(self, temperature, stroke=4.0, rise=0.0):
        """Strain in %, along temperatures from a cold start; ``rise`` shifts all thresholds, by a stress."""
        hot, out = np.zeros(RELAYS, dtype=bool), []
        for t in np.asarray(temperature, dtype=float) - rise:
            hot = np.where(t > self.up, True, np.where(t < self.down, False, hot))
            out.append(stroke * (1 - self.share @ hot))
        return np.array(out)


def triangles(peaks, rows: int | list[int] = 60, low=25.0):
    """Temperatures that rise from ``low`` to each peak and fall back; ``rows`` of each ramp, one number or several."""
    counts = [rows] * len(peaks) if isinstance(rows, int) else rows
    parts = [
        np.concatenate([np.linspace(low, p, n), np.linspace(p, low, n)[1:-1]]) for p, n in zip(peaks, counts)
    ]
    return np.concatenate([*parts, [low]])


def lagged(u, lag_s, dt):
    """What a thermometer with a time constant reads, by small steps."""
    read, out = float(u[0]), [float(u[0])]
    for before, after in zip(u[:-1], u[1:]):
        for k in range(20):
            read += (before + (after - before) * (k + 0.5) / 20 - read) * dt / 20 / lag_s
        out.append(read)
    return np.array(out)


def as_run(name, u, y, *, dt=None, stress=None, noise=(0.05, 0.004), seed=0):
    """A run with a measured input: white noise on temperature and strain."""
    rng = np.random.default_rng([seed, len(name)])
    read = u + noise[0] * rng.standard_normal(len(u))
    t = dt * np.arange(len(u)) if dt else None
    return imported_run(name, read, y + noise[1] * rng.standard_normal(len(u)), t, stress)

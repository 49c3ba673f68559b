"""Data in which nothing is hidden: the base's own story, lived again with its noise, hundreds of times.

Temperature noise goes through the hysteresis itself (so it ratchets and is remembered), counts noise is added.
What candidates gain on such data is what they gain from noise alone. Knows no candidates.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from smarig.diagnosis.refit import Refit
from smarig.diagnosis.retelling import Retelling, Subject
from smarig.preisach.operator import Preisach

Array = NDArray[np.float64]


def nulls(told: Retelling, subject: Subject, refitted: Refit, count: int, seed: int) -> Array:
    """Whitened stacked readings (N, count) of stories without any effect."""
    rng = np.random.default_rng([seed, 0x5EED])
    noise = refitted.noise
    felt, t, at = told.felt_K, told.t_s, told.marks
    operator = Preisach(subject.hysteresis, subject.initial)
    decay = np.exp(-np.diff(t, prepend=t[:1]) / noise.correlation_s)
    spread = np.sqrt(1 - decay**2)
    size, n = refitted.scale.size, at.size
    y = np.empty((size, count))
    still = operator.simulate(felt, subject.initial)[at]
    for k in range(count):
        kicks = rng.standard_normal(t.size) * spread
        kicks[0] = rng.standard_normal()
        drift = noise.temperature_K * _filtered(decay, kicks)
        moved = operator.simulate(felt + drift, subject.initial)[at] - still
        y[:n, k] = refitted.fitted + told.follows * moved + rng.standard_normal(n) * noise.white
        y[n:, k] = rng.standard_normal(size - n) * refitted.scale[n:]
    scaled = y / refitted.scale[:, None]
    return solve_triangular(refitted.factor, scaled, lower=True, check_finite=False)


def _filtered(decay: Array, kicks: Array) -> Array:
    value, out = 0.0, np.empty(kicks.size)
    for k, (d, x) in enumerate(zip(decay.tolist(), kicks.tolist())):
        value = value * d + x
        out[k] = value
    return out

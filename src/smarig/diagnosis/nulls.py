"""Data in which nothing is hidden: the base's own story, lived again with its noise, hundreds of times.

Temperature noise goes through the hysteresis itself (so it ratchets and is remembered), counts noise is added.
What candidates gain on such data is what they gain from noise alone. Knows no candidates.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from smarig.diagnosis.refit import Refit
from smarig.story.retelling import Retelling
from smarig.story.subject import Subject

Array = NDArray[np.float64]


def nulls(told: Retelling, subject: Subject, refitted: Refit, count: int, seed: int) -> Array:
    """Whitened stacked readings (N, count) of stories without any effect."""
    rng = np.random.default_rng([seed, 0x5EED])
    noise = refitted.noise
    felt, t, at = told.felt_K, told.t_s, told.marks
    h, initial = subject.hysteresis, subject.initial
    noises = _remembered_noise(t, noise.correlation_s, count, rng)
    size, n = refitted.scale.size, at.size
    y = np.empty((size, count))
    still = told.lived(h, initial, felt)[at]
    for k in range(count):
        moved = told.lived(h, initial, felt + noise.temperature_K * noises[k], count)[at] - still
        y[:n, k] = refitted.fitted + told.follows * moved + rng.standard_normal(n) * noise.white
        y[n:, k] = rng.standard_normal(size - n) * refitted.scale[n:]
    scaled = y / refitted.scale[:, None]
    return solve_triangular(refitted.factor, scaled, lower=True, check_finite=False)


def _remembered_noise(t_s: Array, correlation_s: float, count: int, rng: np.random.Generator) -> Array:
    """Ornstein–Uhlenbeck noise of unit variance at times (m,), (count, m)."""
    decay = np.exp(-np.diff(t_s, prepend=t_s[:1]) / correlation_s)
    kicks = rng.standard_normal((t_s.size, count)) * np.sqrt(1 - decay**2)[:, None]
    value = rng.standard_normal(count)
    for k, d in enumerate(decay.tolist()):
        value = kicks[k] = value * d + kicks[k]
    return kicks.T.copy()

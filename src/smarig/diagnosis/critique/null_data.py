"""Data in which nothing is hidden: the base's own story, lived again with its noise, hundreds of times.

Temperature noise goes through the hysteresis itself (so it ratchets and is remembered), counts noise is added.
What candidates gain on such data is what they gain from noise alone. Knows no candidates.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from smarig.diagnosis.critique.refit import Refit
from smarig.replay import PlantModel, Prediction

Array = NDArray[np.float64]


def null_data(
    prediction: Prediction, plant_model: PlantModel, refitted: Refit, count: int, seed: int
) -> Array:
    """Whitened stacked readings (N, count) of stories without any effect."""
    rng = np.random.default_rng([seed, 0x5EED])
    noise = refitted.noise
    hysteresis_input_K, t, at = prediction.hysteresis_input_K, prediction.t_s, prediction.tick_index
    h, initial = plant_model.hysteresis, plant_model.initial
    temperature_noises = _ornstein_uhlenbeck(t, noise.correlation_s, count, rng)
    size, n = refitted.scale.size, at.size
    y = np.empty((size, count))
    undisturbed = prediction.outputs_along(h, initial, hysteresis_input_K)[at]
    for k in range(count):
        deviation = (
            prediction.outputs_along(
                h, initial, hysteresis_input_K + noise.temperature_K * temperature_noises[k], count
            )[at]
            - undisturbed
        )
        y[:n, k] = (
            refitted.fitted + prediction.output_slope * deviation + rng.standard_normal(n) * noise.white
        )
        y[n:, k] = rng.standard_normal(size - n) * refitted.scale[n:]
    scaled = y / refitted.scale[:, None]
    return solve_triangular(refitted.factor, scaled, lower=True, check_finite=False)


def _ornstein_uhlenbeck(t_s: Array, correlation_s: float, count: int, rng: np.random.Generator) -> Array:
    """Ornstein–Uhlenbeck noise of unit variance at times (m,), (count, m)."""
    decay = np.exp(-np.diff(t_s, prepend=t_s[:1]) / correlation_s)
    innovations = rng.standard_normal((t_s.size, count)) * np.sqrt(1 - decay**2)[:, None]
    value = rng.standard_normal(count)
    for k, d in enumerate(decay.tolist()):
        value = innovations[k] = value * d + innovations[k]
    return innovations.T.copy()

"""Values of a parameter under resampled blocks, from a parabola through the scores of the trials.

    Σ_b a_b s_b(θ) ≈ Σ_b a_b (c_0b + c_1b θ + c_2b θ²),    θ ~ N(θ*, σ²)
    θ* = − Σ a_b c_1b / (2 Σ a_b c_2b),    σ² = − T / (2 Σ a_b c_2b)

Trials lie at a few values, so the best of them would make every interval as coarse as the trials.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.weights import TEMPERATURE

NEAR_NATS = 30.0  # behind the best: trials farther away say nothing of the top


def drawn_values(hypothesis: ComparedHypothesis, parameter: str, shares: Array) -> Array:
    """Values (draws,) of a parameter under other ``shares`` (draws, B) of the blocks."""
    x = np.array([t.parameters[parameter] for t in hypothesis.trials])
    scores = np.array([t.log_scores for t in hypothesis.trials])
    total = scores.sum(axis=1)
    near = (total > total.max() - NEAR_NATS) | _neighbours(x, total)
    chosen = hypothesis.resampled(shares)[parameter]
    if np.unique(x[near]).size < 3:
        return chosen
    best, size = float(x[int(total.argmax())]), float(np.ptp(x[near]))
    z = (x[near] - best) / size
    coefficients = np.linalg.lstsq(np.vander(z, 3), scores[near], rcond=None)[0]
    second, first, _ = (shares @ coefficients.T).T
    bend = 2 * np.minimum(second, -1e-12)
    spread = np.sqrt(-TEMPERATURE / bend) * np.random.default_rng(0).standard_normal(bend.size)
    drawn = np.clip(-first / bend + spread, z.min() - 1, z.max() + 1)
    return np.where(second < 0, best + size * drawn, chosen)


def _neighbours(x: Array, total: Array) -> NDArray[np.bool_]:
    """The best trials (trials,) of the nearest values on both sides of the best: a sure strength has no others near."""
    best, found = x[int(total.argmax())], np.zeros(x.size, dtype=bool)
    for side in (x[x < best], x[x > best]):
        if side.size:
            value = side[int(np.argmin(np.abs(side - best)))]
            found[int(np.argmax(np.where(x == value, total, -np.inf)))] = True
    return found

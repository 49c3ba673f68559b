"""Major loop and first-order curves of a model, as one path for a small drawing."""

import numpy as np

from smarig.core import Array
from smarig.replay import Model

_REVERSALS = (0.35, 0.55, 0.75)  # first-order curves, as shares of the range


def model_loops(model: Model, n: int = 40) -> tuple[Array, Array]:
    """Input and output (k,) along the major loop and some first-order curves; ``n`` points per branch."""
    low, high = model.hysteresis.lower, model.hysteresis.upper
    turns = [low, *(end for share in _REVERSALS for end in (low + share * (high - low), low)), high, low]
    u = np.concatenate([np.linspace(a, b, n) for a, b in zip(turns, turns[1:])])
    return u, model.predict(u)

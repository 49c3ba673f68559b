"""The starts of the surface fit: many coarse guesses, ranked with their linear part solved.

For given x the surface y₋ + c·s(α, β) is linear in (y₋, c), so a guess costs one 2 × 2 solve (variable projection).
Scales come from the range of the data.
"""

import numpy as np

from smarig.core import Array
from smarig.identification.fod_data import FodData
from smarig.preisach import FodSurface, Parameters, surface_form

FLATTEST = 1e-6  # a smaller s(u₊, u₊) cannot be scaled to the measured height


def ranked_starts(form: str, data: FodData, root_weights: Array, fitted: Parameters) -> list[Parameters]:
    """The guesses of x of the form, best first; ``fitted`` are the x of the fitted form from which it is extended."""
    guesses = surface_form(form).starts(data.lower, data.upper, fitted)
    ends = (data.lower, data.upper, 0.0, 1.0)
    cost = [_projected_sse(FodSurface(form, x, *ends), data, root_weights) for x in guesses]
    return [guesses[k] for k in np.argsort(cost, kind="stable") if np.isfinite(cost[k])]


def _projected_sse(shape: FodSurface, data: FodData, root_weights: Array) -> float:
    if shape.shape(shape.upper, shape.upper) < FLATTEST:
        return np.inf
    s = shape.shape(data.alpha, data.beta)
    basis = np.column_stack([s, np.ones_like(s)]) * root_weights[:, None]
    target = data.y * root_weights
    solution = np.linalg.lstsq(basis, target, rcond=None)[0]
    return float(np.sum((target - basis @ solution) ** 2)) if solution[0] > 0 else np.inf

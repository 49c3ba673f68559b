"""Where to start the surface fit: many coarse guesses, ranked with their linear part solved.

For given x the surface y₋ + c·s(α, β) is linear in (y₋, c), so a guess costs one 2 × 2 solve
(variable projection). Scales come from the data's range alone. Knows no refinement.
"""

from itertools import product

import numpy as np
from numpy.typing import NDArray

from smarig.identification.fod_data import FodData
from smarig.preisach.hysteresis.fod_surface import FodSurface, Form

Array = NDArray[np.float64]
Guess = tuple[float, ...]
FLATTEST = 1e-6  # s(u₊, u₊) below this leaves nothing to scale to the measured height


def ranked_starts(form: Form, data: FodData, root_weights: Array, around: Guess | None = None) -> list[Guess]:
    """Guesses of x, best first; ``around`` is a fitted constant surface to grow f(α) from."""
    if form == "constant" or around is None:
        guesses = _constant(data)
    else:
        guesses = _parabolic(data, around) if form == "parabolic" else _exponential(data, around)
    ends = (data.lower, data.upper, 0.0, 1.0)
    cost = [_projected_sse(FodSurface(form, x, *ends), data, root_weights) for x in guesses]
    return [guesses[k] for k in np.argsort(cost, kind="stable") if np.isfinite(cost[k])]


def _constant(data: FodData) -> list[Guess]:
    span = data.upper - data.lower
    steep = [k / span for k in (5.0, 10.0, 20.0)]
    centres = [-(data.lower + k * span) for k in (0.15, 0.3, 0.5, 0.7)]
    return list(product(steep, centres, steep, centres))


def _parabolic(data: FodData, around: Guess) -> list[Guess]:
    """f through given values at u₋, the middle and u₊, as offsets of the constant."""
    span = data.upper - data.lower
    middle = data.lower + span / 2
    nodes = np.array([data.lower, middle, data.upper])
    offsets = [k * span for k in (-0.1, 0.0, 0.1, 0.3)]
    guesses: list[Guess] = [(*around[:3], 0.0, 0.0, around[3])]
    for left, bend, right in product(offsets, (-0.1 * span, 0.0), offsets):
        x5, x6, x7 = np.polyfit(nodes, around[3] + np.array([left, bend, right]), 2)
        guesses.append((*around[:3], float(x5), float(x6), float(x7)))
    return guesses


def _exponential(data: FodData, around: Guess) -> list[Guess]:
    """f = constant + offset·e^(−x₆(α − u₋)): several offsets at u₋, several decays of either sign."""
    span = data.upper - data.lower
    guesses: list[Guess] = []
    offsets, decays, levels = (-0.3, -0.1, 0.1, 0.3, 1.0), (-2.0, 1.0, 4.0, 12.0), (-0.05, 0.0, 0.05)
    for offset, decay, level in product(offsets, decays, levels):
        x6 = decay / span
        at_edge = data.lower if decay > 0 else data.upper  # where the exponential is largest
        x5 = offset * span * float(np.exp(x6 * at_edge))
        guesses.append((*around[:3], x5, x6, around[3] + level * span))
    return guesses


def _projected_sse(shape: FodSurface, data: FodData, root_weights: Array) -> float:
    if shape.shape(shape.upper, shape.upper) < FLATTEST:
        return np.inf
    s = shape.shape(data.alpha, data.beta)
    basis = np.column_stack([s, np.ones_like(s)]) * root_weights[:, None]
    target = data.y * root_weights
    solution = np.linalg.lstsq(basis, target, rcond=None)[0]
    return float(np.sum((target - basis @ solution) ** 2)) if solution[0] > 0 else np.inf
